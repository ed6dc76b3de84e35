// Points beside open cuts, there and back again (docs/apply.md).
#include <gtest/gtest.h>

#include "tests/support/random_state.h"
#include "tests/support/sanitized.h"
#include "tests/volumes/field/offset_fixtures.h"
#include "volumes/field/offset_field.h"
#include "volumes/field/points/point_motion.h"
#include "volumes/grid/cell.h"

using namespace supple;
using namespace supple::test;

namespace {

using Law = std::function<double(const Vec3d&)>;

/// A block or ball with a cut along a surface, which ends in the body and gapes.
struct GapingBody {
  BrickTopology elements;
  LinkCuts cuts;
  Displacement extended;
  OffsetField offsets;

  std::unique_ptr<PointMotion> along() const { return motion_along(extended, {elements, cuts}); }
  std::unique_ptr<PointMotion> to_rest() const {
    return motion_to_rest(extended, {elements, cuts}, offsets);
  }
};

/// Links that cross the surface where `end` is positive are cut.
LinkCuts cuts_along(const BrickTopology& elements, const Law& surface, const Law& end,
                    bool with_places) {
  LinkCuts cuts;
  for (std::size_t b = 0; b < elements.brick_count(); ++b) {
    for_each_active(elements.mask(b), [&](int offset) {
      const Vec3i low = elements.origin(b) + brick_local(offset);
      for (int axis = 0; axis < 3; ++axis) {
        Vec3i high = low;
        ++high[axis];
        const double one = surface(Vec3d(low)), other = surface(Vec3d(high));
        if (!elements.is_active(high) || (one < 0) == (other < 0)) continue;
        const double part = one / (one - other);
        if (end(Vec3d(low) * (1 - part) + Vec3d(high) * part) <= 0) continue;
        cuts.cut(b, offset, axis, with_places ? LinkCuts::place_of(part) : 0);
      }
    });
  }
  return cuts;
}

/// Number `seed`, drawn at random; odd ones are balls, of every other pair the surface of the cut
/// is known. Every third touches the border of its grid.
GapingBody gaping_body(unsigned seed) {
  std::mt19937 random(seed);
  const auto uniform = [&](double lo, double hi) {
    return std::uniform_real_distribution<double>(lo, hi)(random);
  };
  GapingBody body;
  const Vec3i lo = seed % 3 == 2 ? Vec3i(0) : Vec3i(4), hi = lo + Vec3i(15, 15, 11);
  const Vec3d middle = (Vec3d(lo) + Vec3d(hi)) / 2;
  body.elements = topology_where(
      lo, hi, [&](const Vec3i& v) { return seed % 2 == 0 || (Vec3d(v) - middle).length() < 7.4; });
  const Vec3d normal = (Vec3d(1, 0, 0) + Vec3d(random_vector(random, 0.4f))).normalized();
  const Law surface = [&](const Vec3d& X) { return normal.dot(X - middle) + 0.13; };
  const double slope = uniform(-1, 1), depth = uniform(-1, 2);
  const Law end = [&](const Vec3d& X) {
    return depth - (X.y - middle.y) + slope * (X.z - middle.z);
  };
  body.cuts = cuts_along(body.elements, surface, end, seed % 4 < 2);
  const Vec3d lips = normal * uniform(0.02, 0.2) + Vec3d(random_vector(random, 0.1f));
  const Vec3d bend(random_vector(random, 0.05f)), shift(random_vector(random, 1));
  const auto u = [&](const Vec3i& v) {
    const Vec3d X(v);
    const double open = std::max(end(X), 0.0) * (surface(X) < 0 ? -1 : 1);
    return Vec3f(shift + lips * open + bend * (X.x - middle.x) +
                 Vec3d(std::sin(X.y), std::cos(X.z), std::sin(X.x + X.y)) * 0.03);
  };
  const Geometry geometry = random_geometry(random, hi + Vec3i(seed % 3 == 2 ? 1 : 5));
  const IndexBox around = seed % 3 == 2 ? IndexBox{lo, hi} : IndexBox{lo - Vec3i(2), hi + Vec3i(2)};
  body.extended = extend_past_cuts({geometry, field_on(body.elements, u)},
                                   box_topology(around.lo, around.hi), {body.elements, body.cuts});
  body.offsets = invert_cut(body.extended, {body.elements, body.cuts});
  return body;
}

}  // namespace

/// Around the end of a cut the map covers places twice, by less than half a voxel: its cell is
/// stretched between the lips while these go on beside it. Every such place is named.
TEST(PropertyPointsBesideCuts, ThereAndBackAgainIsTheSamePlaceOrANamedOne) {
  int points = 0, named = 0;
  for (unsigned seed = 0; seed < (kSanitized ? 2 : 9); ++seed) {
    const GapingBody body = gaping_body(seed);
    if (body.offsets.split == nullptr) continue;
    const Geometry& geometry = body.extended.geometry;
    const auto along = body.along(), to_rest = body.to_rest();
    for_each_slot(body.elements, [&](const Vec3i& voxel, std::size_t) {
      for (int n = 0; n < kCellCorners; ++n) {
        const Vec3d X = Vec3d(voxel) - Vec3d(0.375, 0.25, 0.3125) + Vec3d(cell_corner(n)) * 0.5;
        const MovedPoint there = along->move(geometry.world_from_index(X));
        if (there.kind != PlaceKind::inside) continue;
        const MovedPoint back = to_rest->move(there.to_lps_mm);
        const double miss = (geometry.index_from_world(back.to_lps_mm) - X).length();
        ++points;
        if (miss <= 1e-4) continue;
        EXPECT_TRUE(back.kind == PlaceKind::folded || back.kind == PlaceKind::torn)
            << "body " << seed << ", " << X << " by " << miss;
        // Both have come there.
        const MovedPoint again = along->move(back.to_lps_mm);
        const Vec3d apart = geometry.index_vector_from_world(again.to_lps_mm - there.to_lps_mm);
        EXPECT_LT(apart.length(), 1e-5) << "body " << seed << ", " << X;
        ++named;
      }
    });
  }
  EXPECT_GT(points, kSanitized ? 20000 : 100000);
  EXPECT_GT(named, 0);
  EXPECT_LT(named, points / 200);
}
