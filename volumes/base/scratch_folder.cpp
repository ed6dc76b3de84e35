#include "volumes/base/scratch_folder.h"

#include <cstdlib>
#include <filesystem>

#include "volumes/base/error.h"

namespace supple {

ScratchFolder::ScratchFolder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "supple-XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr) throw SystemError(pattern + ": cannot create");
  m_path = pattern;
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(m_path, ignored);
}

}  // namespace supple
