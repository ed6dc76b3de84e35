#include "volumes/io/bytes/gzip_stream.h"

#include <algorithm>

#include "volumes/base/error.h"

namespace supple {

GzipStream::GzipStream(OutputFile& file) : m_file(file), m_buffer(256 * 1024) {
  constexpr int kGzip = 15 + 16, kMemory = 8;
  if (deflateInit2(&m_zlib, Z_DEFAULT_COMPRESSION, Z_DEFLATED, kGzip, kMemory,
                   Z_DEFAULT_STRATEGY) != Z_OK) {
    throw SystemError(file.final_path() + ": zlib cannot allocate its window");
  }
}

GzipStream::~GzipStream() {
  deflateEnd(&m_zlib);
}

void GzipStream::write(const void* data, std::size_t size) {
  const auto* bytes = static_cast<const Bytef*>(data);
  while (size > 0) {
    const std::size_t chunk = std::min<std::size_t>(size, 1u << 30);
    run(bytes, chunk, Z_NO_FLUSH);
    bytes += chunk;
    size -= chunk;
  }
}

void GzipStream::finish() {
  run(nullptr, 0, Z_FINISH);
}

void GzipStream::run(const Bytef* bytes, std::size_t size, int flush) {
  m_zlib.next_in = const_cast<Bytef*>(bytes);
  m_zlib.avail_in = uInt(size);
  do {
    m_zlib.next_out = m_buffer.data();
    m_zlib.avail_out = uInt(m_buffer.size());
    deflate(&m_zlib, flush);
    m_file.write(m_buffer.data(), m_buffer.size() - m_zlib.avail_out);
  } while (m_zlib.avail_out == 0);
}

}  // namespace supple
