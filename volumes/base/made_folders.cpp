#include "volumes/base/made_folders.h"

namespace supple {

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

}  // namespace supple
