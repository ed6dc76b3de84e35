#include "volumes/base/reserved_name.h"

#include <cerrno>
#include <csignal>
#include <cstdlib>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "volumes/base/atomic_file.h"
#include "volumes/base/error.h"

namespace supple {

namespace {

namespace fs = std::filesystem;

/// The file that a link stands for, as AtomicFile has it.
fs::path target_of(const std::string& path) {
  std::error_code ignored;
  return fs::is_symlink(path, ignored) ? fs::weakly_canonical(path) : fs::path(path);
}

bool is_running(const std::string& process) {
  const long number = std::strtol(process.c_str(), nullptr, 10);
  return ::kill(pid_t(number), 0) == 0 || errno != ESRCH;
}

/// Removes ".supple-PROCESS-NAME" of processes that are no more.
void remove_leftovers(const fs::path& target) {
  const std::string before = ".supple-", after = "-" + target.filename().string();
  std::error_code error;
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name.size() <= before.size() + after.size() ||
        name.compare(0, before.size(), before) != 0 ||
        name.compare(name.size() - after.size(), std::string::npos, after) != 0) {
      continue;
    }
    const std::string process =
        name.substr(before.size(), name.size() - before.size() - after.size());
    const bool is_number = process.find_first_not_of("0123456789") == std::string::npos;
    std::error_code ignored;
    if (is_number && !is_running(process)) fs::remove(entry->path(), ignored);
  }
}

/// Whether the descriptor is of the file that has the name now.
bool is_at(int descriptor, const std::string& path) {
  struct stat opened = {}, named = {};
  return ::fstat(descriptor, &opened) == 0 && ::stat(path.c_str(), &named) == 0 &&
         opened.st_ino == named.st_ino && opened.st_dev == named.st_dev;
}

/// Of the open file, not of the process, so that two objects of one process exclude each other.
bool lock(int descriptor) {
  struct flock whole = {};
  whole.l_type = F_WRLCK;
  whole.l_whence = SEEK_SET;
  return ::fcntl(descriptor, F_OFD_SETLK, &whole) == 0;
}

}  // namespace

ReservedName::ReservedName(const std::string& final_path) {
  const fs::path target = target_of(final_path);
  m_folders.make(target.parent_path());
  check_output_place(final_path);
  const std::string lock_path =
      (target.parent_path() / (".supple-" + target.filename().string() + ".lock")).string();
  // The holder may remove the file between opening and locking it.
  while (m_lock_path.empty()) {
    m_descriptor = ::open(lock_path.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (m_descriptor < 0) throw_write_error(final_path, errno);
    if (!lock(m_descriptor)) {
      const bool is_held = errno == EAGAIN || errno == EACCES;
      const int reason = errno;
      ::close(m_descriptor);
      // Some file systems know no locks; names are then not reserved there.
      if (!is_held && reason != EINVAL && reason != ENOLCK && reason != ENOTSUP) {
        throw_write_error(final_path, reason);
      }
      m_descriptor = -1;
      if (!is_held) {
        ::unlink(lock_path.c_str());
        return;
      }
      throw SystemError(final_path + ": another process is about to write this file");
    }
    if (is_at(m_descriptor, lock_path)) {
      m_lock_path = lock_path;
    } else {
      ::close(m_descriptor);
    }
  }
  remove_leftovers(target);
}

ReservedName::~ReservedName() {
  if (!m_lock_path.empty()) ::unlink(m_lock_path.c_str());
  if (m_descriptor >= 0) ::close(m_descriptor);
}

}  // namespace supple
