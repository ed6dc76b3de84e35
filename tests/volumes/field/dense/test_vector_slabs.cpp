// Slices of a sparse field against voxel by voxel.
#include <gtest/gtest.h>

#include "tests/support/field_fixtures.h"
#include "volumes/field/dense/resample.h"

namespace supple::test {
namespace {

TEST(PropertyVectorSlabs, EverySliceHoldsTheVectorsOfItsVoxelsInAnyOrderOfAsking) {
  std::mt19937 random(35);
  std::bernoulli_distribution is_there(0.7);
  const VectorBricks field =
      field_on(topology_where(Vec3i(-9), Vec3i(20), [&](const Vec3i&) { return is_there(random); }),
               [&](const Vec3i&) { return random_vector(random, 3); });
  const Vec3i left_out(8, 0, -8);
  for (const Vec3i& first : {Vec3i(-13, -3, -16), Vec3i(0), Vec3i(5, -8, 3)}) {
    const Vec3i dims(27, 11, 21);
    VectorSlabs slabs(field, first, dims, [&](const Vec3i& brick) { return brick == left_out; });
    for (const int k : {0, 1, 2, 20, 7, 8, 9, 15, 0, 13}) {
      const Vec3f* const slice = slabs.slice(k);
      for (int j = 0; j < dims.y; ++j) {
        for (int i = 0; i < dims.x; ++i) {
          const Vec3i voxel = first + Vec3i(i, j, k);
          const Vec3f& found = slice[j * dims.x + i];
          Vec3f expected;
          const bool in_left_out = voxel.x >> 3 == 1 && voxel.y >> 3 == 0 && voxel.z >> 3 == -1;
          if (!in_left_out && field.at(voxel, expected)) {
            ASSERT_EQ(found, expected) << voxel;
          } else {
            ASSERT_TRUE(std::isnan(found.x)) << voxel;
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace supple::test
