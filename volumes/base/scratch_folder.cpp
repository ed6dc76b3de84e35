#include "volumes/base/scratch_folder.h"

#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <string_view>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "volumes/base/error.h"

namespace supple {

namespace {

namespace fs = std::filesystem;

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
