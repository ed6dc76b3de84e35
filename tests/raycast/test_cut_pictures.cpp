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
    VectorBricks field{elements, std::vector<Vec3f>(elements.brick_count() * kBrickVoxels)};
    for (std::size_t b = 0; b < elements.brick_count(); ++b) {
      for_each_active(elements.mask(b), [&](int offset) {
        field.vectors[b * kBrickVoxels + std::size_t(offset)] =
            Vec3f(u(Vec3d(elements.origin(b) + brick_local(offset))));
      });
    }
    return invert_cut({geometry, std::move(field)}, {elements, by});
  }
  Image picture(const OffsetField& field, const TransferFunction& function,
                const std::string& view = "anterior", const std::vector<Clip>& clips = {}) const {
    RenderSettings settings = small_picture(80);
    settings.early_termination = 1;
    settings.clips = clips;
    return picture(field, function, settings,
                   default_camera(geometry, 1, view, Projection::orthographic));
  }
  Image picture(const OffsetField& field, const TransferFunction& function,
                const RenderSettings& settings, const Camera& camera) const {
    Renderer renderer(geometry, density);
    renderer.set_offsets(&field);
    return renderer.render(camera, function, settings);
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

TEST(PropertyCutPictures, SkinBesideALipIsLitAsSkinUpToTheLip) {
  // Oblique rays cross the plane of the right lip in the air before they meet the skin beside it.
  const CutSlab slab;
  const OffsetField field = slab.moved(pulled_apart, slab.cuts);
  ASSERT_NE(field.split, nullptr);
  const Vec3d lip = slab.geometry.world_from_index({22.8, 12, 20});
  const Vec3d along = slab.geometry.world_vector_from_index({0.6, 0.8, 0}).normalized();
  Camera camera;
  camera.projection = Projection::orthographic;
  camera.position_lps_mm = lip - along * 100.0;
  camera.target_lps_mm = lip;
  camera.height_mm = 12;
  RenderSettings settings = small_picture(160, 0.1);
  const Image image = slab.picture(field, fog_function(0.9999), settings, camera);
  // From where the row meets the skin at a right angle to the lip, on both sides of the lip.
  const CameraFrame frame = camera_frame(camera);
  const Vec3d skin = slab.geometry.world_vector_from_index({1, 0, 0});
  const double pixels_per_voxel = skin.dot(frame.right) * 160 / camera.height_mm;
  const auto brightness = [&](double voxels_beside) {
    const std::size_t x = std::size_t(80 + voxels_beside * pixels_per_voxel);
    return int(image.rgba[4 * (80 * 160 + x)]);
  };
  const int far = brightness(5);
  EXPECT_GT(far, 20);
  EXPECT_GT(std::abs(brightness(-1.5) - far), 10);  // the face itself, which the light does not see
  for (double beside = 0.15; beside < 3; beside += 0.1) {
    EXPECT_NEAR(brightness(beside), far, 2) << beside;
  }
}

TEST(PropertyCutPictures, LipsOfAnObliqueCutLieWithinATenthOfAVoxelOfThePlane) {
  // The cut leans by 30 degrees to the lattice and holds the direction of sight.
  CutSlab slab;
  const Vec3d normal(std::cos(M_PI / 6), 0, std::sin(M_PI / 6)), middle(19.62, 20, 19.29);
  slab.cuts = {};
  const auto height = [&](const Vec3i& v) { return (Vec3d(v) - middle).dot(normal); };
  for (std::size_t b = 0; b < slab.elements.brick_count(); ++b) {
    for_each_active(slab.elements.mask(b), [&](int offset) {
      const Vec3i low = slab.elements.origin(b) + brick_local(offset);
      for (int axis = 0; axis < 3; ++axis) {
        Vec3i high = low;
        ++high[axis];
        const double from = height(low), to = height(high);
        if (!slab.elements.is_active(high) || (from < 0) == (to < 0)) continue;
        slab.cuts.cut(b, offset, axis, LinkCuts::place_of(from / (from - to)));
      }
    });
  }
  constexpr double kApart = 2.4;
  const OffsetField field = slab.moved(
      [&](const Vec3d& X) { return normal * ((X - middle).dot(normal) < 0 ? -kApart : kApart); },
      slab.cuts);
  ASSERT_NE(field.split, nullptr);
  Camera camera;
  camera.projection = Projection::orthographic;
  camera.target_lps_mm = slab.geometry.world_from_index(middle);
  camera.position_lps_mm =
      camera.target_lps_mm - slab.geometry.world_vector_from_index({0, 1, 0}) * 100.0;
  camera.height_mm = 20;
  constexpr int kPixels = 300;
  const Image image = slab.picture(field, fog_function(0.1), small_picture(kPixels), camera);
  const CameraFrame frame = camera_frame(camera);
  const int whole = int(std::lround(255 * (1 - std::pow(0.9, 16))));
  int in_gap = 0, beside = 0;
  for (int y = 0; y < kPixels; ++y) {
    for (int x = 0; x < kPixels; ++x) {
      const double mm = camera.height_mm / kPixels;
      const Vec3d place = slab.geometry.index_from_world(
          camera.target_lps_mm + frame.right * ((x + 0.5 - kPixels / 2) * mm) +
          frame.up * ((kPixels / 2 - y - 0.5) * mm));
      const double from_lip = std::abs((place - middle).dot(normal)) - kApart;
      const int alpha = image.rgba[4 * (std::size_t(y) * kPixels + std::size_t(x)) + 3];
      if (from_lip < -0.1) {
        ASSERT_EQ(alpha, 0) << place;
        ++in_gap;
      } else if (from_lip > 0.1) {
        ASSERT_NEAR(alpha, whole, 1) << place;
        ++beside;
      }
    }
  }
  EXPECT_GT(in_gap, kPixels * kPixels / 6);
  EXPECT_GT(beside, kPixels * kPixels / 2);
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
