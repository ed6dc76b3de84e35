#include "volumes/io/bytes/spool_file.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include <fcntl.h>
#include <unistd.h>

#include "volumes/base/error.h"

namespace supple {

namespace {

[[noreturn]] void fail(const std::string& path, const char* what, int errno_value) {
  throw SystemError(path + ": " + what + " a temporary file: " + std::strerror(errno_value));
}

}  // namespace

SpoolFile::SpoolFile(const std::string& final_path) : m_final_path(final_path) {
  const auto folder = std::filesystem::path(final_path).parent_path();
  // A file without a name leaves nothing behind when the process is killed.
  m_descriptor =
      ::open(folder.empty() ? "." : folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (m_descriptor >= 0) return;
  std::string name = (folder / ".supple-spool-XXXXXX").string();
  m_descriptor = ::mkostemp(name.data(), O_CLOEXEC);
  if (m_descriptor < 0) fail(m_final_path, "cannot open", errno);
  ::unlink(name.c_str());
}

SpoolFile::~SpoolFile() {
  ::close(m_descriptor);
}

void SpoolFile::write_at(std::int64_t offset, const void* data, std::size_t size) {
  const char* bytes = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t done = ::pwrite(m_descriptor, bytes, size, off_t(offset));
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) fail(m_final_path, "cannot write", done < 0 ? errno : EIO);
    bytes += done;
    offset += done;
    size -= std::size_t(done);
  }
}

void SpoolFile::read_at(std::int64_t offset, void* out, std::size_t size) const {
  char* bytes = static_cast<char*>(out);
  while (size > 0) {
    const ssize_t done = ::pread(m_descriptor, bytes, size, off_t(offset));
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) fail(m_final_path, "cannot read", done < 0 ? errno : EIO);
    bytes += done;
    offset += done;
    size -= std::size_t(done);
  }
}

}  // namespace supple
