// A body that touches the border of its grid keeps its outermost layer: up to half a voxel beyond
// the border a place belongs to the border voxel, for the inverse and for every reader of it.
#include <gtest/gtest.h>

#include "tests/volumes/field/offset_fixtures.h"
#include "volumes/field/cuts/cut_offsets.h"
#include "volumes/field/dense/resample.h"
#include "volumes/field/inversion/forward_offsets.h"
#include "volumes/field/inversion/hidden_elements.h"
#include "volumes/field/inversion/invert.h"
#include "volumes/field/points/point_motion.h"
#include "volumes/grid/cell.h"

using namespace supple;
using namespace supple::test;

namespace {

const Vec3i kDims(10, 12, 14);

/// Pulled together about its middle along each axis by these parts.
Displacement pulled(const Vec3d& parts) {
  return displacement_on(box_topology(Vec3i(0), kDims - Vec3i(1)), [=](const Vec3i& v) {
    return Vec3f(-(Vec3d(v) - Vec3d(kDims - Vec3i(1)) / 2) * parts);
  });
}

/// The density of the source is 100 everywhere, that of the void 0.
float seen_at(const Displacement& displacement, const OffsetField& field, const Vec3i& voxel) {
  const Vec3i& dims = displacement.geometry.dims();
  const auto slices = dense_resampled(
      field, [](const Vec3d&) { return 100.0f; }, displacement.geometry, 0);
  std::vector<float> slice(std::size_t(dims.x) * dims.y);
  slices(voxel.z, slice.data());
  return slice[std::size_t(voxel.y) * dims.x + voxel.x];
}

}  // namespace

TEST(UnitBorder, APlaceUpToHalfAVoxelBeyondItIsThatOfTheBorderVoxel) {
  EXPECT_EQ(within_border({-0.5, 3.25, 13.5}, kDims), Vec3d(0, 3.25, 13));
  EXPECT_EQ(within_border({-0.51, 11.51, 13.51}, kDims), Vec3d(-0.51, 11.51, 13.51));
  EXPECT_EQ(within_border({4, 7, 0.2}, {8, 8, 1}), Vec3d(4, 7, 0));
}

/// Along each axis the way from the border, of which half a voxel is read.
TEST(UnitBorder, ALayerThatDrawsBackByLessThanHalfAVoxelStays) {
  for (const double way : {1.0 / 65536, 0.001, 0.3, 0.499, 0.501, 2.0}) {
    const Vec3d parts = Vec3d(way * 2) / Vec3d(kDims - Vec3i(1));
    const Displacement displacement = pulled(parts);
    const OffsetField field = invert(displacement);
    std::int64_t missing = 0, seen = 0;
    const auto slices = dense_resampled(
        field, [](const Vec3d&) { return 100.0f; }, displacement.geometry, 0);
    std::vector<float> slice(std::size_t(kDims.x) * kDims.y);
    for (int k = 0; k < kDims.z; ++k) {
      slices(k, slice.data());
      for (int j = 0; j < kDims.y; ++j) {
        for (int i = 0; i < kDims.x; ++i) {
          const Vec3d x(i, j, k);
          const Vec3d middle = Vec3d(kDims - Vec3i(1)) / 2;
          bool is_there = true;  // of what lies at rest at most half a voxel beyond
          for (int a = 0; a < 3; ++a) {
            const double rest = (x[a] - middle[a]) / (1 - parts[a]);
            is_there = is_there && std::abs(rest) < middle[a] + 0.5;
          }
          const float value = slice[std::size_t(j) * kDims.x + i];
          EXPECT_EQ(value, is_there ? 100.0f : 0.0f) << x << " after " << way;
          missing += is_there && value == 0;
          seen += value != 0;
        }
      }
    }
    EXPECT_EQ(missing, 0);
    EXPECT_GT(seen, 0);
    EXPECT_LT(field.certificate.residual_max, 1e-4) << way;
    EXPECT_EQ(count_hidden(displacement, displacement.u.topology, field, {}), 0) << way;
  }
}

TEST(UnitBorder, AShiftAcrossItLeavesTheSideThatItCameFromHalfAVoxelLonger) {
  for (const float shift : {0.25f, 0.5f, 0.75f, 1.25f, 1.75f}) {
    const Displacement displacement = displacement_on(
        box_topology(Vec3i(0), kDims - Vec3i(1)), [&](const Vec3i&) { return Vec3f(shift, 0, 0); });
    const OffsetField field = invert(displacement);
    for (int i = 0; i < 4; ++i) {
      EXPECT_EQ(seen_at(displacement, field, {i, 0, 13}), float(i) >= shift - 0.5f ? 100 : 0)
          << shift << i;
    }
    EXPECT_EQ(field.certificate.residual_max, 0);
  }
}

/// Beside a body that ends within the grid, where places on its last plane need no voxel beyond it.
TEST(UnitBorder, TheCertificateKnowsSourcesOnTheLastPlaneOfABodyAtTheBorder) {
  Displacement displacement = displacement_on(box_topology(Vec3i(0), {9, 5, 13}),
                                              [&](const Vec3i&) { return Vec3f(0, 0, 0.25f); });
  displacement.geometry = displacement.geometry.with_dims(kDims);
  const OffsetField field = invert(displacement);
  Vec3f offset;
  ASSERT_TRUE(field.o.at({4, 5, 0}, offset));
  EXPECT_EQ(offset, Vec3f(0, 0, -0.25f));
  EXPECT_LT(field.certificate.residual_max, 1e-6);
}

/// Samples that solve for themselves agree with nodes, edges and corners of the box among them.
TEST(PropertyBorder, SamplesWithoutAnInverseAgree) {
  std::mt19937 random(5);
  const BrickTopology where = box_topology(Vec3i(0), Vec3i(20));
  Displacement displacement = noisy_displacement(random, where, 0.12f, Vec3f(0.3f, -0.2f, 0.4f));
  const ForwardOffsets offsets(displacement);
  const OffsetField inverse = invert(displacement);
  int beyond = 0;
  for_each_slot(inverse.o.topology, [&](const Vec3i& v, std::size_t slot) {
    const Vec3d offset(inverse.o.vectors.at(slot)), place = Vec3d(v) + offset;
    for (int a = 0; a < 3; ++a) {
      if (place[a] < -0.49 || place[a] > 20.49) return;  // too near to the end
    }
    const std::int32_t b = offsets.bricks().find(v);
    ASSERT_GE(b, 0);
    PointwiseOffsets::Sample found;
    ASSERT_TRUE(offsets.sample(std::size_t(b), Vec3d(v), found)) << v;
    ASSERT_LT((found.offset - offset).length(), 1e-3) << v;
    beyond += within_border(place, Vec3i(21)) != place;
  });
  EXPECT_GT(beyond, 100);
}

/// The same body in a larger grid, carried on linearly for three voxels, has the same offsets.
TEST(PropertyBorder, ABodyWithTissueBesideItHasTheSameOffsets) {
  std::mt19937 random(6);
  const int last = 17;
  const Displacement small = noisy_displacement(random, box_topology(Vec3i(0), Vec3i(last)), 0.02f,
                                                Vec3f(0.2f, 0.4f, -0.3f));
  const std::function<Vec3f(const Vec3i&)> carried_on = [&](const Vec3i& v) {
    for (int a = 0; a < 3; ++a) {
      if (v[a] >= 0 && v[a] <= last) continue;
      Vec3i at = v, next = v;
      at[a] = v[a] < 0 ? 0 : last;
      next[a] = v[a] < 0 ? 1 : last - 1;
      return carried_on(at) + (carried_on(at) - carried_on(next)) * float(std::abs(v[a] - at[a]));
    }
    Vec3f u(0);
    EXPECT_TRUE(small.u.at(v, u));
    return u;
  };
  const Displacement large =
      displacement_on(box_topology(Vec3i(0), Vec3i(last + 6)),
                      [&](const Vec3i& v) { return carried_on(v - Vec3i(3)); });
  const OffsetField own = invert(small), beside = invert(large);
  int compared = 0;
  for_each_slot(beside.o.topology, [&](const Vec3i& v, std::size_t slot) {
    const Vec3d offset(beside.o.vectors.at(slot)), place = Vec3d(v - Vec3i(3)) + offset;
    bool is_near = true, is_between = true;
    for (int a = 0; a < 3; ++a) {
      is_near = is_near && place[a] > -0.499 && place[a] < last + 0.499;
      is_between = is_between && place[a] > -0.501 && place[a] < last + 0.501;
    }
    Vec3f found;
    const bool is_known = own.o.at(v - Vec3i(3), found);
    if (is_near) {
      ASSERT_TRUE(is_known) << v << place;
      ASSERT_LT((Vec3d(found) - offset).length(), 1e-3) << v;
      ++compared;
    } else if (!is_between) {
      ASSERT_FALSE(is_known) << v << place;
    }
  });
  EXPECT_GT(compared, last * last * last);
}

namespace {

/// kDims cut in two between x = 4 and 5, the halves moved apart and pulled together along y and z.
struct CutInTwo {
  BrickTopology elements = box_topology(Vec3i(0), kDims - Vec3i(1));
  LinkCuts cuts;
  double apart;  // each way
  double part;   // of the way to the middle
  Displacement displacement;
  OffsetField field;

  CutInTwo(double d, double p) : apart(d), part(p) {
    for (std::size_t b = 0; b < elements.brick_count(); ++b) {
      for_each_active(elements.mask(b), [&](int offset) {
        if (elements.origin(b).x + brick_local(offset).x == 4) cuts.cut(b, offset, 0);
      });
    }
    displacement = displacement_on(elements, [&](const Vec3i& v) {
      const Vec3d middle = Vec3d(kDims - Vec3i(1)) / 2;
      Vec3d u = (middle - Vec3d(v)) * part;
      u.x = v.x <= 4 ? -apart : apart;
      return Vec3f(u);
    });
    field = invert_cut(displacement, {elements, cuts});
  }

  /// The place that has come to x; false where none has, up to half a voxel beyond the border.
  bool rest_of(const Vec3d& x, Vec3d& rest, double slack) const {
    const Vec3d middle = Vec3d(kDims - Vec3i(1)) / 2;
    rest = middle + (x - middle) / (1 - part);
    const double left = x.x + apart, right = x.x - apart;
    rest.x = left < 4.5 ? left : right;
    bool is_there = left < 4.5 + slack || right > 4.5 - slack;
    for (int a = 0; a < 3; ++a) {
      is_there = is_there && rest[a] > -0.5 - slack && rest[a] < kDims[a] - 0.5 + slack;
    }
    return is_there;
  }
};

}  // namespace

TEST(UnitBorder, ALayerBesideAnOpenCutThatDrawsBackStays) {
  for (const double way : {1.0 / 65536, 0.001, 0.3, 0.499, 0.7}) {
    const CutInTwo body(0.2, way * 2 / (kDims.y - 1));
    ASSERT_NE(body.field.split, nullptr);
    int seen = 0;
    for_each_slot(body.elements, [&](const Vec3i& voxel, std::size_t) {
      Vec3d rest, other;
      const bool is_there = body.rest_of(Vec3d(voxel), rest, 1e-4);
      if (is_there != body.rest_of(Vec3d(voxel), other, -1e-4)) return;  // on a face
      EXPECT_EQ(seen_at(body.displacement, body.field, voxel), is_there ? 100.0f : 0.0f)
          << voxel << " after " << way;
      seen += is_there;
    });
    EXPECT_GT(seen, 8 * 10 * 12);
    EXPECT_EQ(count_hidden(body.displacement, body.elements, body.field, {}), 0) << way;
  }
}

TEST(PropertyBorder, BesideAnOpenCutSamplesEndHalfAVoxelBeyondIt) {
  std::mt19937 random(9);
  for (const double apart : {0.1, 0.75, 1.5}) {
    const CutInTwo body(apart, 0.03);
    int beyond = 0;
    for (int n = 0; n < 20000; ++n) {
      const Vec3d x = random_place(random, -3, 16);
      Vec3d rest, other, offset;
      const bool is_there = body.rest_of(x, rest, 1e-3);
      if (is_there != body.rest_of(x, other, -1e-3)) continue;
      if (body.field.split->bricks().find(floor_voxel(x)) < 0) continue;
      ASSERT_EQ(body.field.sample(x, offset), is_there) << x;
      if (!is_there) continue;
      ASSERT_LT((x + offset - rest).length(), 1e-4) << x;
      beyond += within_border(rest, kDims) != rest;
    }
    EXPECT_GT(beyond, 500);
  }
}

/// Points move there as the tissue does that is seen.
TEST(PropertyBorder, PointsBesideAnOpenCutGoWithTheirSideBeyondIt) {
  std::mt19937 random(11);
  const CutInTwo body(0.75, 0.03);
  const auto along = motion_along(body.displacement, {body.elements, body.cuts});
  const auto to_rest = motion_to_rest(body.displacement, {body.elements, body.cuts}, body.field);
  int beyond = 0;
  for (int n = 0; n < 5000; ++n) {
    const Vec3d x = random_place(random, -1.5, 14);
    Vec3d rest;
    if (!body.rest_of(x, rest, -1e-3)) continue;
    EXPECT_LT((to_rest->move(x).to_lps_mm - rest).length(), 1e-4) << x;
    EXPECT_LT((along->move(rest).to_lps_mm - x).length(), 1e-4) << rest;
    beyond += within_border(rest, kDims) != rest;
  }
  EXPECT_GT(beyond, 200);
}
