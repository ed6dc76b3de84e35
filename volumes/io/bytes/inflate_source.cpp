// gzip (several members in a row too) and zlib streams, by zlib.
#include <algorithm>

#include <zlib.h>

#include "volumes/base/error.h"
#include "volumes/io/bytes/decoding_source.h"

namespace supple {

namespace {

class InflateSource : public DecodingSource {
 public:
  InflateSource(std::shared_ptr<const InputFile> file, const ByteRange& range)
      : DecodingSource(file, range, "compressed data") {
    constexpr int kGzipOrZlib = 15 + 32;
    if (inflateInit2(&m_zlib, kGzipOrZlib) != Z_OK) {
      throw SystemError(file->path() + ": zlib cannot allocate its window");
    }
  }
  ~InflateSource() override { inflateEnd(&m_zlib); }
  InflateSource(const InflateSource&) = delete;
  InflateSource& operator=(const InflateSource&) = delete;

  std::size_t decode(void* out, std::size_t size) override {
    std::size_t done = 0;
    while (done < size && !m_at_end) {
      if (!refill()) fail("the end of the file inside the stream", kExpected);
      const std::size_t chunk = std::min<std::size_t>(size - done, 1u << 30);
      m_zlib.next_in = const_cast<Bytef*>(next());
      m_zlib.avail_in = uInt(available());
      m_zlib.next_out = static_cast<Bytef*>(out) + done;
      m_zlib.avail_out = uInt(chunk);
      const int result = inflate(&m_zlib, Z_NO_FLUSH);
      use(available() - m_zlib.avail_in);
      done += chunk - m_zlib.avail_out;
      if (result == Z_STREAM_END) {
        start_next_member();
      } else if (result != Z_OK && result != Z_BUF_ERROR) {
        fail(m_zlib.msg != nullptr ? m_zlib.msg : "a damaged stream", kExpected);
      }
    }
    return done;
  }

 protected:
  std::string amount(std::int64_t bytes) const override {
    return bytes_text(bytes) + " after decompression";
  }

 private:
  static constexpr const char* kExpected = "an intact gzip or zlib stream";

  /// Anything but another gzip member behind the end is padding.
  void start_next_member() {
    m_at_end = !refill() || next()[0] != 0x1f;
    if (!m_at_end) inflateReset(&m_zlib);
  }

  z_stream m_zlib{};
  bool m_at_end = false;
};

}  // namespace

std::unique_ptr<DecodingSource> open_inflate(std::shared_ptr<const InputFile> file,
                                             const ByteRange& range) {
  return std::make_unique<InflateSource>(std::move(file), range);
}

}  // namespace supple
