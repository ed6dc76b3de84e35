// Rigid pieces by the program: what `deform` and `run` list as JSON.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

using namespace supple;
using namespace supple::test;

namespace {

/// Two bones of 3³ and 5 · 3 · 3 voxels in soft tissue of 16 · 9 · 9 voxels.
class UnitPiecesListed : public ::testing::Test {
 protected:
  UnitPiecesListed() {
    std::string voxels;
    for (int n = 0; n < 16 * 9 * 9; ++n) {
      const int i = n % 16, j = n / 16 % 9, k = n / 144;
      const bool is_inside = j >= 3 && j <= 5 && k >= 3 && k <= 5;
      const bool is_bone = is_inside && ((i >= 2 && i <= 4) || (i >= 8 && i <= 12));
      voxels += char(static_cast<unsigned char>(n == 0 ? 0 : is_bone ? 200 : 100));
    }
    write_text(m_folder / "two.raw", voxels);
    write_text(m_folder / "two.nhdr",
               "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\n"
               "sizes: 16 9 9\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n"
               "space origin: (0,0,0)\nencoding: raw\ndata file: two.raw\n");
    write_text(m_folder / "scene.toml",
               "[volume]\npath = \"two.nhdr\"\n[material]\ndomain = [0, 255]\nactive = [1, 255]\n"
               "max_length = [[0, 1.5]]\nmin_length = [[0, 0.6]]\nshear = [[0, 0.28]]\n"
               "rigid = [180, 255]\n[[step]]\njoint = 5\n"
               "rigid = [{ name = \"small\", grab_box = [2, 3, 3, 4, 5, 5] }]\n"
               "grab = [3, 4, 4]\nby = [0, 0, 1]\nfix = [[10, 4, 4]]\n"
               "[output]\nstate = \"two.vdb\"\n");
  }

  TemporaryFolder m_folder;
};

}  // namespace

TEST_F(UnitPiecesListed, ARunListsPiecesAndCountsTheLinksThatAJointParts) {
  const Outcome outcome =
      run_supple({"run", m_folder / "scene.toml", "-o", m_folder / "out", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  const auto& pieces = json.at("rigid_pieces");
  ASSERT_EQ(pieces.size(), 2u);
  EXPECT_EQ(pieces[1].at("name"), "small");
  EXPECT_EQ(pieces[1].at("elements"), 27);
  EXPECT_NEAR(pieces[1].at("shift_voxels").at(2).get<double>(), 1, 1e-4);
  EXPECT_EQ(pieces[0].at("shift_voxels").at(2), 0);
  EXPECT_GT(json.at("steps")[0].at("cut_links").get<int>(), 0);
}
