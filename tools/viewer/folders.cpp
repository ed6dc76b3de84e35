#include "tools/viewer/folders.h"

#include <algorithm>
#include <filesystem>

#include "volumes/base/error.h"

namespace supple::tools {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& path) {
  throw InputError(
      {path, "path", "no file of the folders that may be used", "one below them (see --folder)"});
}

}  // namespace

Folders::Folders(const std::vector<std::string>& roots) {
  for (const std::string& root : roots) {
    std::error_code error;
    const fs::path resolved = fs::canonical(root.empty() ? "." : root, error);
    if (error || !fs::is_directory(resolved, error)) {
      throw InputError({root, "folder", "no folder", "a folder whose files may be used"});
    }
    const std::string name = resolved.string();
    if (std::find(m_roots.begin(), m_roots.end(), name) == m_roots.end()) m_roots.push_back(name);
  }
}

Folders Folders::with(const std::string& root) const {
  std::vector<std::string> roots = m_roots;
  roots.push_back(root);
  return Folders(roots);
}

std::string Folders::absolute(const std::string& path) const {
  const bool is_plain = std::none_of(path.begin(), path.end(),
                                     [](char c) { return (c >= 0 && c < ' ') || c == 127; });
  if (!is_plain || path.empty() || path.size() > 4096) refuse(path.substr(0, 100));
  return fs::path(path).is_absolute() ? path : m_roots.front() + "/" + path;
}

bool Folders::is_within(const std::string& resolved) const {
  return std::any_of(m_roots.begin(), m_roots.end(), [&](const std::string& root) {
    return resolved == root || root == "/" || resolved.rfind(root + "/", 0) == 0;
  });
}

std::string Folders::input(const std::string& path) const {
  std::error_code error;
  const std::string resolved = fs::canonical(absolute(path), error).string();
  if (error || !is_within(resolved)) refuse(path);
  return resolved;
}

bool Folders::holds(const std::string& path) const {
  std::error_code error;
  const std::string resolved = fs::canonical(path, error).string();
  return !error && is_within(resolved);
}

std::string Folders::output(const std::string& path) const {
  const fs::path given = absolute(path);
  const std::string name = given.filename().string();
  if (name.empty() || name == "." || name == "..") refuse(path);
  if (name.front() == '.') {
    throw InputError(
        {path, "path", "a hidden file, which no list shows", "a name without a dot first"});
  }
  const fs::path file = fs::path(input(given.parent_path().string())) / name;
  std::error_code error;
  const fs::file_status status = fs::symlink_status(file, error);
  if (fs::exists(status) && !fs::is_regular_file(status)) refuse(path);
  return file.string();
}

}  // namespace supple::tools
