// The arrows of the architecture: which folder may include which (docs/architecture.md).
#include <fstream>
#include <map>
#include <regex>
#include <set>

#include <gtest/gtest.h>

#include "tests/tools/program.h"

using namespace supple::test;

namespace {

const std::map<std::string, std::set<std::string>> kMayInclude = {
    {"volumes", {"volumes"}},
    {"lib", {"lib", "volumes"}},
    {"raycast", {"raycast", "volumes"}},
    {"tools", {"tools", "lib", "raycast", "volumes"}},
};

/// Third-party headers that may appear in some folders only.
const std::map<std::string, std::set<std::string>> kThirdPartyHomes = {
    {"embree3/", {"raycast"}}, {"opencv2/", {"raycast"}}, {"toml++/", {"tools"}},
    {"CLI/", {"tools"}},       {"openvdb/", {"volumes"}}, {"tiff", {"volumes"}},
    {"nifti", {"volumes"}},
};

struct Include {
  std::string folder, file, target;
  bool quoted;
};

std::vector<Include> all_includes() {
  std::vector<Include> includes;
  const std::regex pattern(R"(^\s*#\s*include\s*([<"])([^>"]+)[>"])");
  for (const auto& [folder, allowed] : kMayInclude) {
    const std::filesystem::path root = std::filesystem::path(source_dir()) / folder;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root)) {
      const std::string extension = entry.path().extension().string();
      if (extension != ".h" && extension != ".cpp") continue;
      std::ifstream stream(entry.path());
      for (std::string line; std::getline(stream, line);) {
        std::smatch match;
        if (!std::regex_search(line, match, pattern)) continue;
        includes.push_back({folder, entry.path().string(), match[2], match[1] == "\""});
      }
    }
  }
  return includes;
}

}  // namespace

TEST(UnitIncludeGraph, FoldersIncludeOnlyWhatTheArchitectureAllows) {
  const std::vector<Include> includes = all_includes();
  ASSERT_GT(includes.size(), 100u);
  for (const Include& include : includes) {
    const std::string top = include.target.substr(0, include.target.find('/'));
    if (include.quoted) {
      EXPECT_EQ(kMayInclude.at(include.folder).count(top), 1u)
          << include.file << " includes " << include.target;
      continue;
    }
    for (const auto& [prefix, homes] : kThirdPartyHomes) {
      if (include.target.rfind(prefix, 0) != 0) continue;
      EXPECT_EQ(homes.count(include.folder), 1u) << include.file << " includes " << include.target;
    }
  }
}

TEST(UnitIncludeGraph, HeavyHeadersStayBehindFewFiles) {
  std::set<std::string> files;
  for (const Include& include : all_includes()) {
    if (include.target.rfind("openvdb/", 0) != 0) continue;
    files.insert(include.file);
    const std::string name = std::filesystem::path(include.file).filename().string();
    EXPECT_TRUE(name.find("vdb") != std::string::npos || name.back() == 'p') << include.file;
  }
  EXPECT_LE(files.size(), 5u) << ::testing::PrintToString(files);
}
