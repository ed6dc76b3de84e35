// The arrows of the architecture: which folder may include which (docs/architecture.md).
#include <fstream>
#include <map>
#include <set>
#include <sstream>

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
    {"nifti", {"volumes"}},    {"OpenEXR/", {"raycast"}}, {"hwy/", {"raycast"}},
    {"Eigen/", {"lib"}},       {"pugixml", {"volumes"}},  {"dcmtk/", {"volumes"}},
    {"hdf5", {"volumes"}},
};

struct Include {
  std::string folder, file, target;
  bool quoted;
};

/// The target of an #include line; false for any other line.
bool parse_include(const std::string& line, std::string& target, bool& quoted) {
  std::istringstream words(line);
  std::string directive, rest;
  if (!(words >> directive >> rest) || directive != "#include") return false;
  quoted = rest.front() == '"';
  target = rest.substr(1, rest.find_last_of("\">") - 1);
  return true;
}

std::vector<Include> all_includes() {
  std::vector<Include> includes;
  for (const auto& [folder, allowed] : kMayInclude) {
    const std::filesystem::path root = std::filesystem::path(source_dir()) / folder;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root)) {
      const std::string extension = entry.path().extension().string();
      if (extension != ".h" && extension != ".cpp") continue;
      std::ifstream stream(entry.path());
      Include include{folder, entry.path().string(), "", false};
      for (std::string line; std::getline(stream, line);) {
        if (parse_include(line, include.target, include.quoted)) includes.push_back(include);
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

// So that the program starts without these libraries (volumes/base/module.h).
TEST(UnitIncludeGraph, LibrariesOfModulesStayInTheModulesRooms) {
  struct Room {
    std::string folder;
    std::set<std::string> libraries;
    std::set<std::string> seen_outside;  // headers that the other rooms may include
  };
  const std::vector<Room> rooms = {{"volumes/dicom/", {"dcmtk/"}, {"volumes/dicom/dicom.h"}},
                                   {"volumes/hdf5/", {"hdf5.h"}, {}},
                                   {"raycast/pictures/", {"opencv2/", "OpenEXR/"}, {}}};
  const std::vector<Include> includes = all_includes();
  for (const Room& room : rooms) {
    std::set<std::string> used;
    for (const Include& include : includes) {
      const bool is_inside = include.file.find("/" + room.folder) != std::string::npos;
      for (const std::string& library : room.libraries) {
        if (include.quoted || include.target.rfind(library, 0) != 0) continue;
        used.insert(library);
        EXPECT_TRUE(is_inside) << include.file << " includes " << include.target;
      }
      if (is_inside || include.target.rfind(room.folder, 0) != 0) continue;
      EXPECT_EQ(room.seen_outside.count(include.target), 1u)
          << include.file << " includes " << include.target;
    }
    EXPECT_EQ(used, room.libraries);
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
