#include "volumes/io/bytes/input_file.h"

#include <algorithm>
#include <cerrno>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "volumes/base/error.h"

namespace supple {

InputFile::InputFile(std::string path)
    : m_path(std::move(path)),
      m_descriptor(::open(m_path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {
  if (m_descriptor < 0) throw_open_error(m_path, errno);
  struct stat status {};
  const bool known = ::fstat(m_descriptor, &status) == 0;
  const int stat_errno = errno;
  m_size = status.st_size;
  if (known && S_ISREG(status.st_mode) && m_size > 0) return;
  ::close(m_descriptor);
  if (!known) throw_open_error(m_path, stat_errno);
  if (S_ISDIR(status.st_mode)) throw_open_error(m_path, EISDIR);
  if (!S_ISREG(status.st_mode)) throw InputError({m_path, "", "a device", "a regular file"});
  throw InputError({m_path, "file length", "0 bytes", "a file with content"});
}

InputFile::~InputFile() {
  ::close(m_descriptor);
}

std::size_t InputFile::read_at(std::int64_t offset, void* out, std::size_t size) const {
  std::size_t done = 0;
  while (done < size) {
    const ssize_t got = ::pread(m_descriptor, static_cast<char*>(out) + done, size - done,
                                off_t(offset + std::int64_t(done)));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw_open_error(m_path, errno);
    if (got == 0) break;
    done += std::size_t(got);
  }
  return done;
}

std::string InputFile::head(std::size_t limit) const {
  std::string bytes(std::size_t(std::min<std::int64_t>(m_size, std::int64_t(limit))), '\0');
  bytes.resize(read_at(0, bytes.data(), bytes.size()));
  return bytes;
}

}  // namespace supple
