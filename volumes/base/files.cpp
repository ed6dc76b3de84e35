#include "volumes/base/files.h"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string_view>
#include <thread>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "volumes/base/atomic_file.h"
#include "volumes/base/error.h"

namespace supple {

void require_regular_file(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0 || S_ISREG(status.st_mode)) return;
  if (S_ISDIR(status.st_mode)) throw_open_error(path, EISDIR);
  throw InputError({path, "", "a device, pipe or socket", "a regular file"});
}

std::string text_of_file(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

std::string text_of_input(const std::string& path) {
  require_regular_file(path);
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw_open_error(path, errno);
  std::string text;
  std::vector<char> bytes(std::size_t(1) << 16);
  while (stream.read(bytes.data(), std::streamsize(bytes.size())) || stream.gcount() > 0) {
    text.append(bytes.data(), std::size_t(stream.gcount()));
  }
  if (stream.bad()) throw_open_error(path, errno);
  return text;
}

void replace_text_file(const std::string& path, const std::string& text) {
  AtomicFile file(path);
  std::ofstream stream(file.path(), std::ios::binary);
  stream << text << std::flush;
  if (!stream) throw_write_error(path, errno);
  stream.close();
  file.commit();
}

MadeFolders::~MadeFolders() {
  std::error_code ignored;
  while (!m_folders.empty()) {
    std::filesystem::remove(m_folders.back(), ignored);  // unless something is in it
    m_folders.pop_back();
  }
}

void MadeFolders::make(const std::filesystem::path& folder) {
  if (folder.empty() || std::filesystem::exists(folder)) return;
  make(folder.parent_path());
  if (std::filesystem::create_directory(folder)) m_folders.push_back(folder);
}

namespace {

namespace fs = std::filesystem;

const char* const kLockName = ".supple.lock";

/// The file that a link stands for, as AtomicFile has it.
fs::path target_of(const std::string& path) {
  std::error_code ignored;
  return fs::is_symlink(path, ignored) ? fs::weakly_canonical(path) : fs::path(path);
}

bool is_running(const std::string& process) {
  const long number = std::strtol(process.c_str(), nullptr, 10);
  return ::kill(pid_t(number), 0) == 0 || errno != ESRCH;
}

/// Files ".supple-PROCESS-NAME" of processes that are no more, by NAME.
std::multimap<std::string, fs::path> find_leftovers(const fs::path& folder) {
  const std::string before = ".supple-";
  std::multimap<std::string, fs::path> found;
  std::error_code error;
  for (fs::directory_iterator entry(folder.empty() ? "." : folder, error), end;
       !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name.compare(0, before.size(), before) != 0) continue;
    const std::size_t dash = name.find_first_not_of("0123456789", before.size());
    if (dash == before.size() || dash == std::string::npos || name[dash] != '-') continue;
    if (is_running(name.substr(before.size(), dash - before.size()))) continue;
    found.emplace(name.substr(dash + 1), entry->path());
  }
  return found;
}

/// True if the descriptor is of the file that has the name now.
bool is_at(int descriptor, const fs::path& path) {
  struct stat opened = {}, named = {};
  return ::fstat(descriptor, &opened) == 0 && ::stat(path.c_str(), &named) == 0 &&
         opened.st_ino == named.st_ino && opened.st_dev == named.st_dev;
}

/// Makes a lock of the open file, not of the process, so that two objects of it exclude each other.
struct flock write_lock(off_t start, off_t length) {
  struct flock lock = {};
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  lock.l_start = start;
  lock.l_len = length;
  return lock;
}

/// The whole file, which the last that uses it locks to remove it.
struct flock whole_file() {
  return write_lock(0, 0);
}

/// One byte, chosen by a hash of the name (FNV-1a) that every build shares; the first stays free.
struct flock byte_of(const std::string& name) {
  std::uint64_t hash = 14695981039346656037u;
  for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211u;
  return write_lock(off_t(hash >> 2) + 1, 1);
}

/// True if the lock is excluded by a whole file that is being removed, or by nothing any more.
bool is_passing(int descriptor, struct flock lock) {
  return ::fcntl(descriptor, F_OFD_GETLK, &lock) == 0 &&
         (lock.l_type == F_UNLCK || (lock.l_start == 0 && lock.l_len == 0));
}

}  // namespace

void Remains::remove() const {
  if (lock >= 0) {
    struct flock whole = whole_file();
    const bool is_used =
        ::fcntl(lock, F_OFD_SETLK, &whole) != 0 && (errno == EAGAIN || errno == EACCES);
    if (is_used) return;
  }
  if (::unlink(path.c_str()) != 0) ::rmdir(path.c_str());
}

ReservedNames::Folder& ReservedNames::folder_of(const fs::path& path,
                                                const std::string& final_path) {
  const auto [place, is_new] = m_folders.try_emplace(path);
  Folder& folder = place->second;
  if (is_new) folder.leftovers = find_leftovers(path);
  if (folder.descriptor >= 0 && is_at(folder.descriptor, path / kLockName)) return folder;
  if (folder.descriptor >= 0) ::close(folder.descriptor);
  folder.descriptor =
      ::open((path / kLockName).c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (folder.descriptor < 0) throw_write_error(final_path, errno);
  ::fchmod(folder.descriptor, 0666);  // other users write other names; refused to all but the owner
  return folder;
}

std::vector<Remains> ReservedNames::add(const std::string& final_path) {
  const fs::path target = target_of(final_path), path = target.parent_path();
  const std::string name = target.filename().string();
  m_made.make(path);
  check_output_place(final_path);
  struct flock lock = byte_of(name);
  for (;;) {
    Folder& folder = folder_of(path, final_path);
    if (::fcntl(folder.descriptor, F_OFD_SETLK, &lock) == 0) {
      // Its last user may have removed the file between opening and locking it.
      if (is_at(folder.descriptor, path / kLockName)) break;
      continue;
    }
    const int reason = errno;
    if (reason == EAGAIN || reason == EACCES) {
      if (!is_passing(folder.descriptor, lock)) {
        throw SystemError(final_path + ": another process is about to write this file");
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      continue;
    }
    // Some file systems know no locks; names are then not reserved there.
    if (reason == EINVAL || reason == ENOLCK || reason == ENOTSUP) break;
    throw_write_error(final_path, reason);
  }
  auto& leftovers = m_folders[path].leftovers;
  const auto [first, last] = leftovers.equal_range(temporary_part(name));
  std::error_code ignored;
  for (auto left = first; left != last; ++left) fs::remove(left->second, ignored);
  leftovers.erase(first, last);

  std::vector<Remains> remains;
  for (const fs::path& folder : m_made.made()) remains.push_back({folder.string()});
  remains.push_back({(path / kLockName).string(), m_folders[path].descriptor});
  remains.push_back({temporary_name(target.string())});
  return remains;
}

ReservedNames::~ReservedNames() {
  for (const auto& [path, folder] : m_folders) {
    if (folder.descriptor < 0) continue;
    Remains{(path / kLockName).string(), folder.descriptor}.remove();
    ::close(folder.descriptor);
  }
}

namespace {

/// Prefix that with six characters behind it names such a folder, and nothing else.
constexpr std::string_view kPrefix = "supple-scratch-";
constexpr std::string_view kAnySix = "XXXXXX";
/// A folder that has just been made has no lock yet.
constexpr std::time_t kLeastAge_s = 60;

/// The folder, locked where nobody else holds its lock; -1 where somebody does, or it is not a
/// folder.
int open_locked(const std::string& path) {
  const int folder = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (folder < 0 || ::flock(folder, LOCK_EX | LOCK_NB) == 0) return folder;
  ::close(folder);
  return -1;
}

/// Folders of this user whose process was killed: it holds their lock no more.
void remove_abandoned(const fs::path& temporary) {
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(temporary, ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.rfind(kPrefix, 0) != 0 || name.size() != kPrefix.size() + kAnySix.size()) continue;
    const int folder = open_locked(entry.path().string());
    if (folder < 0) continue;
    struct stat about = {};
    const bool is_known = ::fstat(folder, &about) == 0;
    if (is_known && about.st_uid == ::geteuid() &&
        std::time(nullptr) - about.st_mtime >= kLeastAge_s) {
      fs::remove_all(entry.path(), ignored);
    }
    ::close(folder);
  }
}

}  // namespace

ScratchFolder::ScratchFolder() {
  const fs::path temporary = fs::temp_directory_path();
  remove_abandoned(temporary);
  std::string pattern = temporary / std::string(kPrefix).append(kAnySix);
  if (::mkdtemp(pattern.data()) == nullptr) throw SystemError(pattern + ": cannot create");
  m_path = pattern;
  m_lock = open_locked(m_path);
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  fs::remove_all(m_path, ignored);
  if (m_lock >= 0) ::close(m_lock);
}

}  // namespace supple
