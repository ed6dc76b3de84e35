// The arrows of the architecture (docs/architecture.md): which folder may include which, where
// other people's headers may appear, and what keeps a folder readable.
#include <fstream>
#include <functional>
#include <map>
#include <optional>
#include <regex>
#include <set>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/support/program.h"

using namespace supple::test;

namespace {

const std::map<std::string, std::set<std::string>> kMayInclude = {
    {"volumes", {"volumes"}},
    {"lib", {"lib", "volumes"}},
    {"raycast", {"raycast", "volumes"}},
    {"tools", {"tools", "lib", "raycast", "volumes"}},
};

/// Models share bodies and materials, and nothing of each other; scenes know no command line.
const std::map<std::string, std::set<std::string>> kNever = {
    {"lib/fem", {"lib/relax", "lib/springs", "lib/chainmail", "lib/model", "lib/session"}},
    {"lib/relax", {"lib/springs", "lib/chainmail", "lib/fem", "lib/model", "lib/session"}},
    {"lib/springs", {"lib/relax", "lib/chainmail", "lib/fem", "lib/model", "lib/session"}},
    {"tools/scene", {"tools/commands", "tools/console", "tools/lab", "tools/viewer"}},
    {"lib/chainmail", {"lib/relax", "lib/springs", "lib/fem", "lib/model", "lib/session"}},
};

/// Third-party headers, and the only folders (with those below them) in which they may appear.
const std::map<std::string, std::set<std::string>> kThirdPartyHomes = {
    {"embree3/", {"raycast/march"}},
    {"opencv2/", {"raycast/pictures/plugin"}},
    {"OpenEXR/", {"raycast/pictures/plugin"}},
    {"hwy/", {"raycast/march", "raycast/microscope", "raycast/sample"}},
    {"toml++/", {"volumes/base"}},
    {"nlohmann/", {"volumes/base", "volumes/io", "tools/lab"}},
    {"CLI/", {"tools/commands", "tools/console", "tools/examples", "tools/lab", "tools/viewer"}},
    {"openvdb/", {"volumes/grid", "volumes/io/vdb", "lib/state", "tools/lab/bench"}},
    {"nanovdb/", {"tools/lab/bench"}},
    {"tiff", {"volumes/io/tiff"}},
    {"nifti", {"volumes/io/nifti"}},
    {"pugixml", {"volumes/io/tiff", "volumes/io/vtu"}},
    {"dcmtk/", {"volumes/io/dicom/plugin"}},
    {"openjpeg", {"volumes/io/dicom/plugin"}},
    {"hdf5", {"volumes/io/hdf5/plugin"}},
    {"Eigen/", {"lib/fem", "lib/springs", "volumes/field/landmarks"}},
    {"Spectra/", {"lib/fem/dynamics"}},
    {"boost/asio", {"tools/viewer"}},
    {"boost/beast", {"tools/viewer"}},
    {"turbojpeg", {"tools/scene/pictures"}},
    {"pybind11/", {"tools/python"}},
};

struct Include {
  std::string file, target;  // from the root of the source
  bool quoted;
};

std::string folder_of(const std::string& file) {
  return file.substr(0, file.rfind('/'));
}

bool is_below(const std::string& folder, const std::string& root) {
  return folder == root || folder.rfind(root + "/", 0) == 0;
}

/// Adds the files below a folder, from the root of the source.
void add_files(const std::string& root, const std::vector<std::string>& extensions,
               std::vector<std::string>& files) {
  const std::filesystem::path path = std::filesystem::path(source_dir()) / root;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(path)) {
    const std::string extension = entry.path().extension().string();
    if (std::find(extensions.begin(), extensions.end(), extension) == extensions.end()) continue;
    files.push_back(std::filesystem::relative(entry.path(), source_dir()).string());
  }
}

/// The files of the product, from the root of the source.
std::vector<std::string> product_files(const std::vector<std::string>& extensions) {
  std::vector<std::string> files;
  for (const auto& [root, allowed] : kMayInclude) add_files(root, extensions, files);
  return files;
}

std::string text_of(const std::string& file) {
  return read_text(source_dir() + "/" + file);
}

/// Returns code without comments and string literals, so that words in them do not count.
std::string code_of(const std::string& file) {
  static const std::regex noise("//[^\n]*|\"(?:[^\"\\\\\n]|\\\\.)*\"");
  return std::regex_replace(text_of(file), noise, "");
}

std::vector<Include> all_includes() {
  static const std::regex line("#include ([\"<])([^\">]+)[\">]");
  std::vector<Include> includes;
  for (const std::string& file : product_files({".h", ".cpp"})) {
    const std::string text = text_of(file);
    for (std::sregex_iterator match(text.begin(), text.end(), line), end; match != end; ++match) {
      includes.push_back({file, (*match)[2], (*match)[1] == "\""});
    }
  }
  return includes;
}

using Graph = std::map<std::string, std::set<std::string>>;

Graph folder_graph(const std::vector<Include>& includes) {
  Graph graph;
  for (const Include& include : includes) {
    if (!include.quoted) continue;
    const std::string from = folder_of(include.file), to = folder_of(include.target);
    if (from != to) graph[from].insert(to);
  }
  return graph;
}

/// A circle of folders as "a -> b -> a"; none where there is none.
std::optional<std::string> find_circle(const Graph& graph) {
  std::set<std::string> done;
  std::vector<std::string> way;
  std::optional<std::string> circle;
  const std::function<void(const std::string&)> visit = [&](const std::string& folder) {
    const auto seen = std::find(way.begin(), way.end(), folder);
    if (seen != way.end()) {
      circle.emplace();
      for (auto it = seen; it != way.end(); ++it) *circle += *it + " -> ";
      *circle += folder;
    }
    if (circle || done.count(folder) != 0) return;
    way.push_back(folder);
    const auto targets = graph.find(folder);
    if (targets != graph.end()) {
      for (const std::string& target : targets->second) visit(target);
    }
    way.pop_back();
    done.insert(folder);
  };
  for (const auto& [folder, targets] : graph) visit(folder);
  return circle;
}

/// The installed headers, from the root of the source (cmake/PublicHeaders.txt).
std::set<std::string> public_headers() {
  std::set<std::string> headers;
  std::istringstream lines(text_of("cmake/PublicHeaders.txt"));
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || line[0] == '#') continue;
    EXPECT_TRUE(headers.insert(line).second) << line << " stands twice";
  }
  return headers;
}

/// A header with all that it includes of the source.
std::set<std::string> closure_of(const std::string& header, const std::vector<Include>& includes) {
  std::set<std::string> all;
  const std::function<void(const std::string&)> add = [&](const std::string& file) {
    if (!all.insert(file).second) return;
    for (const Include& include : includes) {
      if (include.quoted && include.file == file) add(include.target);
    }
  };
  add(header);
  return all;
}

/// The place in the source of a header that a host program includes as <supple/...>.
std::string source_of_installed(const std::string& name) {
  if (name == "supple.h") return "tools/library/" + name;
  return name.rfind("scene/", 0) == 0 ? "tools/" + name : name;
}

}  // namespace

TEST(UnitIncludeGraph, PublicHeadersAreAtMostSixtyAndIncludePublicOnesAlone) {
  const std::set<std::string> headers = public_headers();
  EXPECT_LE(headers.size(), 60u);
  ASSERT_GT(headers.size(), 30u);
  std::set<std::string> found;
  for (const Include& include : all_includes()) {
    if (headers.count(include.file) == 0) continue;
    found.insert(include.file);
    if (include.quoted) {
      EXPECT_EQ(headers.count(include.target), 1u)
          << include.file << " includes " << include.target << ", which is not installed";
      continue;
    }
    const bool is_standard = include.target.find_first_of("/.") == std::string::npos;
    const bool is_imath = include.target.rfind("Imath/", 0) == 0;
    const bool is_named =
        include.file == "volumes/grid/density_grid_vdb.h" || include.target == "sys/types.h";
    EXPECT_TRUE(is_standard || is_imath || is_named)
        << include.file << " includes " << include.target;
  }
  EXPECT_GE(found.size() + 1, headers.size());  // version.h is made by CMake
  for (const std::string& header : headers) {
    const bool is_made = header == "volumes/base/version.h";
    EXPECT_TRUE(is_made || std::filesystem::exists(source_dir() + "/" + header)) << header;
  }
}

TEST(UnitIncludeGraph, TheOneHeaderOfTheLibraryPullsAtMostSixtyAndNoInsideOfFiniteElements) {
  const std::set<std::string> pulled = closure_of("tools/library/supple.h", all_includes());
  EXPECT_LE(pulled.size(), 60u) << ::testing::PrintToString(pulled);
  ASSERT_GT(pulled.size(), 30u);
  for (const std::string& header : pulled) {
    EXPECT_TRUE(header == "lib/fem/fem_report.h" || !is_below(folder_of(header), "lib/fem"))
        << header;
  }
}

TEST(UnitIncludeGraph, ExamplesAndPagesNamePublicHeadersAlone) {
  static const std::regex named("<supple/([\\w/]+\\.h)>");
  const std::set<std::string> headers = public_headers();
  std::size_t count = 0;
  for (const char* folder : {"examples", "docs"}) {
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator(source_dir() + "/" + folder)) {
      const std::string extension = entry.path().extension().string();
      if (extension != ".cpp" && extension != ".md") continue;
      const std::string text = read_text(entry.path().string());
      for (std::sregex_iterator match(text.begin(), text.end(), named), end; match != end;
           ++match, ++count) {
        EXPECT_EQ(headers.count(source_of_installed((*match)[1])), 1u)
            << entry.path() << " names " << (*match)[1];
      }
    }
  }
  EXPECT_GT(count, 10u);
}

TEST(UnitIncludeGraph, NoTwoFoldersAtAnyDepthIncludeEachOther) {
  const Graph graph = folder_graph(all_includes());
  ASSERT_GT(graph.size(), 30u);
  EXPECT_EQ(find_circle(graph).value_or("none"), "none");
}

TEST(UnitIncludeGraph, ACircleIsFoundAndNamed) {
  const Include there{"lib/body/body.h", "lib/chainmail/ecm.h", true};
  const Include back{"lib/chainmail/ecm.h", "lib/body/body.h", true};
  EXPECT_FALSE(find_circle(folder_graph({back})));
  EXPECT_EQ(find_circle(folder_graph({there, back})).value_or("none"),
            "lib/body -> lib/chainmail -> lib/body");
  std::vector<Include> all = all_includes();
  all.push_back({"volumes/base/error.h", "volumes/io/load/load.h", true});
  EXPECT_TRUE(find_circle(folder_graph(all)));
}

TEST(UnitIncludeGraph, FoldersIncludeOnlyWhatTheArchitectureAllows) {
  const std::vector<Include> includes = all_includes();
  ASSERT_GT(includes.size(), 100u);
  for (const Include& include : includes) {
    const std::string folder = folder_of(include.file);
    if (include.quoted) {
      const std::string root = folder.substr(0, folder.find('/'));
      const std::string target = include.target.substr(0, include.target.find('/'));
      EXPECT_EQ(kMayInclude.at(root).count(target), 1u)
          << include.file << " includes " << include.target;
      for (const auto& [from, never] : kNever) {
        if (!is_below(folder, from)) continue;
        for (const std::string& other : never) {
          EXPECT_FALSE(is_below(folder_of(include.target), other))
              << include.file << " includes " << include.target;
        }
      }
      continue;
    }
    for (const auto& [prefix, homes] : kThirdPartyHomes) {
      if (include.target.rfind(prefix, 0) != 0) continue;
      const bool is_home = std::any_of(homes.begin(), homes.end(), [&](const std::string& home) {
        return is_below(folder, home);
      });
      EXPECT_TRUE(is_home) << include.file << " includes " << include.target;
    }
  }
}

// The program is to start without their libraries (volumes/base/plugin.h).
TEST(UnitIncludeGraph, NothingIncludesWhatLiesInAPlugin) {
  std::size_t inside = 0;
  for (const Include& include : all_includes()) {
    if (!include.quoted || include.target.find("/plugin/") == std::string::npos) continue;
    EXPECT_EQ(folder_of(include.file), folder_of(include.target))
        << include.file << " includes " << include.target;
    ++inside;
  }
  EXPECT_GT(inside, 20u);
}

TEST(UnitIncludeGraph, HeavyHeadersStayBehindFewFiles) {
  std::set<std::string> files;
  for (const Include& include : all_includes()) {
    if (include.target.rfind("openvdb/", 0) != 0 || is_below(include.file, "tools/lab/bench"))
      continue;
    files.insert(include.file);
    const std::string name = std::filesystem::path(include.file).filename().string();
    EXPECT_TRUE(name.find("vdb") != std::string::npos || name.back() == 'p') << include.file;
  }
  EXPECT_LE(files.size(), 5u) << ::testing::PrintToString(files);
}

TEST(UnitIncludeGraph, NothingButParallelNamesTheLibraryOfThreads) {
  static const std::regex library("\\btbb\\b");
  std::set<std::string> files;
  for (const std::string& file : product_files({".h", ".cpp"})) {
    const std::string code = std::regex_replace(text_of(file), std::regex("//[^\n]*"), "");
    if (std::regex_search(code, library)) files.insert(file);
  }
  EXPECT_EQ(files, std::set<std::string>{"volumes/base/parallel.h"});
}

TEST(UnitIncludeGraph, EveryTypeNameStandsForOneType) {
  static const std::regex definition(
      "(?:^|\n)(?:template ?<[^>]*>\\s*)?(?:struct|class|enum class|enum) "
      "(\\w+)(?: final)?\\s*(?=[{]|:[^:])|(?:^|\n)using (\\w+) =");
  std::map<std::string, std::set<std::string>> homes;
  for (const std::string& file : product_files({".h", ".cpp"})) {
    const std::string code = code_of(file);
    for (std::sregex_iterator match(code.begin(), code.end(), definition), end; match != end;
         ++match) {
      homes[(*match)[1].matched ? (*match)[1] : (*match)[2]].insert(file);
    }
  }
  ASSERT_GT(homes.size(), 300u);
  for (const auto& [name, files] : homes) {
    EXPECT_EQ(files.size(), 1u) << name << " in " << ::testing::PrintToString(files);
  }
}

TEST(UnitIncludeGraph, FoldersHoldAtMostTwentyFiveSourcesAndLargerOnesAReadme) {
  std::map<std::string, int> sources, files;
  std::vector<std::string> all = product_files({".h", ".cpp"});
  add_files("tests", {".h", ".cpp"}, all);
  for (const std::string& file : all) {
    ++files[folder_of(file)];
    sources[folder_of(file)] += file.back() == 'p';
  }
  for (const auto& [folder, count] : files) {
    EXPECT_LE(sources[folder], 25) << folder;
    if (count <= 5) continue;
    EXPECT_TRUE(std::filesystem::exists(source_dir() + "/" + folder + "/README.md")) << folder;
  }
}

TEST(UnitIncludeGraph, FoldersOfTestsMirrorThoseOfTheProduct) {
  std::vector<std::string> files;
  for (const auto& [root, allowed] : kMayInclude) add_files("tests/" + root, {".cpp"}, files);
  ASSERT_GT(files.size(), 200u);
  for (const std::string& file : files) {
    const std::string folder = folder_of(file).substr(std::string("tests/").size());
    if (folder == "volumes/export") continue;  // writers of all formats, and their judges
    EXPECT_TRUE(std::filesystem::is_directory(std::filesystem::path(source_dir()) / folder))
        << file;
  }
}

TEST(UnitIncludeGraph, LibrariesNameNoOptionOfTheCommandLine) {
  static const std::regex said("//[^\n]*|\"(?:[^\"\\\\\n]|\\\\.)*\"");
  static const std::regex option("(?:^|[^\\w-])--[a-z]");
  for (const std::string& file : product_files({".h", ".cpp"})) {
    if (is_below(file, "tools")) continue;
    const std::string text = text_of(file);
    for (std::sregex_iterator match(text.begin(), text.end(), said), end; match != end; ++match) {
      const std::string line = match->str();
      EXPECT_FALSE(std::regex_search(line, option)) << file << ": " << line;
    }
  }
}
