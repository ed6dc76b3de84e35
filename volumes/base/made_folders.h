// Folders that an output needed.
#pragma once

#include <deque>
#include <filesystem>

namespace supple {

/// Folders that are empty in the end vanish with the object, unless keep() was called.
class MadeFolders {
 public:
  MadeFolders() = default;
  ~MadeFolders();
  MadeFolders(const MadeFolders&) = delete;
  MadeFolders& operator=(const MadeFolders&) = delete;

  /// Makes a folder and those above it where they are missing.
  void make(const std::filesystem::path& folder);
  void keep() { m_folders.clear(); }
  /// Folders that were made, each after those that it lies in.
  const std::deque<std::filesystem::path>& made() const { return m_folders; }

 private:
  std::deque<std::filesystem::path> m_folders;  // the innermost last
};

}  // namespace supple
