// A folder of its own for files that no other program is to see, among the temporary ones.
#pragma once

#include <string>

namespace supple {

/// Goes, with all that is in it, when this does; where its process is killed first, when the next
/// one is made, at the earliest after a minute.
class ScratchFolder {
 public:
  /// Throws SystemError.
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::string& path() const { return m_path; }
  std::string operator/(const std::string& name) const { return m_path + "/" + name; }

 private:
  std::string m_path;
  int m_lock = -1;  // held as long as the folder is in use
};

}  // namespace supple
