#include <gtest/gtest.h>

#include "lib/state/pose.h"
#include "tests/support/random_state.h"
#include "volumes/field/offset_field.h"

using namespace supple;
using namespace supple::test;

namespace {

/// Offsets of up to three voxels in some bricks, none in others.
void drag_at_random(std::mt19937& random, const BrickTopology& elements,
                    std::array<BrickValues, 3>& q) {
  std::uniform_int_distribution<std::int32_t> offset(-3 * 65536, 3 * 65536);
  for (BrickValues& values : q) {
    for (std::size_t b = 0; b < elements.brick_count(); ++b) {
      if (random() % 4 != 0) continue;
      if (random() % 3 == 0) {
        values.release(b);
        continue;
      }
      for_each_active(elements.mask(b), [&](int n) {
        if (random() % 2 == 0) values.set(b * kBrickVoxels + std::size_t(n), offset(random));
      });
    }
  }
}

}  // namespace

TEST(PropertyLiveDisplacement, AfterEveryDragItHasTheBitsOfTheWholeExtension) {
  std::mt19937 random(41);
  for (const int rings : {1, 2, 10}) {
    const Vec3i dims(40, 33, 30);
    State state;
    state.geometry = {dims, {0, 0, 0}, {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}}};
    state.elements = bricks_where(dims, [](const Vec3i& v) {
      return (Vec3d(v) - Vec3d(18, 15, 14)).length() < 11 || v.x > 33;
    });
    const BrickTopology shell = dilate(dilate(state.elements, rings / 2), rings - rings / 2);
    for (BrickValues& values : state.q) values.resize(state.elements.brick_count());
    LiveDisplacement live(state.geometry, state.elements, shell);
    for (int step = 0; step < 4; ++step) {
      const std::vector<Vec3f> before = live.displacement().u.vectors.all();
      drag_at_random(random, state.elements, state.q);
      const std::vector<std::int32_t> changed = live.update(state.q);
      const Displacement whole = extend(displacement_of(state), shell);
      ASSERT_TRUE(live.displacement().u.topology == whole.u.topology);
      ASSERT_EQ(live.displacement().u.vectors, whole.u.vectors) << rings;
      // Nothing changed in bricks that it does not name.
      for (std::size_t n = 0; n < before.size(); ++n) {
        const auto brick = std::int32_t(n / kBrickVoxels);
        if (std::binary_search(changed.begin(), changed.end(), brick)) continue;
        ASSERT_EQ(before[n], whole.u.vectors.at(n));
      }
    }
    EXPECT_TRUE(live.update(state.q).empty());
  }
}
