// Names of outputs, held by one process while it computes their contents.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "volumes/base/made_folders.h"

namespace supple {

/// Remains of an output when its process ends at once.
struct Remains {
  std::string path;  // a file or an empty folder
  int lock = -1;     // descriptor of a lock file, which goes only with the last that uses it

  /// Calls nothing that a signal handler may not call.
  void remove() const;
};

/// Holds one byte for each name of a lock file ".supple.lock" in the folder of the outputs. The
/// locks end with the process, however it ends; the file goes with the last object that uses it.
class ReservedNames {
 public:
  ReservedNames() = default;
  ~ReservedNames();
  ReservedNames(const ReservedNames&) = delete;
  ReservedNames& operator=(const ReservedNames&) = delete;

  /// Makes missing folders, which go with the object unless something is in them, and removes the
  /// temporary files that killed processes left for this name. Returns its possible remains, in the
  /// order of making: folders, the lock file, the temporary file of an AtomicFile. Throws
  /// SystemError where another process or object holds the name, and as AtomicFile.
  std::vector<Remains> add(const std::string& final_path);

 private:
  struct Folder {
    int descriptor = -1;  // of the lock file; -1 on file systems without locks
    std::multimap<std::string, std::filesystem::path> leftovers;  // by the name of the output
  };
  Folder& folder_of(const std::filesystem::path& path, const std::string& final_path);

  MadeFolders m_made;
  std::map<std::filesystem::path, Folder> m_folders;
};

}  // namespace supple
