// Pictures of bodies whose cuts have opened (volumes/field/cuts/cut_offsets.h).
#include <gtest/gtest.h>

#include "raycast/march/shading.h"
#include "raycast/pictures/compare.h"
#include "raycast/progressive.h"
#include "tests/raycast/scenes.h"
#include "volumes/field/brick_lists.h"
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
    return invert_cut({geometry, field_of(u)}, {elements, by});
  }
  template <class Move>
  VectorBricks field_of(Move&& u) const {
    VectorBricks field{elements, BrickVectors(elements.brick_count())};
    for (std::size_t b = 0; b < elements.brick_count(); ++b) {
      for_each_active(elements.mask(b), [&](int offset) {
        field.vectors.touch(b)[offset] = Vec3f(u(Vec3d(elements.origin(b) + brick_local(offset))));
      });
    }
    return field;
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

namespace {

/// A block of restless density, cut by an oblique plane: one half stays, the other one moves.
struct ParedBlock {
  static constexpr double kLow = 4, kHigh = 35;
  const Geometry geometry = cube_geometry(kCutSize);
  const Vec3d normal = Vec3d(1, 0.45, 0.3).normalized();
  const Vec3d along = normal.cross(Vec3d(0.2, -0.5, 1)).normalized();
  const Vec3d middle{19.7, 19.4, 19.6};
  BrickTopology elements = voxels_of({kCutSize, kCutSize, kCutSize},
                                     [](const Vec3i& v) { return is_in_block(Vec3d(v), 0); });
  DensityGrid density = grid_of(elements, [](const Vec3d& p) {
    return 500 + 250 * std::sin(1.1 * p.x + 0.7 * p.z) * std::cos(0.9 * p.y - 0.5 * p.x);
  });

  static bool is_in_block(const Vec3d& X, double margin) {
    for (int a = 0; a < 3; ++a) {
      if (!(X[a] >= kLow + margin && X[a] <= kHigh - margin)) return false;
    }
    return true;
  }
  double height(const Vec3d& X) const { return (X - middle).dot(normal); }
  /// Cuts of the links that the plane crosses, their places known or not.
  LinkCuts cuts(bool has_places) const {
    LinkCuts all;
    for (std::size_t b = 0; b < elements.brick_count(); ++b) {
      for_each_active(elements.mask(b), [&](int offset) {
        const Vec3i low = elements.origin(b) + brick_local(offset);
        for (int axis = 0; axis < 3; ++axis) {
          Vec3i high = low;
          ++high[axis];
          const double from = height(Vec3d(low)), to = height(Vec3d(high));
          if (!elements.is_active(high) || (from < 0) == (to < 0)) continue;
          all.cut(b, offset, axis, has_places ? LinkCuts::place_of(from / (from - to)) : 0);
        }
      });
    }
    return all;
  }
  /// The half below bent by u, the other one moved.
  OffsetField moved(const std::function<Vec3d(const Vec3d&)>& bend, const Vec3d& move,
                    const LinkCuts& by) const {
    VectorBricks u{elements, BrickVectors(elements.brick_count())};
    for (std::size_t b = 0; b < elements.brick_count(); ++b) {
      for_each_active(elements.mask(b), [&](int offset) {
        const Vec3d X(elements.origin(b) + brick_local(offset));
        u.vectors.touch(b)[offset] = Vec3f(height(X) < 0 ? bend(X) : move);
      });
    }
    return invert_cut({geometry, std::move(u)}, {elements, by});
  }
  /// Looks at the plane's middle from `degrees` above it.
  Camera camera(double degrees) const {
    const double angle = degrees * M_PI / 180;
    Camera camera;
    camera.projection = Projection::orthographic;
    camera.target_lps_mm = geometry.world_from_index(middle);
    camera.position_lps_mm =
        camera.target_lps_mm + (normal * std::sin(angle) + along * std::cos(angle)) * 200.0;
    camera.up_lps = normal.cross(along);
    camera.height_mm = 30;
    return camera;
  }
  /// True if a ray meets the bare face of the half that stays, away from its edges.
  bool meets_face(const Ray& ray, const Vec3d& move) const {
    const Vec3d from = geometry.index_from_world(ray.origin_lps_mm);
    const double t = -height(from) / ray.direction_lps.dot(normal);
    const auto at = [&](double s) { return from + ray.direction_lps * s; };
    if (!is_in_block(at(t), 3)) return false;
    for (double s = t - 100; s < t + 1; s += 0.2) {
      const Vec3d X = at(s) - move;
      if (is_in_block(X, -2) && height(X) > -2) return false;
    }
    return true;
  }
};

TransferFunction plaster() {
  TransferFunction f;
  f.opacity = {{0, 0}, {100, 0.99}, {1000, 0.99}};
  f.colour = {{0, {0.9, 0.8, 0.7}}};
  f.unit_distance_mm = 0.1;
  return f;
}

/// Looks at a face; calls visit(normal, colour, expected colour) for each of its pixels.
template <class Visit>
int look_at_face(const ParedBlock& block, bool has_places, const Vec3d& move, double degrees,
                 Visit&& visit) {
  const LinkCuts cuts = block.cuts(has_places);
  const OffsetField field = block.moved([](const Vec3d&) { return Vec3d(0); }, move, cuts);
  EXPECT_NE(field.split, nullptr);
  Renderer renderer(block.geometry, block.density);
  renderer.set_offsets(&field);
  RenderSettings settings = small_picture(90, 1.0 / 3);
  settings.auxiliary = true;
  const Camera camera = block.camera(degrees);
  const FloatImage picture = renderer.render_float(camera, plaster(), settings);
  const Shading shading(camera, plaster(), {});
  int pixels = 0;
  for (int y = 0; y < 90; ++y) {
    for (int x = 0; x < 90; ++x) {
      const Ray ray = camera_ray(camera, 90, 90, x + 0.5, y + 0.5);
      if (!block.meets_face(ray, move)) continue;
      const std::size_t n = std::size_t(y) * 90 + std::size_t(x);
      const float* at = &picture.normal_lps[3 * n];
      const float* rgba = &picture.rgba[4 * n];
      const Float4 expected = shading.shaded(Float4{0.9f, 0.8f, 0.7f, 1}, {Vec3f(block.normal), 1},
                                             shading.view(ray), nullptr);
      visit(Vec3d(at[0], at[1], at[2]), rgba, expected);
      ++pixels;
    }
  }
  return pixels;
}

}  // namespace

TEST(UnitCutPictures, ABareFaceHasTheNormalAndTheColourOfItsPlane) {
  const ParedBlock block;
  for (const double gap : {0.0, 3.0}) {  // slid along the face, and lifted off as well
    for (const double degrees : {60.0, 20.0, 4.0}) {
      const Vec3d move = block.along * -16.0 + block.normal * gap;
      const int pixels =
          look_at_face(block, true, move, degrees,
                       [&](const Vec3d& normal, const float* rgba, const Float4& expected) {
                         ASSERT_GT(normal.dot(block.normal), 0.9999) << gap << " " << degrees;
                         ASSERT_GT(rgba[3], 0.99);
                         for (int c = 0; c < 3; ++c)
                           ASSERT_NEAR(rgba[c], expected[c], 0.01) << gap << degrees;
                       });
      EXPECT_GT(pixels, 60) << gap << " " << degrees;
    }
  }
}

TEST(PropertyCutPictures, NoPixelOfABareFaceIsBlackOrLitFromWithinWhereItsSurfaceIsNotKnown) {
  // Faces between links, as those of joints: the planes are fitted to the links' middles.
  const ParedBlock block;
  for (const double gap : {0.0, 3.0}) {
    for (const double degrees : {60.0, 20.0, 6.0}) {
      const Vec3d move = block.along * -16.0 + block.normal * gap;
      double lowest = 1, sum = 0;
      const int pixels =
          look_at_face(block, false, move, degrees,
                       [&](const Vec3d& normal, const float* rgba, const Float4& expected) {
                         lowest = std::min(lowest, normal.dot(block.normal));
                         sum += std::abs(double(rgba[1] - expected[1]));
                         EXPECT_NEAR(rgba[1], expected[1], 0.25) << gap << " " << degrees;
                       });
      EXPECT_GT(lowest, 0.85) << gap << " " << degrees;
      EXPECT_LT(sum / pixels, 0.05) << gap << " " << degrees;
    }
  }
}

TEST(PropertyCutPictures, AFaceThatBendsHasFewerFacetsUnderCubicSampling) {
  // Waves of 9 voxels on the face of the half below. Where normals jump from one pixel to the next,
  // the difference from those of the waves does.
  const ParedBlock block;
  const double high = 1, often = 0.7;
  const auto along_face = [&](const Vec3d& X) {
    return often * (X - block.middle).dot(block.along);
  };
  const auto bend = [&](const Vec3d& X) { return block.normal * (high * std::sin(along_face(X))); };
  const OffsetField field =
      block.moved(bend, block.along * -60.0 + block.normal * 3.0, block.cuts(true));
  ASSERT_NE(field.split, nullptr);
  RenderSettings settings = small_picture(120);
  settings.auxiliary = true;
  const Camera camera = block.camera(90);
  const auto jumps_under = [&](Interpolation interpolation) {
    Renderer renderer(block.geometry, block.density, 0, interpolation);
    renderer.set_offsets(&field);
    const FloatImage picture = renderer.render_float(camera, plaster(), settings);
    int jumps = 0, compared = 0;
    Vec3d before(0);
    for (int n = 0; n < 120 * 120; ++n) {
      const Ray ray = camera_ray(camera, 120, 120, n % 120 + 0.5, n / 120 + 0.5);
      const Vec3d from = block.geometry.index_from_world(ray.origin_lps_mm);
      const Vec3d X = from - block.normal * block.height(from);  // rays come along the normal
      if (!ParedBlock::is_in_block(X, 4)) continue;
      const float* at = &picture.normal_lps[3 * std::size_t(n)];
      const Vec3d expected =
          (block.normal - block.along * (high * often * std::cos(along_face(X)))).normalized();
      const Vec3d off = Vec3d(at[0], at[1], at[2]) - expected;
      EXPECT_LT(off.length(), 0.3) << X;
      jumps += compared > 0 && (off - before).length() > 0.04;
      before = off;
      ++compared;
    }
    EXPECT_GT(compared, 5000);
    return jumps;
  };
  const int linear = jumps_under(Interpolation::linear), cubic = jumps_under(Interpolation::cubic);
  EXPECT_LT(2 * cubic, linear);
}

TEST(PropertyCutPictures, SidesThatTouchShowNoFaceBetweenThem) {
  // Translucent tissue, the right half slid along the cut: nothing of it can be seen where both
  // are.
  const CutSlab slab;
  const auto slid = [](const Vec3d& X) { return Vec3d(0, 0, X.x < 19.5 ? 0 : 3.5); };
  const OffsetField field = slab.moved(slid, slab.cuts);
  ASSERT_NE(field.split, nullptr);
  const LinkCuts none;
  const auto still = [](const Vec3d&) { return Vec3d(0); };
  for (const char* view : {"anterior", "left"}) {
    const Image touching = slab.picture(field, fog_function(0.1), view);
    const Image whole = slab.picture(slab.moved(still, none), fog_function(0.1), view);
    int compared = 0;
    for (std::size_t n = 0; n < whole.rgba.size() / 4; ++n) {
      const int row = int(n) / 80;
      if (row < 20 || row > 60) continue;  // where only one of the halves may be
      for (int c = 0; c < 4; ++c) EXPECT_NEAR(touching.rgba[4 * n + c], whole.rgba[4 * n + c], 1);
      compared += whole.rgba[4 * n + 3] > 0;
    }
    EXPECT_GT(compared, 1000) << view;
  }
}

TEST(PropertyCutPictures, BesideACutEachSideIsLitByItsOwnDisplacementAlone) {
  // The halves of a slab whose front is a ramp of density, sheared apart: y moves with x.
  CutSlab slab;
  slab.density =
      grid_of(slab.elements, [](const Vec3d& p) { return std::min(100 * (p.y - 12), 800.0); });
  const double shear = 0.35;
  const OffsetField field = slab.moved(
      [&](const Vec3d& X) {
        const bool is_left = X.x < 19.5;
        return Vec3d(is_left ? -2.0 : 2.0, shear * (X.x - 19.5) * (is_left ? 1 : -1), 0);
      },
      slab.cuts);
  ASSERT_NE(field.split, nullptr);
  Renderer renderer(slab.geometry, slab.density);
  renderer.set_offsets(&field);
  RenderSettings settings = small_picture(160);
  settings.auxiliary = true;
  const FloatImage picture = renderer.render_float(front_camera(40), surface_function(), settings);
  int compared = 0;
  for (int x = 0; x < 160; ++x) {
    const double from_middle = (x + 0.5 - 80) / 4;  // mm
    if (std::abs(from_middle) < 2.05 || std::abs(from_middle) > 12) continue;
    const float* at = &picture.normal_lps[3 * (80 * 160 + std::size_t(x))];
    const Vec3d expected = Vec3d(from_middle < 0 ? shear : -shear, -1, 0).normalized();
    EXPECT_GT(Vec3d(at[0], at[1], at[2]).dot(expected), 0.9995) << from_middle;
    ++compared;
  }
  EXPECT_GT(compared, 70);
}

/// The cut opens, opens further, moves with its tissue, closes and is taken back.
TEST(PropertyCutPictures, ARendererThatFollowsACutBodyDrawsWhatANewOneDraws) {
  const CutSlab slab;
  VectorBricks rest{slab.elements, BrickVectors(slab.elements.brick_count())};
  IncrementalCutInversion inversion({slab.geometry, rest}, {slab.elements, {}});
  Renderer following(slab.geometry, slab.density);
  const OffsetField at_rest = inversion.offsets();
  following.set_offsets(&at_rest);
  RenderSettings settings = small_picture(80);
  const Camera camera = default_camera(slab.geometry, 1, "anterior", Projection::orthographic);
  const TransferFunction function = fog_function(0.1);
  auto finished = std::make_unique<ProgressiveRender>(following, camera, function, settings);
  while (finished->refine()) {
  }
  const auto lips = [](double opening, double from, double to) {
    return [=](const Vec3d& X) {
      const bool is_moved = X.z > from && X.z < to;
      const double near = std::max(0.0, 1 - std::abs(X.x - 19.5) / 12);
      return Vec3d(is_moved ? (X.x < 19.5 ? -opening : opening) * near : 0, 0, 0);
    };
  };
  struct Step {
    std::function<Vec3d(const Vec3d&)> u;
    bool is_cut;
  };
  int followed = 0;
  for (const Step& step :
       {Step{lips(0, 0, 40), true}, Step{lips(1.5, 10, 22), true}, Step{lips(2.5, 10, 22), true},
        Step{lips(2.5, 8, 30), true}, Step{lips(-0.5, 16, 22), true}, Step{lips(0, 0, 40), true},
        Step{lips(2, 10, 22), true}, Step{lips(0, 0, 40), false}}) {
    const VectorBricks u = slab.field_of(step.u);
    inversion.set_cuts(step.is_cut ? slab.cuts : LinkCuts());
    const std::vector<Vec3i> touched =
        inversion.update({slab.geometry, u}, all_bricks(slab.elements));
    following.update_offsets(touched, inversion.finder(), inversion.split());
    const OffsetField field = slab.moved(step.u, step.is_cut ? slab.cuts : LinkCuts());
    Renderer anew(slab.geometry, slab.density);
    anew.set_offsets(&field);
    const Image expected = anew.render(camera, function, settings);
    ASSERT_EQ(following.render(camera, function, settings).rgba, expected.rgba);
    ASSERT_TRUE(finished->may_be_followed());
    auto next = finished->follow();
    followed += next->changed_pixels() < 80 * 80;
    while (next->refine()) {
    }
    ASSERT_EQ(to_image(next->picture()).rgba, expected.rgba);
    finished = std::move(next);
  }
  EXPECT_GT(followed, 2);
}

}  // namespace supple
