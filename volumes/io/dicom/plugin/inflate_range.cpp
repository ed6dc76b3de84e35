#include "volumes/io/dicom/plugin/inflate_range.h"

#include <algorithm>
#include <vector>

#include <zlib.h>

#include "volumes/base/error.h"

namespace supple {

namespace {

constexpr std::size_t kBufferBytes = 64 * 1024;

class RawInflater {
 public:
  RawInflater(const InputFile& file, std::int64_t offset)
      : m_file(file), m_offset(offset), m_buffer(kBufferBytes) {
    if (inflateInit2(&m_zlib, -MAX_WBITS) != Z_OK) {
      throw SystemError(file.path() + ": zlib cannot allocate its window");
    }
  }
  ~RawInflater() { inflateEnd(&m_zlib); }
  RawInflater(const RawInflater&) = delete;
  RawInflater& operator=(const RawInflater&) = delete;

  /// Fewer bytes than `size` only at the end of the stream.
  std::size_t read(char* out, std::size_t size) {
    std::size_t done = 0;
    while (done < size && !m_at_end) {
      if (m_zlib.avail_in == 0) refill();
      const std::size_t chunk = std::min<std::size_t>(size - done, std::size_t(1) << 30);
      m_zlib.next_out = reinterpret_cast<Bytef*>(out) + done;
      m_zlib.avail_out = uInt(chunk);
      const int result = inflate(&m_zlib, Z_NO_FLUSH);
      done += chunk - m_zlib.avail_out;
      m_at_end = result == Z_STREAM_END;
      if (!m_at_end && result != Z_OK) fail(m_zlib.msg != nullptr ? m_zlib.msg : "damaged data");
    }
    return done;
  }

 private:
  [[noreturn]] void fail(const std::string& found) const {
    throw InputError({m_file.path(), "deflated dataset", found, "an intact deflate stream"});
  }

  void refill() {
    const std::size_t got = m_file.read_at(m_offset, m_buffer.data(), m_buffer.size());
    if (got == 0) fail("the end of the file inside the stream");
    m_offset += std::int64_t(got);
    m_zlib.next_in = reinterpret_cast<Bytef*>(m_buffer.data());
    m_zlib.avail_in = uInt(got);
  }

  const InputFile& m_file;
  std::int64_t m_offset;
  std::vector<char> m_buffer;
  z_stream m_zlib{};
  bool m_at_end = false;
};

}  // namespace

std::string inflate_range(const InputFile& file, std::int64_t file_offset, std::int64_t skip,
                          std::size_t count) {
  RawInflater inflater(file, file_offset);
  std::string bytes(std::min(count, kBufferBytes), '\0');
  while (skip > 0) {
    const std::size_t step = std::min<std::size_t>(std::size_t(skip), bytes.size());
    if (inflater.read(bytes.data(), step) < step) return "";
    skip -= std::int64_t(step);
  }
  bytes.resize(count);
  bytes.resize(inflater.read(bytes.data(), count));
  return bytes;
}

}  // namespace supple
