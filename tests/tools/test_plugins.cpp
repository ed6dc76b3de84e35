// Plugins of the program: found beside it or in the folder of libraries, refused in one line where
// they are missing or not of its build, and not loaded before they are needed.
#include <cstdlib>
#include <ostream>

#include <gtest/gtest.h>

#include "raycast/pictures/pictures_plugin.h"
#include "tests/support/program.h"
#include "volumes/io/dicom/dicom_plugin.h"
#include "volumes/io/hdf5/hdf5_plugin.h"

namespace fs = std::filesystem;

namespace supple::test {
namespace {

struct PluginCase {
  std::string file;
  std::string purpose;
  std::vector<std::string> arguments;  // what needs the plugin
  std::string sizes;                   // of its build, as they lie in its entry
};

template <class Entry>
PluginCase plugin_case(const std::vector<std::string>& arguments) {
  const auto* sizes = reinterpret_cast<const char*>(Entry::kSizes.data());
  return {Entry::kName.file, Entry::kName.purpose, arguments, {sizes, sizeof Entry::kSizes}};
}

void PrintTo(const PluginCase& plugin, std::ostream* out) {
  *out << plugin.file << " by supple " << plugin.arguments[0];
}

/// The program alone in bin/, and inputs.
class UnitPlugins : public ::testing::TestWithParam<PluginCase> {
 protected:
  UnitPlugins() {
    fs::create_directories(m_folder / "bin");
    fs::create_directories(m_libraries);
    std::error_code other_disk;
    fs::create_hard_link(m_built, m_program, other_disk);
    if (other_disk) fs::copy_file(m_built, m_program);
    write_ball(m_folder, "a", 6);
    write_text(m_folder / "a.dcm", std::string(128, '\0') + "DICM" + std::string(64, '\0'));
    write_text(m_folder / "a.h5", "\x89HDF\r\n\x1a\n" + std::string(64, '\0'));
    for (const char* name : {"a.png", "b.png"}) {
      fs::copy_file(source_dir() + "/tests/golden/reference/shear_bone.png", m_folder / name);
    }
    m_inputs = m_folder.entries();
  }

  Outcome run(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), m_program);
    return run_program(arguments, {m_folder.path()});
  }
  fs::path built_plugin() const { return m_built.parent_path() / GetParam().file; }
  bool is_built() const { return fs::exists(built_plugin()); }

  TemporaryFolder m_folder;
  fs::path m_libraries = m_folder / SUPPLE_LIBDIR "/supple";
  std::vector<std::string> m_inputs;
  fs::path m_built = std::getenv("SUPPLE_BINARY");
  std::string m_program = m_folder / "bin/supple";
};

TEST_P(UnitPlugins, AMissingOneIsASystemErrorThatSaysWhereItBelongs) {
  if (!is_built()) GTEST_SKIP() << GetParam().file << " is not built";
  const Outcome outcome = run(GetParam().arguments);
  EXPECT_EQ(outcome.exit_code, 4);
  EXPECT_EQ(outcome.err, "supple: error: " + (m_folder / ("bin/" + GetParam().file)) +
                             ": the plugin that " + GetParam().purpose + " is missing\n");
  EXPECT_EQ(m_folder.entries(), m_inputs);
}

TEST_P(UnitPlugins, OneThatIsNoneOfThisBuildIsRefused) {
  if (!is_built()) GTEST_SKIP() << GetParam().file << " is not built";
  const std::string place = m_folder / ("bin/" + GetParam().file);
  // Another plugin has another entry.
  const char* other = GetParam().file == "supple_hdf5.so" ? "supple_pictures.so" : "supple_hdf5.so";
  fs::copy_file(m_built.parent_path() / other, place);
  const Outcome outcome = run(GetParam().arguments);
  EXPECT_EQ(outcome.exit_code, 4);
  EXPECT_EQ(outcome.err,
            "supple: error: " + place + ": this plugin belongs to another build of the program\n");

  std::string bytes = read_text(built_plugin().string());
  for (std::size_t at = bytes.find(GetParam().sizes); at != std::string::npos;
       at = bytes.find(GetParam().sizes)) {
    ++bytes[at];
  }
  write_text(place, bytes);
  const Outcome older = run(GetParam().arguments);
  EXPECT_EQ(older.exit_code, 4);
  EXPECT_EQ(older.err, outcome.err);

  write_text(place, "no shared object");
  const Outcome damaged = run(GetParam().arguments);
  EXPECT_EQ(damaged.exit_code, 4);
  EXPECT_EQ(damaged.err.rfind("supple: error: " + place + ": ", 0), 0u) << damaged.err;
  EXPECT_EQ(damaged.err.find('\n'), damaged.err.size() - 1) << damaged.err;
}

TEST_P(UnitPlugins, OneInTheFolderOfLibrariesIsFound) {
  if (!is_built()) GTEST_SKIP() << GetParam().file << " is not built";
  fs::copy_file(built_plugin(), m_libraries / GetParam().file);
  const Outcome outcome = run(GetParam().arguments);
  // The files of HDF5 and DICOM are mere signatures.
  EXPECT_NE(outcome.exit_code, 4) << outcome.err;
  EXPECT_EQ(outcome.err.find("plugin"), std::string::npos) << outcome.err;
}

TEST_P(UnitPlugins, NoneIsNeededForWhatDoesNotUseThem) {
  EXPECT_EQ(run({"--help"}).exit_code, 0);
  EXPECT_EQ(run({"info", "a.nhdr"}).exit_code, 0);
  const Outcome outcome = run({"info", "b.h5:/path"});
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_NE(outcome.err.find("no such file"), std::string::npos) << outcome.err;
}

INSTANTIATE_TEST_SUITE_P(, UnitPlugins,
                         ::testing::Values(plugin_case<Hdf5Plugin>({"info", "a.h5"}),
                                           plugin_case<Hdf5Plugin>({"convert", "a.nhdr", "out.h5"}),
                                           plugin_case<DicomPlugin>({"info", "a.dcm"}),
                                           plugin_case<PicturesPlugin>({"compare", "a.png",
                                                                        "b.png"})));

}  // namespace
}  // namespace supple::test
