// The generated fundus: where its parts lie, and that a seed decides.
#include <gtest/gtest.h>

#include "raycast/microscope/microscope.h"
#include "volumes/base/error.h"
#include "volumes/base/units.h"

namespace supple {
namespace {

/// Mean of a channel around a place, mm from the posterior pole on a globe of 11 mm.
double mean_at(const TextureImage& image, double x_mm, double y_mm, std::size_t channel) {
  const double per_mm = image.width / (2 * kPi * 11);
  double sum = 0;
  int count = 0;
  for (int j = -4; j <= 4; ++j) {
    for (int i = -4; i <= 4; ++i, ++count) {
      const int x = int(image.width / 2.0 + (x_mm + i * 0.06) * per_mm);
      const int y = int(image.height / 2.0 - (y_mm + j * 0.06) * per_mm);
      sum += image.texels[std::size_t(y) * image.width + x][channel];
    }
  }
  return sum / count;
}

TEST(UnitFundus, DiscIsBrightMaculaDarkAndAllOrangeRed) {
  const TextureImage image = make_fundus(1024, 5);
  const double retina = mean_at(image, -7, 1, 1);
  EXPECT_GT(mean_at(image, 4.3, 0.35, 1), retina + 60);  // disc
  EXPECT_LT(mean_at(image, 0, 0.3, 1), retina - 10);     // macula
  for (const auto& [x, y] : {std::pair(-7.0, 1.0), {0.0, 9.0}, {9.0, -6.0}}) {
    EXPECT_GT(mean_at(image, x, y, 0), 1.5 * mean_at(image, x, y, 1));
    EXPECT_GT(mean_at(image, x, y, 1), mean_at(image, x, y, 2));
  }
}

TEST(UnitFundus, ASeedDecidesEveryTexel) {
  const TextureImage first = make_fundus(256, 5);
  EXPECT_EQ(first.texels, make_fundus(256, 5).texels);
  EXPECT_NE(first.texels, make_fundus(256, 6).texels);
  EXPECT_EQ(make_fundus(16, 1).texels.size(), 256u);
  EXPECT_THROW(make_fundus(4, 1), InputError);
}

}  // namespace
}  // namespace supple
