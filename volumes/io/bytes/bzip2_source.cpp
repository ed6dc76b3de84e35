// bzip2 streams, one or several in a row, by libbz2. Every block and every stream ends with a
// checksum that the library compares.
#include <algorithm>

#include <bzlib.h>

#include "volumes/base/error.h"
#include "volumes/io/bytes/decoding_source.h"

namespace supple {

namespace {

class Bzip2Source : public DecodingSource {
 public:
  Bzip2Source(const std::shared_ptr<const InputFile>& file, const ByteRange& range)
      : DecodingSource(file, range, "compressed data"), m_path(file->path()) {
    start();
  }
  ~Bzip2Source() override { BZ2_bzDecompressEnd(&m_bzip2); }
  Bzip2Source(const Bzip2Source&) = delete;
  Bzip2Source& operator=(const Bzip2Source&) = delete;

  std::size_t decode(void* out, std::size_t size) override {
    std::size_t done = 0;
    while (done < size && !m_at_end) {
      // The library may hold decoded bytes back without wanting more of the file.
      const bool has_more = refill();
      const std::size_t chunk = std::min<std::size_t>(size - done, 1u << 30);
      m_bzip2.next_in = reinterpret_cast<char*>(const_cast<unsigned char*>(next()));
      m_bzip2.avail_in = unsigned(available());
      m_bzip2.next_out = static_cast<char*>(out) + done;
      m_bzip2.avail_out = unsigned(chunk);
      const int result = BZ2_bzDecompress(&m_bzip2);
      use(available() - m_bzip2.avail_in);
      const std::size_t got = chunk - m_bzip2.avail_out;
      done += got;
      if (result == BZ_STREAM_END) {
        start_next_stream();
      } else if (result == BZ_MEM_ERROR) {
        throw SystemError(m_path + ": bzip2 cannot allocate its block");
      } else if (result != BZ_OK) {
        fail("a damaged stream", kExpected);
      } else if (got == 0 && !has_more) {
        fail("the end of the file inside the stream", kExpected);
      }
    }
    return done;
  }

 protected:
  std::string amount(std::int64_t bytes) const override {
    return bytes_text(bytes) + " after decompression";
  }

 private:
  static constexpr const char* kExpected = "an intact bzip2 stream";

  void start() {
    m_bzip2 = {};
    if (BZ2_bzDecompressInit(&m_bzip2, 0, 0) != BZ_OK) {
      throw SystemError(m_path + ": bzip2 cannot allocate its state");
    }
  }

  /// Anything but another stream behind the end is padding.
  void start_next_stream() {
    m_at_end = !refill() || next()[0] != 'B';
    if (m_at_end) return;
    BZ2_bzDecompressEnd(&m_bzip2);
    start();
  }

  std::string m_path;
  bz_stream m_bzip2{};
  bool m_at_end = false;
};

}  // namespace

std::unique_ptr<DecodingSource> open_bzip2(std::shared_ptr<const InputFile> file,
                                           const ByteRange& range) {
  return std::make_unique<Bzip2Source>(file, range);
}

}  // namespace supple
