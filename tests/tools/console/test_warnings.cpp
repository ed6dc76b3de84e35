// Warnings of a run about results that stand all the same.
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

using namespace supple::test;

namespace {

class UnitWarnings : public ::testing::Test {
 protected:
  /// 64 x 64 x 54 voxels in HU, air at -1024.
  std::string head() {
    const auto bin = std::filesystem::path(std::getenv("SUPPLE_BINARY")).parent_path();
    const std::string path = m_folder / "head.nhdr";
    const std::string examples = std::filesystem::exists(bin / "supple-examples")
                                     ? (bin / "supple-examples").string()
                                     : "build/release/bin/supple-examples";
    EXPECT_EQ(run_program({examples, "phantom", "small-head", path}).exit_code, 0);
    return path;
  }
  Outcome run_done(const std::vector<std::string>& arguments) {
    const Outcome outcome = run_supple(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome;
  }
  /// Drags `grab` of a volume with a table of that text.
  Outcome deform(const std::string& volume, const std::string& table, const std::string& by,
                 const std::string& grab) {
    write_text(m_folder / "m.toml", table);
    return run_done({"deform", volume, "--material", m_folder / "m.toml", "--grab", grab, "--by",
                     by, "--json", "--force", "-o", m_folder / "d.vdb"});
  }
  static long long elements(const Outcome& outcome) {
    return nlohmann::json::parse(outcome.out)["elements"].get<long long>();
  }
  static bool says(const Outcome& outcome, const std::string& part) {
    return outcome.err.find(part) != std::string::npos;
  }

  TemporaryFolder m_folder;
};

const char* const kBallTable =
    "domain = [0, 255]\nactive = [1, 255]\nmax_length = [[0, 1.3]]\nmin_length = [[0, 0.7]]\n"
    "shear = [[0, 0.3]]\n";

}  // namespace

TEST_F(UnitWarnings, InfinityIsCountedApartFromNan) {
  const float values[] = {1,
                          std::numeric_limits<float>::infinity(),
                          -std::numeric_limits<float>::infinity(),
                          std::nanf(""),
                          2,
                          3,
                          4,
                          5};
  write_text(m_folder / "v.raw", std::string(reinterpret_cast<const char*>(values), sizeof values));
  const std::vector<std::string> info = {"info", m_folder / "v.raw", "--raw",
                                         "dims=2,2,2,type=float32,spacing=1,1,1", "--json"};
  const Outcome outcome = run_done(info);
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["nan_voxels"], 1);
  EXPECT_EQ(json["infinite_voxels"], 2);
  EXPECT_TRUE(says(outcome, "1 NaN voxel and 2 infinite voxels count as void")) << outcome.err;
}

TEST_F(UnitWarnings, ASpaceThatNamesNoPatientAxesIsSaid) {
  const std::string header =
      "\ndimension: 3\ntype: uint8\nsizes: 2 2 2\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n"
      "encoding: raw\n\n12345678";
  for (const char* space : {"scanner-xyz", "3D-left-handed"}) {
    write_text(m_folder / "v.nrrd", "NRRD0004\nspace: " + std::string(space) + header);
    EXPECT_TRUE(says(run_done({"info", m_folder / "v.nrrd"}),
                     "space " + std::string(space) + " does not name the patient's axes"));
  }
  write_text(m_folder / "v.nrrd", "NRRD0004\nspace: RAS" + header);
  EXPECT_EQ(run_done({"info", m_folder / "v.nrrd"}).err, "");
}

TEST_F(UnitWarnings, APresetAloneTakesTheTissueOfACtForTheBody) {
  const std::string ct = head(), grab = "32,54,20";
  const Outcome alone = deform(ct, "preset = \"soft-tissue\"\n", "0,2,0", grab);
  const Outcome told =
      deform(ct, "preset = \"soft-tissue\"\ndomain = [-300, 4000]\n", "0,2,0", grab);
  EXPECT_EQ(elements(alone), elements(told));
  EXPECT_FALSE(says(alone, "the domain")) << alone.err;
  // What the table says itself stays, and so does the domain of densities that are not HU.
  EXPECT_LT(elements(deform(ct, "preset = \"soft-tissue\"\nactive = [-100, 100]\n", "0,2,0", grab)),
            elements(told));
  write_ball(m_folder, "ball", 16);
  EXPECT_EQ(
      elements(deform(m_folder / "ball.nhdr", "preset = \"soft-tissue\"\n", "1,0,0", "8,8,8")),
      16 * 16 * 16);
}

TEST_F(UnitWarnings, APresetAloneTakesWhatLiesAboveTheLeastOfOtherDensitiesAndSaysSo) {
  std::string values;
  for (int n = 0; n < 16 * 16 * 16; ++n) {
    const std::int16_t value = n % 16 < 4 ? 7 : std::int16_t(7 + n % 4000);
    values.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  write_text(m_folder / "mri.nrrd",
             "NRRD0004\ntype: short\nendian: little\ndimension: 3\nspace: LPS\nsizes: 16 16 16\n"
             "space directions: (1,0,0) (0,1,0) (0,0,1)\nencoding: raw\n\n" +
                 values);
  const Outcome alone = deform(m_folder / "mri.nrrd", "preset = \"brain\"\n", "1,0,0", "8,8,8");
  EXPECT_EQ(elements(alone), 12 * 16 * 16);
  EXPECT_TRUE(says(alone,
                   "material: densities from 7 to 4006 are neither HU nor 0 to 255: every voxel "
                   "above 7 is tissue; active = [LO, HI] in the table chooses others"))
      << alone.err;
  EXPECT_FALSE(says(alone, "misses")) << alone.err;
  const Outcome told =
      deform(m_folder / "mri.nrrd", "preset = \"brain\"\nactive = [100, 5000]\n", "1,0,0", "8,8,8");
  EXPECT_LT(elements(told), 12 * 16 * 16);
  EXPECT_FALSE(says(told, "neither")) << told.err;
}

TEST_F(UnitWarnings, ADomainThatMissesMostOfTheTissueIsToldWithNumbers) {
  const Outcome shred = deform(head(),
                               "domain = [150, 255]\n"
                               "max_length = [[150, 1.3], [200, 1.2]]\n"
                               "min_length = [[150, 0.7]]\nshear = [[150, 0.3]]\n"
                               "active = [-300, 3000]\n",
                               "0,2,0", "32,54,20");
  EXPECT_TRUE(says(shred, "material: the domain, 150 to 255, misses ")) << shred.err;
  EXPECT_TRUE(says(shred, "voxels of tissue (at least -300 HU); densities reach from -"))
      << shred.err;
  const std::string wide =
      "domain = [-300, 1500]\nmax_length = [[-300, 1.3], [1500, 1.2]]\n"
      "min_length = [[0, 0.7]]\nshear = [[0, 0.3]]\n";
  EXPECT_FALSE(says(deform(head(), wide, "0,2,0", "32,54,20"), "misses"));
  write_ball(m_folder, "ball", 16);
  const Outcome bright = deform(m_folder / "ball.nhdr",
                                "domain = [0, 30]\n"
                                "max_length = [[0, 1.3], [30, 1.2]]\n"
                                "min_length = [[0, 0.7]]\n"
                                "shear = [[0, 0.3]]\n"
                                "active = [1, 255]\n",
                                "1,0,0", "8,8,8");
  EXPECT_TRUE(says(bright, "of tissue (above 0)")) << bright.err;
}

TEST_F(UnitWarnings, ABodyThatLeavesTheBoxAndAnEmptyPictureAreSaid) {
  write_ball(m_folder, "ball", 16);
  const std::string ball = m_folder / "ball.nhdr";
  const Outcome gone = deform(ball, kBallTable, "0,12000,0", "8,8,8");
  const std::string count = std::to_string(elements(gone));
  EXPECT_TRUE(says(gone, "of " + count + " elements lie outside of the volume's box")) << gone.err;
  const std::string image = m_folder / "a.png";
  const std::vector<std::string> render = {
      "render", m_folder / "d.vdb", "--size", "32,32", "--force", "-o", image};
  EXPECT_TRUE(says(run_done(render), image + ": nothing is to be seen")) << image;
  const Outcome near = deform(ball, kBallTable, "0,1,0", "8,8,8");
  EXPECT_FALSE(says(near, "outside of the volume's box")) << near.err;
  EXPECT_FALSE(says(run_done(render), "nothing is to be seen"));
}

TEST_F(UnitWarnings, APresetThatIsClearAtSmallVoxelsIsSaid) {
  const std::string volume = head(), image = m_folder / "a.png";
  const auto render = [&](const std::string& spacing, const std::string& look) {
    return run_done({"render", volume, "--spacing", spacing, "--preset", look, "--size", "32,32",
                     "-o", image, "--force"});
  };
  EXPECT_FALSE(says(render("2,2,2", "Bone"), "is clear"));
  const Outcome small = render("0.01,0.01,0.01", "Bone");
  EXPECT_TRUE(says(small, "preset Bone is clear at voxels of 0.01 mm")) << small.err;
  EXPECT_TRUE(says(small, "0.01 shows more")) << small.err;
}

TEST_F(UnitWarnings, ExportSaysWhatTheWarpIsGoodFor) {
  write_ball(m_folder, "ball", 24);
  deform(m_folder / "ball.nhdr", kBallTable, "0,8,0", "12,12,12");
  const std::string warp = m_folder / "w.nrrd";
  const auto export_with = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"export", m_folder / "d.vdb", "--force", "-o", warp};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_done(arguments);
  };
  const Outcome nearest = export_with({});
  EXPECT_TRUE(
      says(nearest, warp + ": for resampling images; neighbouring vectors differ by up to"));
  EXPECT_TRUE(says(nearest, "of them fold where tissue meets void (void extend is smooth"))
      << nearest.err;
  const Outcome smooth = export_with({"--void", "extend"});
  EXPECT_TRUE(says(smooth, "smooth beyond the tissue, for points")) << smooth.err;
  EXPECT_TRUE(says(smooth, "none fold")) << smooth.err;
  EXPECT_TRUE(says(export_with({"--direction", "material"}), "for moving points"));
}
