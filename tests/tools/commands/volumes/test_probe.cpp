// supple probe: places of volumes and states against what is known of them.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "tests/support/sanitized.h"

using namespace supple::test;

namespace {

/// A ball of 16^3 voxels of 1 x 1 x 1.5 mm at the origin, so that LPS mm are i, j, 1.5 k.
class UnitProbe : public ::testing::Test {
 protected:
  void SetUp() override {
    write_ball(m_folder, "ball", 16);
    write_soft_material(m_folder / "soft.toml");
  }

  nlohmann::json probe(const std::string& file, std::vector<std::string> options) {
    options.insert(options.begin(), {"probe", m_folder / file, "--json"});
    const Outcome outcome = run_supple(options);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return nlohmann::json::parse(outcome.out)["places"];
  }

  TemporaryFolder m_folder;
};

using List = std::vector<double>;

}  // namespace

TEST_F(UnitProbe, AVolumeTellsPlaceInAllFramesAndItsStoredDensity) {
  const auto places =
      probe("ball.nhdr", {"--at", "8,7,6", "--at", "lps:8.2,7,9.3", "--at", "ras:-1,-2,3"});
  ASSERT_EQ(places.size(), 3u);
  EXPECT_EQ(places[0]["lps_mm"].get<List>(), (List{8, 7, 9}));
  EXPECT_EQ(places[0]["ras_mm"].get<List>(), (List{-8, -7, 9}));
  const std::string raw = read_text(m_folder / "ball.raw");
  EXPECT_EQ(places[0]["density"], double(static_cast<unsigned char>(raw[(6 * 16 + 7) * 16 + 8])));
  EXPECT_EQ(places[1]["voxel"].get<List>(), (List{8, 7, 6}));
  EXPECT_NEAR(places[1]["index"][2].get<double>(), 6.2, 1e-12);
  EXPECT_EQ(places[1]["density"], places[0]["density"]);
  EXPECT_EQ(places[2]["voxel"].get<List>(), (List{1, 2, 2}));
  EXPECT_EQ(places[2]["density"], 0);
  EXPECT_FALSE(places[0].contains("class"));
}

TEST_F(UnitProbe, AMaterialTellsClassAndLimitsAndWhatIsNoElement) {
  const auto places =
      probe("ball.nhdr", {"--material", m_folder / "soft.toml", "--at", "8,8,8", "--at", "0,0,0"});
  EXPECT_EQ(places[0]["element"], true);
  EXPECT_EQ(places[0]["class"], 200);
  ASSERT_EQ(places[0]["links"].size(), 6u);
  for (const auto& link : places[0]["links"]) {
    EXPECT_DOUBLE_EQ(link["min_length"], 0.7);
    EXPECT_DOUBLE_EQ(link["max_length"], 1.3);
    EXPECT_EQ(link["shear"].get<List>(), (List{0.3, 0.3}));
  }
  EXPECT_EQ(places[1]["element"], false);
  EXPECT_EQ(places[1]["density"], 0);
}

TEST_F(UnitProbe, AStateTellsWhereTissueWentAndWhereItCameFrom) {
  RUN_WHEN_SANITIZED();
  ASSERT_EQ(run_supple({"deform", m_folder / "ball.nhdr", "--material", m_folder / "soft.toml",
                        "--grab", "7,7,7:9,9,9", "--by", "2,0,-1.5", "-o", m_folder / "d.vdb"})
                .exit_code,
            0);
  const auto places = probe("d.vdb", {"--at", "8,8,8", "--at", "10,8,7"});
  EXPECT_EQ(places[0]["displacement_mm"].get<List>(), (List{2, 0, -1.5}));
  EXPECT_EQ(places[0]["moved_to_lps_mm"].get<List>(), (List{10, 8, 10.5}));
  const auto offset = places[1]["offset_mm"].get<List>();
  const auto from = places[1]["came_from_lps_mm"].get<List>();
  const List expected_offset = {-2, 0, 1.5}, expected_from = {8, 8, 12};
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(offset[c], expected_offset[c], 1e-3);
    EXPECT_NEAR(from[c], expected_from[c], 1e-3);
  }
  EXPECT_EQ(places[0]["links"].size(), 6u);
}

TEST_F(UnitProbe, PlacesOutsideAndTextsThatAreNoneAreRefused) {
  const auto refused = [&](const std::string& at, int code, const std::string& word) {
    const Outcome outcome = run_supple({"probe", m_folder / "ball.nhdr", "--at", at});
    EXPECT_EQ(outcome.exit_code, code) << outcome.err;
    EXPECT_NE(outcome.err.find(word), std::string::npos) << outcome.err;
  };
  refused("16,0,0", 3, "inside the volume");
  refused("lps:-1,0,0", 3, "inside the volume");
  refused("1,2", 2, "--at");
  refused("mni:1,2,3", 2, "--at");
  EXPECT_EQ(run_supple({"probe", m_folder / "ball.nhdr"}).exit_code, 2);
}
