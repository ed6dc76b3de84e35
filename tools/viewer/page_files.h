// The page: files of tools/viewer/page, which the build embeds in the program.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace supple::tools {

struct EmbeddedFile {
  const char* path;  // below the folder
  const unsigned char* data;
  std::size_t size;
};
extern const std::vector<EmbeddedFile> kEmbeddedPage;  // in generated/tools/viewer/page.cpp

struct PageFile {
  std::string type;  // of media, as the extension says
  std::string bytes;
};

/// The file of a request's target, "/" being "/index.html". `folder`: where it is read instead;
/// empty: the embedded one. Nothing for targets that name none; of a folder only names of plain
/// letters.
std::optional<PageFile> page_file(const std::string& target, const std::string& folder);

}  // namespace supple::tools
