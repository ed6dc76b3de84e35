// Pictures of bodies whose cuts have opened (volumes/field/cuts/cut_offsets.h).
#include <gtest/gtest.h>

#include "raycast/pictures/compare.h"
#include "tests/raycast/scenes.h"
#include "volumes/field/cuts/cut_offsets.h"

namespace supple {
namespace {

constexpr int kCutSize = 40;

/// A slab, 17 nodes thick along y, cut at x = 19.5 from one end to the other.
struct CutSlab {
  Geometry geometry = cube_geometry(kCutSize);
  BrickTopology elements = voxels_of({kCutSize, kCutSize, kCutSize}, [](const Vec3i& v) {
    return v.y >= 12 && v.y <= 28 && v.x >= 4 && v.x < 36;
  });
  DensityGrid density = grid_of(elements, [](const Vec3d&) { return 100; });
  LinkCuts cuts;

  CutSlab() {
    for (std::size_t b = 0; b < elements.brick_count(); ++b) {
      for_each_active(elements.mask(b), [&](int offset) {
        if ((elements.origin(b) + brick_local(offset)).x == 19) cuts.cut(b, offset, 0);
      });
    }
  }
  template <class Move>
  OffsetField moved(Move&& u, const LinkCuts& by) const {
    VectorBricks field{elements, BrickVectors(elements.brick_count())};
    for (std::size_t b = 0; b < elements.brick_count(); ++b) {
      for_each_active(elements.mask(b), [&](int offset) {
        field.vectors.touch(b)[offset] = Vec3f(u(Vec3d(elements.origin(b) + brick_local(offset))));
      });
    }
    return invert_cut({geometry, std::move(field)}, {elements, by});
  }
  Image picture(const OffsetField& field, const TransferFunction& function,
                const std::string& view = "anterior", const std::vector<Clip>& clips = {}) const {
    Renderer renderer(geometry, density);
    renderer.set_offsets(&field);
    RenderSettings settings = small_picture(80);
    settings.early_termination = 1;
    settings.clips = clips;
    return renderer.render(default_camera(geometry, 1, view, Projection::orthographic), function,
                           settings);
  }
};

Vec3d pulled_apart(const Vec3d& X) {
  return {X.x < 19.5 ? -3.3 : 3.3, 0, 0};
}

}  // namespace

TEST(PropertyCutPictures, AnOpenedSlabIsEmptyInTheGapAndWholeBesideIt) {
  const CutSlab slab;
  const OffsetField field = slab.moved(pulled_apart, slab.cuts);
  ASSERT_NE(field.split, nullptr);
  const Image image = slab.picture(field, fog_function(0.1));
  const double mm_per_pixel =
      default_camera(slab.geometry, 1, "anterior", Projection::orthographic).height_mm / 80;
  const int whole = int(std::lround(255 * (1 - std::pow(0.9, 16))));
  int in_gap = 0, beside = 0;
  for (int x = 0; x < 80; ++x) {
    const double from_gap = std::abs((x + 0.5 - 40) * mm_per_pixel) - 3.3;
    const int alpha = image.rgba[4 * (40 * 80 + std::size_t(x)) + 3];
    if (from_gap < 0) {
      EXPECT_EQ(alpha, 0) << x;
      ++in_gap;
    } else if (from_gap < 11) {
      EXPECT_NEAR(alpha, whole, 1) << x;
      ++beside;
    }
  }
  EXPECT_GT(in_gap, 8);
  EXPECT_GT(beside, 20);
}

TEST(PropertyCutPictures, AnOpenedFaceIsLitAsTheFaceOfAClip) {
  // The right half moves out of the way; seen from the left, the face of the other one is what a
  // clip of the whole slab shows there.
  const CutSlab slab;
  const OffsetField field =
      slab.moved([](const Vec3d& X) { return X.x < 19.5 ? Vec3d(0) : Vec3d(0, 0, 60); }, slab.cuts);
  ASSERT_NE(field.split, nullptr);
  TransferFunction opaque = fog_function(0.999);
  const Clip clip{{{{0, 0, 0}, {-1, 0, 0}}}, ClipKeep::inside, ClipSpace::source};
  const Image opened = slab.picture(field, opaque, "left");
  const Image clipped =
      slab.picture(slab.moved([](const Vec3d&) { return Vec3d(0); }, {}), opaque, "left", {clip});
  int compared = 0;
  for (std::size_t n = 0; n < opened.rgba.size() / 4; ++n) {
    if (clipped.rgba[4 * n + 3] < 250) continue;
    EXPECT_NEAR(opened.rgba[4 * n], clipped.rgba[4 * n], 3) << n % 80 << " " << n / 80;
    ++compared;
  }
  EXPECT_GT(compared, 800);
}

TEST(PropertyCutPictures, ACutThatStaysClosedCannotBeSeen) {
  const CutSlab slab;
  const auto bend = [](const Vec3d& X) {
    return Vec3d(2 * std::sin(0.15 * X.y), 1.5 * std::sin(0.2 * X.x), 0);
  };
  const LinkCuts none;
  const Image uncut = slab.picture(slab.moved(bend, none), fog_function(0.1));
  EXPECT_EQ(slab.picture(slab.moved(bend, slab.cuts), fog_function(0.1)).rgba, uncut.rgba);
  // Apart by a twentieth of a voxel more than counts as closed.
  const auto ajar = [&](const Vec3d& X) { return bend(X) + Vec3d(X.x < 19.5 ? 0 : -0.11, 0, 0); };
  const OffsetField field = slab.moved(ajar, slab.cuts);
  ASSERT_NE(field.split, nullptr);
  EXPECT_GT(compare(slab.picture(field, fog_function(0.1)), uncut, false).ssim, 0.99);
}

}  // namespace supple
