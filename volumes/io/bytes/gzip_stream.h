// A gzip stream into an open file, one member, zlib's default level. Cost: zlib's window and a
// buffer of 256 kB.
#pragma once

#include <vector>

#include <zlib.h>

#include "volumes/io/bytes/output_file.h"

namespace supple {

/// Throws SystemError as OutputFile does, and when zlib finds no memory.
class GzipStream {
 public:
  /// Borrows the file; bytes go where it stands.
  explicit GzipStream(OutputFile& file);
  ~GzipStream();
  GzipStream(const GzipStream&) = delete;
  GzipStream& operator=(const GzipStream&) = delete;

  void write(const void* data, std::size_t size);
  /// Ends the stream with its checksum; the file stays open.
  void finish();

 private:
  void run(const Bytef* bytes, std::size_t size, int flush);

  OutputFile& m_file;
  std::vector<Bytef> m_buffer;
  z_stream m_zlib{};
};

}  // namespace supple
