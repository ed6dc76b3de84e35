#include "volumes/io/bytes/output_file.h"

#include <cerrno>
#include <cstring>

#include "volumes/base/error.h"

namespace supple {

OutputFile::OutputFile(const std::string& path)
    : m_file(path), m_stream(m_file.path(), std::ios::binary | std::ios::trunc) {
  check();
}

void OutputFile::write(const void* data, std::size_t size) {
  errno = 0;
  m_stream.write(static_cast<const char*>(data), std::streamsize(size));
  check();
}

void OutputFile::seek(std::int64_t offset) {
  errno = 0;
  m_stream.seekp(std::streamoff(offset));
  check();
}

std::int64_t OutputFile::position() {
  return std::int64_t(m_stream.tellp());
}

void OutputFile::close() {
  errno = 0;
  m_stream.close();
  check();
}

void OutputFile::check() const {
  if (m_stream) return;
  throw SystemError(m_file.final_path() +
                    ": cannot write: " + std::strerror(errno != 0 ? errno : EIO));
}

}  // namespace supple
