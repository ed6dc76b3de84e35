// Lips of an opened cut, against the surface that made it.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/lib/cut_fixtures.h"
#include "tests/support/sanitized.h"
#include "volumes/field/cuts/cut_offsets.h"
#include "volumes/grid/voxel_sets.h"

using namespace supple;
using namespace supple::test;

namespace {

constexpr int kSize = 30;

Vec3d middle() {
  return Vec3d(0.5 * (kSize - 1)) + Vec3d(0.13, -0.21, 0.32);
}

Block whole_block() {
  return homogeneous({kSize, kSize, kSize}, 2, 0.5, 1);
}

/// A block cut by a plane through its middle, in two or from `begin` along the plane.
struct CutBlock {
  Body body;
  Vec3d normal, along1, along2;

  explicit CutBlock(const Vec3d& direction, const Block& block = whole_block(),
                    double begin = -kSize)
      : body(body_of(block)), normal(direction.normalized()) {
    along1 = normal.cross(std::abs(normal.z) < 0.5 ? Vec3d(0, 0, 1) : Vec3d(0, 1, 0)).normalized();
    along2 = normal.cross(along1);
    const Geometry& geometry = body.geometry;
    const Vec3d corner = middle() + along1 * begin - along2 * kSize;
    cut(body, PlanePatch{geometry.world_from_index(corner),
                         geometry.world_vector_from_index(along1 * (kSize - begin)),
                         geometry.world_vector_from_index(along2 * (2.0 * kSize))});
  }
  bool is_upper(const Vec3d& X) const { return (X - middle()).dot(normal) > 0; }

  /// Both sides moved, each by a function of the place at rest; with the shell.
  template <class Move>
  OffsetField moved(Move&& u) const {
    Displacement field{body.geometry, {body.elements, {}}};
    field.u.vectors.resize(body.elements.brick_count());
    for_each_element(body.elements, [&](Slot slot) {
      const Vec3d X(voxel_of(body.elements, slot));
      field.u.vectors.set(slot, Vec3f(u(is_upper(X), X)));
    });
    const CutElements elements{body.elements, body.cuts};
    return invert_cut(extend_past_cuts(field, dilate(body.elements, 2), elements), elements);
  }
};

/// True up to one voxel beyond the last ones of the block: skin lies between tissue and air.
bool is_in_reach(const Vec3d& X) {
  for (int a = 0; a < 3; ++a) {
    if (X[a] < -1 || X[a] > kSize) return false;
  }
  return true;
}

/// The largest distance from the surface at which content ends, along lines across it.
template <class Move>
double worst_lip(const CutBlock& block, const OffsetField& field, Move&& u, int& lips) {
  constexpr double kStep = 0.02, kFar = 0.6;
  double worst = 0;
  for (double s = -kSize; s < kSize; s += 0.83) {
    for (double t = -kSize; t < kSize; t += 0.91) {
      const Vec3d foot = middle() + block.along1 * s + block.along2 * t;
      for (const bool upper : {false, true}) {
        const Vec3d inwards = block.normal * (upper ? 1 : -1);
        if (!is_in_reach(foot - inwards * kFar) || !is_in_reach(foot + inwards * kFar)) continue;
        // Material of this side at depths beyond and behind the surface.
        double end = kFar;
        for (double depth = kFar; depth > -kFar; depth -= kStep) {
          const Vec3d X = foot + inwards * depth;
          Vec3d o;
          if (!field.sample(X + u(upper, X), o)) break;
          end = depth;
        }
        worst = std::max(worst, std::abs(end));
        ++lips;
      }
    }
  }
  return worst;
}

}  // namespace

TEST(PropertyCutLips, OfAnObliqueCutLieWithinATenthOfAVoxelOfThePlane) {
  LEFT_OUT_WHEN_SANITIZED();
  const double angle = 30 * M_PI / 180;
  const Vec3d directions[] = {{std::cos(angle), std::sin(angle), 0},
                              {std::sin(angle), 0, std::cos(angle)},
                              {std::cos(angle), std::sin(angle) * 0.6, std::sin(angle) * 0.8},
                              {1, 1, 1},
                              {0, 1, 0}};
  for (const Vec3d& direction : directions) {
    const CutBlock block(direction);
    const auto apart = [&](bool upper, const Vec3d& X) {
      const Vec3d d = X - middle();
      const Vec3d turn(0.04 * d.y, -0.04 * d.x, 0.03 * d.x);
      return block.normal * (upper ? 1.7 : -2.3) + (upper ? turn : -turn);
    };
    const auto shifted = [&](bool upper, const Vec3d&) {
      return block.normal * (upper ? 2.5 : -0.5);
    };
    int lips = 0;
    EXPECT_LT(worst_lip(block, block.moved(shifted), shifted, lips), 0.05) << direction;
    EXPECT_LT(worst_lip(block, block.moved(apart), apart, lips), 0.1) << direction;
    EXPECT_GT(lips, 2000);
  }
}

TEST(PropertyCutLips, OfASphereLieWithinATenthOfAVoxel) {
  LEFT_OUT_WHEN_SANITIZED();
  Body body = body_of(whole_block());
  const double radius = 9.3;
  TriangleMesh sphere = unit_sphere(4);
  for (Vec3d& vertex : sphere.vertices_lps_mm) vertex = middle() + vertex * radius;
  cut(body, to_world(body.geometry, sphere));
  // What was inside goes far away and leaves a hole.
  Displacement field{body.geometry, {body.elements, {}}};
  field.u.vectors.resize(body.elements.brick_count());
  const Vec3f away(0, 0, 60);
  Slot first;
  ASSERT_TRUE(slot_of(body.elements, Vec3i(middle()), first));
  std::vector<Slot> open = {first};
  field.u.vectors.set(first, away);
  while (!open.empty()) {
    const Slot slot = open.back();
    open.pop_back();
    for (int face = 0; face < 6; ++face) {
      Slot next;
      if (!neighbour_slot(body.elements, body.cuts, slot, face / 2, face % 2 != 0, next) ||
          field.u.vectors.at(next) == away) {
        continue;
      }
      field.u.vectors.set(next, away);
      open.push_back(next);
    }
  }
  const OffsetField offsets = invert_cut(field, {body.elements, body.cuts});
  std::mt19937 random(3);
  for (int n = 0; n < 20000; ++n) {
    const Vec3d direction = pick_vector(random, -1, 1).normalized();
    Vec3d o;
    EXPECT_TRUE(offsets.sample(middle() + direction * (radius + 0.1), o)) << direction;
    EXPECT_FALSE(offsets.sample(middle() + direction * (radius - 0.1), o)) << direction;
    const Vec3d moved = middle() + Vec3d(away);
    EXPECT_TRUE(offsets.sample(moved + direction * (radius - 0.1), o)) << direction;
    EXPECT_FALSE(offsets.sample(moved + direction * (radius + 0.1), o)) << direction;
  }
}

/// A ball that is cut from its middle to one side, and held wide open up to the end of the cut.
TEST(PropertyCutLips, HaveFacesUpToTheEndOfTheCut) {
  Block ball = whole_block();
  const auto depth_in_ball = [](const Vec3d& X) {
    return 0.45 * kSize - (X - Vec3d(0.5 * (kSize - 1))).length();
  };
  for (std::size_t n = 0; n < ball.element.size(); ++n) {
    ball.element[n] = depth_in_ball(Vec3d(ball.voxel(int(n)))) > 0;
  }
  std::mt19937 random(7);
  for (const Vec3d& direction : {Vec3d(1, 0.3, 0.1), Vec3d(0.4, 1, 0.7), Vec3d(0.9, 0.2, -1)}) {
    const CutBlock block(direction, ball, 0);
    const auto along = [&](const Vec3d& X) { return (X - middle()).dot(block.along1); };
    const auto above = [&](const Vec3d& X) { return (X - middle()).dot(block.normal); };
    const OffsetField field = block.moved([&](bool upper, const Vec3d& X) {
      const double side = along(X) > 0 ? (upper ? 1 : -1) : std::clamp(above(X) / 2, -1.0, 1.0);
      const double wide = 0.8 * std::clamp((along(X) + 3) / 3, 0.0, 1.0);
      return block.normal * (side * (wide + 0.12 * std::max(along(X), 0.0)));
    });
    int faces = 0, beyond = 0, ends = 0, in_tissue = 0;
    for (int n = 0; n < cases(200000); ++n) {
      const Vec3d x = pick_vector(random, -2, kSize + 1);
      const std::int32_t b = field.split->bricks().find(floor_voxel(x));
      PointwiseOffsets::Sample found;
      if (b < 0 || !field.split->sample(std::size_t(b), x, found)) continue;
      const Vec3d X = x + found.offset;
      if (depth_in_ball(X) < -1) continue;
      Vec3d normal;
      double depth_mm = HUGE_VAL;
      const bool has_face = field.split->face(found.piece, x, X, normal, depth_mm);
      const double depth = std::abs(above(X));
      if (along(X) > 1.5 && depth < 1.5) {
        ASSERT_TRUE(has_face) << X;
        // Sides go by voxels at the rim, so that one reaches a quarter beyond the plane.
        EXPECT_NEAR(std::abs(depth_mm), depth, 0.1) << X;
        EXPECT_GT(depth_mm, -0.3) << X;
        ++faces;
      } else if (along(X) < -2) {
        EXPECT_FALSE(has_face) << X;
        ++beyond;
      } else if (along(X) < 0 && depth < 0.3) {
        if (!has_face) continue;
        ++ends;
        const Vec3d before = x - normal * (depth_mm / normal.length2() + 0.1 / normal.length());
        const std::int32_t near = field.split->bricks().find(floor_voxel(before));
        in_tissue +=
            along(X) < -0.5 && near >= 0 && field.split->sample(std::size_t(near), before, found);
      }
    }
    std::cout << faces << " faces, " << beyond << " beyond, " << ends << " at the end, "
              << in_tissue << " in tissue\n";
    EXPECT_GT(faces, cases(1000));
    EXPECT_GT(beyond, cases(1000));
    EXPECT_TRUE(kSanitized || ends > 30) << ends;
    EXPECT_LE(in_tissue, 6);  // sides that are apart at all have a face there
  }
}
