// The start of a gzip file's content, to tell what it is.
#include <zlib.h>

#include "volumes/base/error.h"
#include "volumes/io/bytes/byte_source.h"

namespace supple {

namespace {

/// Enough for heads of some hundred bytes: names and comments of gzip come first.
constexpr std::size_t kPackedBytes = 64 * 1024;

}  // namespace

bool is_gzip(const std::string& head) {
  return head.size() >= 2 && head[0] == '\x1f' && head[1] == '\x8b';
}

std::string gzip_head(const InputFile& file, std::size_t limit) {
  const std::string packed = file.head(kPackedBytes);
  std::string bytes(limit, '\0');
  z_stream zlib{};
  constexpr int kGzip = 15 + 16;
  if (inflateInit2(&zlib, kGzip) != Z_OK) {
    throw SystemError(file.path() + ": zlib cannot allocate its window");
  }
  zlib.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
  zlib.avail_in = uInt(packed.size());
  zlib.next_out = reinterpret_cast<Bytef*>(bytes.data());
  zlib.avail_out = uInt(limit);
  const int result = inflate(&zlib, Z_SYNC_FLUSH);
  const bool is_damaged = result != Z_OK && result != Z_STREAM_END && result != Z_BUF_ERROR;
  bytes.resize(is_damaged ? 0 : limit - zlib.avail_out);
  inflateEnd(&zlib);
  return bytes;
}

}  // namespace supple
