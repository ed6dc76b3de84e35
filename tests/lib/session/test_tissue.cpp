// Tissue of a volume by its densities: where the background of a picture ends.
#include <fstream>
#include <random>

#include <gtest/gtest.h>

#include "lib/material/material.h"
#include "lib/material/tissue.h"
#include "lib/session/session.h"
#include "tests/support/errors.h"
#include "tests/support/temporary_folder.h"

using namespace supple;
using namespace supple::test;

namespace {

/// A head in noisy air, of 8 bits: bright skin and brain, dark bone between them, and a bright
/// speck beside it.
void write_head(const std::string& path, double noise) {
  constexpr int kSize = 48;
  std::mt19937 random(3);
  std::normal_distribution<double> spread(0, 1);
  std::string values;
  for (int k = 0; k < kSize; ++k) {
    for (int j = 0; j < kSize; ++j) {
      for (int i = 0; i < kSize; ++i) {
        const double x = i - 24, y = j - 24, z = k - 24;
        const double r = std::sqrt(x * x + y * y + z * z);
        double value = r < 14 ? 150 : r < 17 ? 60 : r < 20 ? 190 : 0;
        if (i < 3 && j < 3 && k < 3) value = 180;
        value = std::abs(value + noise * spread(random));
        values += char(static_cast<unsigned char>(std::min(value, 255.0)));
      }
    }
  }
  std::ofstream(path, std::ios::binary)
      << "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\n"
         "sizes: 48 48 48\nspace directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\n"
         "encoding: raw\n\n"
      << values;
}

std::int64_t elements_of(const std::string& path, const std::string& material) {
  SessionOptions options;
  options.material = parse_material(material, "test");
  return Session(path, options).body().elements.active_count();
}

}  // namespace

TEST(UnitTissue, TheBackgroundEndsBetweenAirAndDarkTissue) {
  // Air in bins 0 to 2, dark tissue in 20, bright tissue in 60.
  std::vector<std::int64_t> counts(64, 0);
  counts[0] = 500;
  counts[2] = 100;
  counts[20] = 100;
  counts[60] = 300;
  EXPECT_EQ(last_bin_of_background(counts), 2);
  // No air: what is dark is background, as nothing says otherwise.
  std::vector<std::int64_t> two(64, 0);
  two[10] = 100;
  two[50] = 100;
  EXPECT_EQ(last_bin_of_background(two), 10);
  // A volume of one value is all tissue.
  EXPECT_EQ(last_bin_of_background({7}), -1);
  EXPECT_EQ(last_bin_of_background({0, 0, 7, 0}), -1);
}

TEST(UnitTissue, MrBrainFindsTheHeadAndLeavesAirOut) {
  const TemporaryFolder folder;
  for (const double noise : {0.0, 6.0}) {
    write_head(folder / "head.nrrd", noise);
    const double ball = 4.0 / 3 * 3.14159265 * 20 * 20 * 20;
    const auto found = double(elements_of(folder / "head.nrrd", "preset = \"mr-brain\"\n"));
    EXPECT_NEAR(found, ball, 0.02 * ball) << noise;
  }
}

TEST(UnitTissue, DensitiesThatAreGivenComeBeforeTheForeground) {
  const TemporaryFolder folder;
  write_head(folder / "head.nrrd", 0);
  const std::string own = "preset = \"mr-brain\"\nactive = [1, 255]\n";
  const double ball = 4.0 / 3 * 3.14159265 * 20 * 20 * 20;
  EXPECT_NEAR(double(elements_of(folder / "head.nrrd", own)), ball + 27, 0.02 * ball);
  EXPECT_EQ(parse_material(own, "own").components, 0);
  EXPECT_EQ(elements_of(folder / "head.nrrd", own + "components = \"largest\"\n") + 27,
            elements_of(folder / "head.nrrd", own));
  const MaterialTable preset = read_material("mr-brain");
  EXPECT_TRUE(preset.finds_foreground && preset.components == 1);
  EXPECT_EQ(material_to_toml(parse_material(material_to_toml(preset), "text")),
            material_to_toml(preset));
  const std::string error =
      input_error([] { parse_material("preset = \"brain\"\nactive = \"front\"\n", "own"); });
  EXPECT_NE(error.find("\"foreground\""), std::string::npos) << error;
}

TEST(UnitTissue, AStateKeepsTheDensitiesThatWereFound) {
  const TemporaryFolder folder;
  write_head(folder / "head.nrrd", 0);
  SessionOptions options;
  options.material = read_material("mr-brain");
  Session session(folder / "head.nrrd", options);
  EXPECT_FALSE(session.material().finds_foreground);
  EXPECT_GT(session.material().active_lo, 0);
  EXPECT_LE(session.material().active_lo, 60);
  session.write_state(folder / "head.vdb");
  const Session again(folder / "head.vdb");
  EXPECT_EQ(again.material().active_lo, session.material().active_lo);
  EXPECT_EQ(again.body().elements.active_count(), session.body().elements.active_count());
}
