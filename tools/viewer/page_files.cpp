#include "tools/viewer/page_files.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace supple::tools {

namespace {

std::string type_of_file(const std::string& name) {
  const std::string extension = std::filesystem::path(name).extension().string();
  if (extension == ".html") return "text/html; charset=utf-8";
  if (extension == ".js" || extension == ".mjs") return "text/javascript; charset=utf-8";
  if (extension == ".css") return "text/css; charset=utf-8";
  if (extension == ".svg") return "image/svg+xml";
  if (extension == ".png") return "image/png";
  if (extension == ".json") return "application/json";
  return "application/octet-stream";
}

/// Folders and files of letters, digits, "-", "_" and single dots that do not begin a name.
bool is_plain_path(const std::string& path) {
  bool begins = true;
  for (const char c : path) {
    const bool is_letter = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_';
    if (!is_letter && (begins || (c != '.' && c != '/'))) return false;
    begins = c == '/' || c == '.';
  }
  return !path.empty() && !begins;
}

}  // namespace

std::optional<PageFile> page_file(const std::string& target, const std::string& folder) {
  std::string path = target.substr(0, target.find('?'));
  if (path == "/") path = "/index.html";
  if (path.empty() || path.front() != '/') return std::nullopt;
  path.erase(0, 1);
  if (!is_plain_path(path)) return std::nullopt;
  if (!folder.empty()) {
    std::ifstream file(folder + "/" + path, std::ios::binary);
    if (!file || !std::filesystem::is_regular_file(folder + "/" + path)) return std::nullopt;
    return PageFile{type_of_file(path), {std::istreambuf_iterator<char>(file), {}}};
  }
  const auto found = std::find_if(kEmbeddedPage.begin(), kEmbeddedPage.end(),
                                  [&](const EmbeddedFile& file) { return path == file.path; });
  if (found == kEmbeddedPage.end()) return std::nullopt;
  return PageFile{type_of_file(path), {reinterpret_cast<const char*>(found->data), found->size}};
}

}  // namespace supple::tools
