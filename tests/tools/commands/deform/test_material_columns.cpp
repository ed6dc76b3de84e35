// Physical columns and presets of material tables on the command line, in scenes and in states.
#include <gtest/gtest.h>

#include "lib/state/state.h"
#include "tests/support/program.h"
#include "tests/support/sanitized.h"

using namespace supple;
using namespace supple::test;

namespace {

const std::string kLimits = "max_length = [[0, 1.25]]\nmin_length = [[0, 0.75]]\n";

class MaterialColumns : public ::testing::Test {
 protected:
  void SetUp() override { write_ball(m_folder, "ball", 8); }

  Outcome deform(const std::string& material) {
    write_text(m_folder / "m.toml", material);
    return run_supple({"deform", m_folder / "ball.nhdr", "--material", m_folder / "m.toml",
                       "--grab", "4,4,4", "--by", "1,0,0", "--force", "-o", m_folder / "out.vdb"});
  }

  /// The table that a state keeps after a drag with this one.
  std::string kept(const std::string& material) {
    const Outcome outcome = deform(material);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return read_state(m_folder / "out.vdb").material_toml;
  }

  /// `message` is what follows the file name.
  void expect_refused(const std::string& material, const std::string& message) {
    const Outcome outcome = deform(material);
    EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
    EXPECT_NE(outcome.err.find("m.toml:" + message), std::string::npos) << outcome.err;
  }

  TemporaryFolder m_folder;
};

using UnitMaterialColumns = MaterialColumns;
using FaultMaterialColumns = MaterialColumns;

}  // namespace

TEST_F(UnitMaterialColumns, AStateKeepsEveryColumnToTheLastDigit) {
  const std::string table =
      "domain = [0, 255]\nactive = [1, 255]\n" + kLimits +
      "shear1 = [[0, 0.25]]\nshear2 = [[0, 0.125]]\n"
      "stiffness = [[0, 0.10000000000000001], [255, 18600000]]\ndensity = [[0, 900], [255, 1920]]\n"
      "damping = [[0, 0], [100, 12.5]]\nplastic = [[3, 0.0625]]\n"
      "\n[label.3]\ndomain = [0, 100]\n" +
      kLimits +
      "shear1 = [[0, 0.25]]\nshear2 = [[0, 0.25]]\n"
      "stiffness = [[50, 2500]]\ndensity = [[0, 1130]]\ndamping = [[0, 1]]\nplastic = [[0, 2]]\n";
  EXPECT_EQ(kept(table), table);
  EXPECT_EQ(kept(kept(table)), table);
  ASSERT_EQ(run_supple({"deform", m_folder / "out.vdb", "--grab", "4,4,4", "--by", "1,0,0",
                        "--force", "-o", m_folder / "out.vdb"})
                .exit_code,
            0);
  EXPECT_EQ(read_state(m_folder / "out.vdb").material_toml, table);
}

TEST_F(UnitMaterialColumns, ATableWithoutThemIsKeptWithoutThem) {
  const std::string table = "domain = [0, 255]\nactive = [1, 255]\n" + kLimits +
                            "shear1 = [[0, 0.25]]\nshear2 = [[0, 0.25]]\n";
  EXPECT_EQ(kept(table), table);
}

TEST_F(UnitMaterialColumns, APresetAloneIsATableAndAStateKeepsItsValues) {
  EXPECT_EQ(kept("preset = \"bone\"\n"),
            "domain = [0, 255]\nactive = [0, 255]\nmax_length = [[0, 1]]\nmin_length = [[0, 1]]\n"
            "shear1 = [[0, 0]]\nshear2 = [[0, 0]]\nstiffness = [[0, 18600000]]\n"
            "poisson = [[0, 0.29999999999999999]]\ndensity = [[0, 1920]]\ndamping = [[0, "
            "0.10000000000000001]]\n");
  for (const std::string name : {"soft-tissue", "brain", "membrane"}) {
    const std::string table = kept("preset = \"" + name + "\"\n");
    EXPECT_EQ(kept(table), table);
  }
}

TEST_F(UnitMaterialColumns, GivenKeysReplaceThoseOfThePreset) {
  RUN_WHEN_SANITIZED();
  const std::string head = "domain = [-100, 300]\nactive = [1, 300]\n";
  EXPECT_EQ(kept(head + "preset = \"soft-tissue\"\nmax_length = [[5, 2]]\nshear1 = [[6, 0.5]]\n"
                        "min_length_k = [[7, 0.5]]\ndensity = [[8, 950]]\nplastic = [[9, 0.25]]\n"),
            head +
                "max_length = [[5, 2]]\nmin_length = [[-100, 0.59999999999999998]]\n"
                "shear1 = [[6, 0.5]]\nshear2 = [[-100, 0.28999999999999998]]\n"
                "min_length_k = [[7, 0.5]]\nstiffness = [[-100, 3.25]]\n"
                "poisson = [[-100, 0.47999999999999998]]\ndensity = [[8, 950]]\n"
                "damping = [[-100, 10]]\nplastic = [[9, 0.25]]\n");
  const std::string both = kept(head + "preset = \"soft-tissue\"\nshear = [[6, 0.125]]\n");
  EXPECT_NE(both.find("shear1 = [[6, 0.125]]\nshear2 = [[6, 0.125]]\n"), std::string::npos) << both;
}

TEST_F(UnitMaterialColumns, ALabelMayHaveAPresetOfItsOwn) {
  const std::string table =
      kept("preset = \"membrane\"\n[label.3]\npreset = \"bone\"\ndomain = [20, 60]\n");
  EXPECT_NE(table.find("\nstiffness = [[0, 2500]]\n"), std::string::npos) << table;
  EXPECT_NE(table.find("\n[label.3]\ndomain = [20, 60]\nmax_length = [[20, 1]]\n"),
            std::string::npos)
      << table;
  EXPECT_NE(table.find("\nstiffness = [[20, 18600000]]\n"), std::string::npos) << table;
}

TEST_F(UnitMaterialColumns, AScenesOwnTableMayHaveThem) {
  write_text(m_folder / "scene.toml",
             "[volume]\npath = \"ball.nhdr\"\n[material]\npreset = \"brain\"\n"
             "plastic = [[0, 0.5]]\n[[step]]\ngrab = [4, 4, 4]\nby = [1, 0, 0]\n"
             "[output]\nstate = \"out.vdb\"\n");
  const Outcome outcome =
      run_supple({"run", m_folder / "scene.toml", "-o", m_folder.path(), "--force"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string table = read_state(m_folder / "out.vdb").material_toml;
  EXPECT_NE(table.find("stiffness = [[0, 6]]\n"), std::string::npos) << table;
  EXPECT_NE(table.find("plastic = [[0, 0.5]]\n"), std::string::npos) << table;
}

TEST_F(FaultMaterialColumns, AnUnknownPresetIsRefusedWithLineAndNames) {
  const std::string names = "one of \"soft-tissue\", \"bone\", \"brain\", \"membrane\"";
  expect_refused("domain = [0, 255]\npreset = \"muscle\"\n",
                 "2: preset: found \"muscle\", expected " + names);
  expect_refused("preset = \"bone\"\n[label.3]\npreset = \"\"\n",
                 "3: label.3.preset: found \"\", expected " + names);
  expect_refused("preset = 3\n", "1: preset: found 3, expected a string");
}

TEST_F(FaultMaterialColumns, WrongColumnsAreRefusedByNameAndUnit) {
  RUN_WHEN_SANITIZED();
  const std::string brain = "preset = \"brain\"\n";
  expect_refused(brain + "stifness = [[0, 6]]\n",
                 "2: stifness: found an unknown key, expected a known one: did you mean "
                 "'stiffness'?");
  expect_refused(brain + "[label.3]\npreset = \"bone\"\ndensty = [[0, 6]]\n",
                 "4: label.3.densty: found an unknown key, expected a known one: did you mean "
                 "'density'?");
  expect_refused(brain + "damping = true\n",
                 "2: damping: found true, expected a number or a list of [density, value] pairs");
  expect_refused(brain + "plastic = []\n",
                 "2: plastic: found an empty list, expected at least one [density, value] pair");
  expect_refused(brain + "stiffness = [[0, 0]]\n",
                 "1: stiffness key point 1: found [0, 0], expected stiffness > 0 kPa");
  expect_refused(brain + "density = [[0, -1]]\n",
                 "1: density key point 1: found [0, -1], expected density > 0 kg/m³");
}

TEST_F(FaultMaterialColumns, WithoutAPresetTheLimitsAreStillRequired) {
  expect_refused("stiffness = [[0, 6]]\n",
                 "1: max_length: found nothing, expected a number or a list");
}
