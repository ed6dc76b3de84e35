#include <limits>

#include <gtest/gtest.h>

#include "tests/support/sanitized.h"
#include "tests/volumes/field/offset_fixtures.h"
#include "volumes/base/error.h"
#include "volumes/base/parallel.h"
#include "volumes/field/inversion/deformed_cell.h"
#include "volumes/field/inversion/invert.h"
#include "volumes/field/offset_field.h"
#include "volumes/field/procedural.h"
#include "volumes/grid/cell.h"
#include "volumes/grid/voxel_sets.h"

using namespace supple;
using namespace supple::test;

namespace {

double det(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  return a.dot(b.cross(c));
}

/// Barycentric coordinates by Cramer's rule, borders left out.
bool strictly_inside(const Vec3d (&t)[4], const Vec3d& x) {
  const Vec3d a = t[1] - t[0], b = t[2] - t[0], c = t[3] - t[0], p = x - t[0];
  const double volume = det(a, b, c);
  const double l1 = det(p, b, c) / volume, l2 = det(a, p, c) / volume, l3 = det(a, b, p) / volume;
  return std::min({l1, l2, l3, 1 - l1 - l2 - l3}) > 1e-9;
}

/// Pose corners of a cell, index 4 x + 2 y + z; false when one is invalid.
bool deformed_corners(const VectorBricks& u, const Vec3i& cell, Vec3d (&corners)[8]) {
  for (int n = 0; n < 8; ++n) {
    const Vec3i v = cell + cell_corner(n);
    Vec3f vector;
    if (!u.at(v, vector)) return false;
    corners[n] = Vec3d(v) + Vec3d(vector);
  }
  return true;
}

bool has_all_neighbours(const VectorBricks& u, const Vec3i& cell) {
  for (int n = 0; n < 64; ++n) {
    if (!u.topology.is_active(cell + Vec3i(n / 16 - 1, n / 4 % 4 - 1, n % 4 - 1))) return false;
  }
  return true;
}

/// Lattice points inside the six tetrahedra of the deformed inner cells that `o` does not hold.
std::vector<Vec3i> missed_places(const VectorBricks& u, const VectorBricks& o,
                                 std::int64_t& covered) {
  constexpr int kTetrahedra[6][4] = {{0, 4, 6, 7}, {0, 4, 5, 7}, {0, 2, 6, 7},
                                     {0, 2, 3, 7}, {0, 1, 5, 7}, {0, 1, 3, 7}};
  std::vector<Vec3i> missed;
  for_each_slot(u.topology, [&](const Vec3i& cell, std::size_t) {
    Vec3d corners[8];
    if (!has_all_neighbours(u, cell) || !deformed_corners(u, cell, corners)) return;
    for (const auto& vertices : kTetrahedra) {
      Vec3d t[4], lo(1e30), hi(-1e30);
      for (int n = 0; n < 4; ++n) {
        t[n] = corners[vertices[n]];
        for (int a = 0; a < 3; ++a) {
          lo[a] = std::min(lo[a], t[n][a]);
          hi[a] = std::max(hi[a], t[n][a]);
        }
      }
      for (int x = int(std::ceil(lo.x)); x <= hi.x; ++x) {
        for (int y = int(std::ceil(lo.y)); y <= hi.y; ++y) {
          for (int z = int(std::ceil(lo.z)); z <= hi.z; ++z) {
            if (!strictly_inside(t, Vec3d(x, y, z))) continue;
            ++covered;
            if (!o.topology.is_active({x, y, z})) missed.push_back({x, y, z});
          }
        }
      }
    }
  });
  return missed;
}

std::size_t missed_voxels(const VectorBricks& u, const VectorBricks& o, std::int64_t& covered) {
  return missed_places(u, o, covered).size();
}

BrickTopology ball(const Vec3d& center, double radius) {
  const Vec3i lo = Vec3i(center - Vec3d(radius)) - Vec3i(1),
              hi = Vec3i(center + Vec3d(radius)) + Vec3i(1);
  return topology_where(lo, hi,
                        [=](const Vec3i& v) { return (Vec3d(v) - center).length() <= radius; });
}

}  // namespace

TEST(PropertyInvert, AZeroDisplacementGivesExactZerosOnItsOwnVoxels) {
  const Displacement still = displacement_on(box_topology({-5, 3, 2}, {20, 30, 19}),
                                             [](const Vec3i&) { return Vec3f(-0.0f); });
  const OffsetField field = invert(still);
  EXPECT_TRUE(field.o.topology == still.u.topology);
  for (const Vec3f& o : field.o.vectors.all()) {
    ASSERT_EQ(o, Vec3f(0));
    ASSERT_FALSE(std::signbit(o.x) || std::signbit(o.y) || std::signbit(o.z));
  }
  EXPECT_EQ(field.certificate.residual_max, 0);
  EXPECT_EQ(field.certificate.residual_p999, 0);
  EXPECT_EQ(field.certificate.cells, 25 * 27 * 17);
  EXPECT_EQ(field.certificate.min_det, 1);
}

TEST(PropertyInvert, RegionsThatDidNotMoveStayExactlyZeroBesideOnesThatDid) {
  const AnalyticWarp bump = bump_warp({20, 20, 20}, 7, 3);
  const Displacement displacement =
      sample_displacement(bump, unit_geometry({48, 41, 41}), box_topology({0, 0, 0}, {47, 40, 40}));
  const OffsetField field = invert(displacement);
  for_each_slot(field.o.topology, [&](const Vec3i& v, std::size_t slot) {
    if (std::abs(v.x - 20) >= 7 || std::abs(v.z - 20) >= 7) {
      ASSERT_EQ(field.o.vectors.at(slot), Vec3f(0));
    }
  });
}

TEST(PropertyInvert, ATranslationIsInvertedExactly) {
  for (const Vec3f& shift : {Vec3f(3, -17, 8), Vec3f(0.25f, -0.7f, 100.3f), Vec3f(0, 0, 1e-6f)}) {
    const BrickTopology where = box_topology({0, 0, 0}, {12, 9, 17});
    const OffsetField field = invert(displacement_on(where, [&](const Vec3i&) { return shift; }));
    for_each_slot(box_topology({-30, -30, -30}, {130, 30, 130}), [&](const Vec3i& x, std::size_t) {
      const Vec3d source = Vec3d(x) - Vec3d(shift);
      const bool covered = source.x >= -0.5 && source.x <= 12.5 && source.y >= -0.5 &&
                           source.y <= 9.5 && source.z >= -0.5 && source.z <= 17.5;
      Vec3f o;
      ASSERT_EQ(field.o.at(x, o), covered) << x;
      if (covered) {
        ASSERT_EQ(o, -shift);
      }
    });
    EXPECT_EQ(field.certificate.residual_max, 0);
  }
}

TEST(PropertyInvert, LinearWarpsGiveTheirAnalyticOffsets) {
  const Vec3d center(15, 15, 15);
  for (const AnalyticWarp& warp : {shear_warp(center, 0.8), shear_warp(center, -2.5),
                                   stretch_warp(center, 1.7), stretch_warp(center, 0.3)}) {
    const Displacement displacement = sample_displacement(warp, unit_geometry({31, 31, 31}),
                                                          box_topology({0, 0, 0}, {30, 30, 30}));
    const OffsetField field = invert(displacement);
    ASSERT_GT(field.o.topology.active_count(), 5000);
    for_each_slot(field.o.topology, [&](const Vec3i& x, std::size_t slot) {
      ASSERT_LT((Vec3d(field.o.vectors.at(slot)) - warp.offset_voxels(Vec3d(x))).length(), 2e-5);
    });
    EXPECT_LE(field.certificate.residual_max, 1e-4);
    EXPECT_EQ(field.certificate.unresolved_voxels, 0);
    EXPECT_EQ(field.certificate.folded_cells, 0);
  }
}

TEST(PropertyInvert, NoisyFieldsWithoutFoldsAreResolvedWhereverADeformedCellLies) {
  std::mt19937 random(21);
  for (const float size : {0.01f, 0.08f, 0.16f}) {
    for (int n = 0; n < 3; ++n) {
      const Vec3f shift = n == 0 ? Vec3f(0) : random_vector(random, 300);
      const Displacement noisy = noisy_displacement(random, ball({14, 14, 14}, 11.5), size, shift);
      const OffsetField field = invert(noisy);
      std::int64_t covered = 0;
      EXPECT_EQ(missed_voxels(noisy.u, field.o, covered), 0) << size;
      EXPECT_GT(covered, 2000);
      EXPECT_EQ(field.certificate.folded_cells, 0);
      EXPECT_GT(field.certificate.min_det, 0);
      EXPECT_EQ(field.certificate.unresolved_voxels, 0);
      EXPECT_LE(max_residual(noisy.u, field.o), 1e-4) << size;
      EXPECT_NEAR(field.certificate.residual_max, max_residual(noisy.u, field.o), 1e-6);
    }
  }
}

TEST(PropertyInvert, NodesInTheLatticePlanesOfTheBorderAreCovered) {
  // Faces across j and k stay in lattice planes, where neighbours share their nodes; those of the
  // last cells have no neighbour.
  const Displacement sheared = displacement_on(
      box_topology({0, 0, 0}, {20, 13, 12}),
      [](const Vec3i& v) { return Vec3f(0.25f * float(v.y) + 0.125f * float(v.z % 2), 0, 0); });
  const OffsetField field = invert(sheared);
  for_each_slot(box_topology({6, 0, 0}, {20, 13, 12}), [&](const Vec3i& x, std::size_t) {
    Vec3f o;
    ASSERT_TRUE(field.o.at(x, o)) << x;
    EXPECT_NEAR(o.x, -0.25 * x.y - 0.125 * (x.z % 2), 1e-5);
  });
}

TEST(PropertyInvert, SinglePrecisionLanesAgreeWithTheDoublePrecisionSolver) {
  // A finer tolerance than floats can promise sends every cell to the solver in double.
  InvertParams fine;
  fine.residual_tolerance_voxels = 1e-5;
  std::mt19937 random(27);
  for (const float size : {0.05f, 0.16f, 0.5f}) {
    const Displacement noisy =
        noisy_displacement(random, ball({14, 14, 14}, 11.5), size, random_vector(random, 40));
    const OffsetField lanes = invert(noisy), scalar = invert(noisy, fine);
    ASSERT_TRUE(lanes.o.topology == scalar.o.topology);
    EXPECT_NEAR(lanes.certificate.min_det, scalar.certificate.min_det, 1e-5);
    EXPECT_EQ(lanes.certificate.folded_cells, scalar.certificate.folded_cells);
    EXPECT_EQ(lanes.certificate.unresolved, scalar.certificate.unresolved);
    double worst = 0;
    for (std::size_t n = 0; n < lanes.o.vectors.brick_count() * kBrickVoxels; ++n) {
      worst = std::max(worst, double((lanes.o.vectors.at(n) - scalar.o.vectors.at(n)).length()));
    }
    EXPECT_LT(worst, size < 0.2f ? 2e-5 : 1e-3);
  }
}

TEST(PropertyInvert, StronglyStretchedNoiseLeavesNoGaps) {
  // Cells five voxels long: many nodes per cell, bent faces.
  std::mt19937 random(22);
  const Displacement displacement =
      displacement_on(box_topology({0, 0, 0}, {10, 10, 10}), [&](const Vec3i& v) {
        const Vec3f p(v);
        return Vec3f(4 * p.x, 2 * p.y + 1.5f * p.x, -0.4f * p.z) + random_vector(random, 0.1f);
      });
  const OffsetField field = invert(displacement);
  std::int64_t covered = 0;
  EXPECT_EQ(missed_voxels(displacement.u, field.o, covered), 0);
  EXPECT_GT(covered, 3000);
  EXPECT_EQ(field.certificate.unresolved_voxels, 0);
  EXPECT_LE(max_residual(displacement.u, field.o), 1e-4);
}

TEST(PropertyInvert, DoesNotDependOnTheNumberOfThreads) {
  std::mt19937 random(23);
  // Folds included, where several solutions compete.
  const Displacement noisy =
      noisy_displacement(random, ball({30, 30, 30}, kSanitized ? 12 : 24), 0.7f);
  const auto with_threads = [&](int threads) {
    return on_threads(threads, [&] { return invert(noisy); });
  };
  const OffsetField one = with_threads(1);
  EXPECT_GT(one.certificate.folded_cells, 0);
  expect_equal(one, with_threads(2));
  expect_equal(one, with_threads(5));
}

TEST(PropertyInvert, WantedBricksHoldWhatTheyWouldAmongAllAndOthersInReachNothing) {
  std::mt19937 random(31);
  const BrickTopology body = ball({44, 44, 44}, 28);
  // One half of the ball moves, the other one is at rest.
  Displacement moved = {unit_geometry({80, 80, 80}), {body, BrickVectors(body.brick_count())}};
  for_each_slot(body, [&](const Vec3i& v, std::size_t slot) {
    if (v.x <= 44) return;
    const float way = std::min(6.0F, 0.3F * float(v.x - 44));
    moved.u.vectors.set(slot, Vec3f(0, way, 0) + random_vector(random, 0.3F));
  });
  InvertParams params;
  params.wants = [](const Vec3i& origin) { return origin.y < 40; };
  const OffsetField all = invert(moved), some = invert(moved, params);
  int wanted = 0, left_out = 0, at_rest = 0;
  for (std::size_t b = 0; b < all.o.topology.brick_count(); ++b) {
    const Vec3i& origin = all.o.topology.origin(b);
    const std::int32_t same = some.o.topology.find(origin);
    const bool rests = origin.x < 24;
    if (origin.x == 24 && !params.wants(origin)) continue;  // where bounds of reach may end
    if (!rests && !params.wants(origin)) {
      EXPECT_LT(same, 0);
      ++left_out;
      continue;
    }
    (rests ? at_rest : wanted) += 1;
    ASSERT_GE(same, 0);
    EXPECT_EQ(some.o.topology.mask(std::size_t(same)), all.o.topology.mask(b));
    const Vec3f* const a = all.o.vectors.brick_or_zero(b);
    EXPECT_TRUE(std::equal(a, a + kBrickVoxels, some.o.vectors.brick_or_zero(std::size_t(same))));
  }
  EXPECT_GT(wanted, 10);
  EXPECT_GT(left_out, 10);
  EXPECT_GT(at_rest, 5);
  EXPECT_LT(some.certificate.folded_cells, all.certificate.folded_cells);
  EXPECT_EQ(some.certificate.unresolved_voxels, 0);
  EXPECT_LE(some.certificate.residual_max, 1e-4);
}

TEST(PropertyInvert, AFoldIsCountedAndTheSmallestOffsetWins) {
  // x(X) = X + u runs to 24, back to 12 and on: three sources for the nodes between.
  const auto moved = [](int x) {
    return x <= 16   ? 1.5f * float(x)
           : x <= 22 ? 24 - 2.0f * float(x - 16)
                     : 12 + 1.5f * float(x - 22);
  };
  const Displacement displacement =
      displacement_on(box_topology({0, 0, 0}, {40, 6, 6}),
                      [&](const Vec3i& v) { return Vec3f(moved(v.x) - float(v.x), 0, 0); });
  const OffsetField field = invert(displacement);
  EXPECT_EQ(field.certificate.folded_cells, 6 * 6 * 6);
  EXPECT_EQ(field.certificate.min_det, -2);
  EXPECT_LE(field.certificate.residual_max, 1e-4);
  EXPECT_EQ(field.certificate.unresolved_voxels, 0);
  for (int x = 0; x <= 36; ++x) {
    double smallest = 1e30;
    for (const double source : {x / 1.5, 16 + (24 - x) / 2.0, 22 + (x - 12) / 1.5}) {
      const bool first = source <= 16 && source == x / 1.5;
      const bool back = source >= 16 && source <= 22 && source == 16 + (24 - x) / 2.0;
      const bool last = source >= 22 && source == 22 + (x - 12) / 1.5;
      if (first || back || last) smallest = std::min(smallest, std::abs(source - x));
    }
    Vec3f o;
    ASSERT_TRUE(field.o.at({x, 3, 3}, o)) << x;
    EXPECT_NEAR(std::abs(o.x), smallest, 1e-5) << x;
  }
}

TEST(PropertyInvert, FoldsBetweenTheCornersOfACellAreFound) {
  std::mt19937 random(12);
  int between = 0, regular = 0;
  for (int n = 0; n < cases(4000); ++n) {
    CellCorners corners;
    const float size = 0.25f + 0.35f * float(n % 10) / 9;
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3d p = Vec3d(cell_corner(corner)) + Vec3d(random_vector(random, size));
      for (int a = 0; a < 3; ++a) corners.p[a][corner] = p[a];
    }
    // det F on a dense lattice.
    constexpr int kSteps = 8, kRow = kSteps + 1;
    double smallest = 1e30;
    for (int k = 0; k < kRow * kRow * kRow; ++k) {
      const Vec3d t = Vec3d(Vec3i(k / (kRow * kRow), k / kRow % kRow, k % kRow)) / kSteps;
      Vec3d columns[3] = {Vec3d(0), Vec3d(0), Vec3d(0)};
      for (int corner = 0; corner < 8; ++corner) {
        const Vec3i step = cell_corner(corner);
        for (int axis = 0; axis < 3; ++axis) {
          double slope = step[axis] ? 1 : -1;
          for (int a = 0; a < 3; ++a) {
            if (a != axis) slope *= step[a] ? t[a] : 1 - t[a];
          }
          columns[axis] += corners.corner(corner) * slope;
        }
      }
      smallest = std::min(smallest, det(columns[0], columns[1], columns[2]));
    }
    const bool folded = is_folded(corners);
    if (smallest <= 0) {
      EXPECT_TRUE(folded) << smallest;
      between += min_corner_det(corners) > 0;
    } else if (smallest > 0.02) {
      EXPECT_FALSE(folded) << smallest;
      ++regular;
    }
  }
  EXPECT_GE(between, cases(5));
  EXPECT_GT(regular, cases(500));
}

TEST(PropertyInvert, AFoldBetweenCornersIsCountedWhoeverSolvesTheCell) {
  std::mt19937 random(29);
  const BrickTopology where = box_topology(Vec3i(0), Vec3i(20));
  const Displacement noisy = noisy_displacement(random, where, 0.45f);
  std::int64_t folded = 0, at_corners = 0;
  for_each_slot(where, [&](const Vec3i& cell, std::size_t) {
    CellCorners corners;
    for (int n = 0; n < 8; ++n) {
      Vec3f moved;
      if (!noisy.u.at(cell + cell_corner(n), moved)) return;
      for (int a = 0; a < 3; ++a) corners.p[a][n] = cell_corner(n)[a] + double(moved[a]);
    }
    folded += is_folded(corners);
    at_corners += min_corner_det(corners) <= 0;
  });
  EXPECT_GT(folded, at_corners);
  InvertParams exact;  // too close for single precision: no lanes
  exact.residual_tolerance_voxels = 4e-5;
  EXPECT_EQ(invert(noisy).certificate.folded_cells, folded);
  EXPECT_EQ(invert(noisy, exact).certificate.folded_cells, folded);
}

TEST(PropertyInvert, FoldedNoiseIsReportedAndEveryOffsetStillSolvesTheEquation) {
  std::mt19937 random(24);
  const Displacement wild = noisy_displacement(random, ball({14, 14, 14}, 11.5), 0.9f);
  const OffsetField field = invert(wild);
  EXPECT_GT(field.certificate.folded_cells, 0);
  EXPECT_LT(field.certificate.min_det, 0);
  EXPECT_LE(max_residual(wild.u, field.o), 1e-3);
  EXPECT_EQ(std::size_t(field.certificate.unresolved_voxels), field.certificate.unresolved.size());
}

TEST(PropertyInvert, CoveredNodesWithoutASolutionAreListedAndCounted) {
  InvertParams unreachable;
  unreachable.residual_tolerance_voxels = 1e-300;
  for (const bool many : {false, true}) {
    std::mt19937 random(25);
    const Displacement noisy =
        noisy_displacement(random, ball({20, 20, 20}, many ? 17 : 6.5), 0.16f);
    const OffsetField field = invert(noisy, unreachable);
    const InversionCertificate& found = field.certificate;
    std::int64_t covered = 0;
    std::vector<Vec3i> missed = missed_places(noisy.u, field.o, covered);
    sort_unique(missed);
    EXPECT_GE(missed.size(), many ? 1001u : 10u);
    EXPECT_GE(std::size_t(found.unresolved_voxels), missed.size());
    EXPECT_EQ(found.unresolved.size(), many ? 1000u : std::size_t(found.unresolved_voxels));
    for (const Vec3i& place : found.unresolved) EXPECT_FALSE(field.o.topology.is_active(place));
    if (many) continue;
    std::vector<Vec3i> listed;
    std::set_intersection(missed.begin(), missed.end(), found.unresolved.begin(),
                          found.unresolved.end(), std::back_inserter(listed), voxel_less);
    // A few lie in the tetrahedra of the cell beside the one whose image holds them.
    EXPECT_GE(10 * listed.size(), 9 * missed.size());
  }
}

TEST(PropertyInvert, AOneSliceBodyIsInvertedInItsPlane) {
  const auto u = [](const Vec3i& v) { return Vec3f(0.3f * float(v.y), 0.1f * float(v.x), 0); };
  Displacement flat{unit_geometry({20, 16, 1}), field_on(box_topology({0, 0, 0}, {19, 15, 0}), u)};
  const OffsetField field = invert(flat);
  EXPECT_GT(field.o.topology.active_count(), 200);
  EXPECT_EQ(field.o.topology.active_bounds().lo.z, 0);
  EXPECT_EQ(field.o.topology.active_bounds().hi.z, 0);
  EXPECT_LE(max_residual(flat.u, field.o), 1e-4);
  Vec3f o;
  ASSERT_TRUE(field.o.at({6, 7, 0}, o));
  const double x = (6 - 0.3 * 7) / (1 - 0.03), y = (7 - 0.1 * 6) / (1 - 0.03);
  EXPECT_NEAR(o.x, x - 6, 1e-5);
  EXPECT_NEAR(o.y, y - 7, 1e-5);
}

TEST(UnitInvert, ValuesWithoutAPlaceOnTheLatticeAreRefused) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  for (const Vec3f& bad : {Vec3f(nan, 0, 0), Vec3f(0, infinity, 0), Vec3f(0, 0, 2e6f)}) {
    EXPECT_THROW(invert(displacement_on(box_topology({0, 0, 0}, {4, 4, 4}),
                                        [&](const Vec3i& v) { return v.x == 2 ? bad : Vec3f(0); })),
                 InputError);
  }
  // One torn voxel: its cells span the box to it.
  EXPECT_THROW(invert(displacement_on(
                   box_topology({0, 0, 0}, {4, 4, 4}),
                   [&](const Vec3i& v) { return v == Vec3i(2) ? Vec3f(9e5f) : Vec3f(0); })),
               InputError);
}

TEST(UnitInvert, CancellingStopsIt) {
  struct Stop : Progress {
    void stage(std::string_view) override {}
    void update(double) override {}
    bool cancelled() const override { return true; }
  } stop;
  EXPECT_THROW(invert(displacement_on(box_topology({0, 0, 0}, {4, 4, 4}),
                                      [](const Vec3i&) { return Vec3f(0); }),
                      {}, &stop),
               Cancelled);
}

TEST(PropertyExtrapolate, ZeroOffsetsStayZeroAndTheBorderCanBeSampled) {
  const VectorBricks zeros = field_on(ball({9, 9, 9}, 6), [](const Vec3i&) { return Vec3f(0); });
  const VectorBricks wider = extrapolate_into_bricks(zeros, 2);
  EXPECT_TRUE(wider.topology == dilate(zeros.topology, 2));
  for (const Vec3f& o : wider.vectors.all()) ASSERT_EQ(o, Vec3f(0));
  for_each_slot(zeros.topology, [&](const Vec3i& v, std::size_t) {
    Vec3d o;
    EXPECT_TRUE(wider.sample(Vec3d(v) + Vec3d(0.7, -0.6, 0.5), o));
  });
}
