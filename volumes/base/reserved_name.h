// The name of an output, held by one process while it computes what will be there.
#pragma once

#include <string>

#include "volumes/base/made_folders.h"

namespace supple {

/// Holds a lock file ".supple-NAME.lock" beside the output. The lock ends with the process, however
/// it ends; the file goes with the object, and one that a killed process left is taken over.
class ReservedName {
 public:
  /// Makes missing folders, which go with the object unless something is in them, and removes the
  /// temporary files that killed processes left for this name. Throws SystemError where another
  /// process holds the name, and as AtomicFile.
  explicit ReservedName(const std::string& final_path);
  ~ReservedName();
  ReservedName(const ReservedName&) = delete;
  ReservedName& operator=(const ReservedName&) = delete;

 private:
  MadeFolders m_folders;
  std::string m_lock_path;
  int m_descriptor = -1;
};

}  // namespace supple
