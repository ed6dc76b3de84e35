#include "volumes/base/atomic_file.h"

#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "volumes/base/error.h"

namespace supple {

namespace {

std::atomic<int> g_common_commits{0};

constexpr std::size_t kMostNameBytes = 255;  // of every file system in use
/// ".supple-", the number of a process, and a dash.
constexpr std::size_t kBeforePart = 24;

/// ".nii.gz" of "head.nii.gz"; "" where none is short.
std::string extensions_of(const std::string& name) {
  constexpr std::size_t kLongest = 12;
  const std::size_t last = name.rfind('.');
  if (last == std::string::npos || name.size() - last > kLongest) return "";
  const bool is_packed = name.compare(last, std::string::npos, ".gz") == 0 && last > 0;
  const std::size_t before = is_packed ? name.rfind('.', last - 1) : std::string::npos;
  return name.substr(before == std::string::npos || last - before > kLongest ? last : before);
}

/// The file keeps the rights of the one that it replaces, where the file system knows any.
void take_mode_of(const std::string& replaced, int descriptor) {
  struct stat status = {};
  if (::stat(replaced.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return;
  if (::fchmod(descriptor, status.st_mode & 07777) != 0) return;
}

}  // namespace

std::string temporary_part(const std::string& file_name) {
  if (file_name.size() <= kMostNameBytes - kBeforePart) return file_name;
  std::uint64_t hash = 14695981039346656037u;  // FNV-1a
  for (const char c : file_name) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211u;
  return "long-" + std::to_string(hash) + extensions_of(file_name);
}

// The same extension as the final name, since several libraries choose the format by it.
std::string temporary_name(const std::string& final_path) {
  const std::filesystem::path path(final_path);
  const std::string name =
      ".supple-" + std::to_string(::getpid()) + "-" + temporary_part(path.filename().string());
  return (path.parent_path() / name).string();
}

void throw_write_error(const std::string& path, int errno_value) {
  if (errno_value == ENOENT || errno_value == ENOTDIR) {
    throw InputError({path, "output folder", "no such folder", "an existing folder"});
  }
  throw SystemError(path + ": cannot write: " + std::strerror(errno_value));
}

void check_output_place(const std::string& path) {
  if (path == "-") {
    throw InputError({path, "output", "a pipe", "the name of a file: pipes are not written"});
  }
  const std::size_t bytes = std::filesystem::path(path).filename().string().size();
  if (bytes > kMostNameBytes) {
    throw InputError({path, "output", "a name of " + std::to_string(bytes) + " bytes",
                      "at most " + std::to_string(kMostNameBytes)});
  }
  std::error_code ignored;
  const std::filesystem::file_status status = std::filesystem::status(path, ignored);
  if (std::filesystem::is_directory(status)) {
    throw InputError({path, "output", "a directory", "a file name"});
  }
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    throw InputError({path, "output", "a device, pipe or socket", "the name of a plain file"});
  }
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  if (!folder.empty() && !std::filesystem::is_directory(folder, ignored)) {
    throw InputError({path, "output folder", "no such folder", "an existing folder"});
  }
}

AtomicFile::AtomicFile(std::string final_path) : m_final_path(std::move(final_path)) {
  check_output_place(m_final_path);
  // A link goes on pointing at its file, which is replaced.
  std::error_code ignored;
  if (std::filesystem::is_symlink(m_final_path, ignored)) {
    m_final_path = std::filesystem::weakly_canonical(m_final_path).string();
  }
  m_temporary_path = temporary_name(m_final_path);
  ::unlink(m_temporary_path.c_str());
  const int descriptor =
      ::open(m_temporary_path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (descriptor < 0) {
    m_temporary_path.clear();
    throw_write_error(m_final_path, errno);
  }
  ::close(descriptor);
}

AtomicFile::~AtomicFile() {
  if (!m_temporary_path.empty()) std::remove(m_temporary_path.c_str());
}

void AtomicFile::commit() {
  const int descriptor = ::open(m_temporary_path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) throw_write_error(m_final_path, errno);
  take_mode_of(m_final_path, descriptor);
  const bool flushed = ::fsync(descriptor) == 0;
  const int flush_errno = errno;
  ::close(descriptor);
  if (!flushed) throw_write_error(m_final_path, flush_errno);
  if (std::rename(m_temporary_path.c_str(), m_final_path.c_str()) != 0) {
    throw_write_error(m_final_path, errno);
  }
  m_temporary_path.clear();
}

CommonCommit::CommonCommit() {
  ++g_common_commits;
}

CommonCommit::~CommonCommit() {
  --g_common_commits;
}

bool CommonCommit::is_under_way() {
  return g_common_commits > 0;
}

}  // namespace supple
