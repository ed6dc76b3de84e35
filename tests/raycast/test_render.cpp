// Laws of the free-sampling marcher (design.md section 5).
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <random>

#include <gtest/gtest.h>

#include "raycast/pictures/compare.h"
#include "raycast/sample/sample_batch.h"
#include "tests/raycast/scenes.h"
#include "tests/support/program.h"
#include "volumes/base/parallel.h"
#include "volumes/field/procedural.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/load/load.h"

namespace supple {
namespace {

constexpr int kBodySize = 48;

/// Noisy densities with holes: nothing that a shortcut could get right by symmetry.
DensityGrid rough_volume() {
  std::mt19937 random(7);
  const BrickTopology where = voxels_of({kBodySize, kBodySize, kBodySize}, [&](const Vec3i& v) {
    const bool hole = ((v.x * 7 + v.y * 13 + v.z * 5) % 97) == 0;
    return (Vec3d(v) - Vec3d(24)).length() < 21 && !hole;
  });
  const DensityFunction body = lobed_body(Vec3d(23.5), 15);
  return grid_of(where, [&](const Vec3d& p) { return std::floor(body(p)) + int(random() % 40); });
}

OffsetField zero_offsets(const Geometry& geometry, const BrickTopology& where) {
  return {geometry, {where, BrickVectors(where.brick_count())}, {}};
}

std::vector<std::string> some_views() {
  return {"anterior", "left", "superior"};
}

TEST(PropertyRender, ZeroOffsetsGiveTheStraightPictureBitForBit) {
  const Geometry geometry({kBodySize, kBodySize, kBodySize}, {3, -2, 1},
                          {Vec3d(0.9, 0.1, 0), {0, -1.1, 0.05}, {0, 0.2, 1.4}});
  const DensityGrid grid = rough_volume();
  Renderer straight(geometry, grid), offset(geometry, grid);
  const OffsetField zero = zero_offsets(geometry, grid.bricks());
  offset.set_offsets(&zero);
  for (const std::string& view : some_views()) {
    for (const int stride : {1, 4}) {
      RenderSettings settings = small_picture(96);
      settings.stride = stride;
      const Camera camera = default_camera(geometry, 1, view);
      RenderReport a, b;
      const Image expected = straight.render(camera, surface_function(), settings, &a);
      EXPECT_EQ(expected.rgba, offset.render(camera, surface_function(), settings, &b).rgba);
      EXPECT_EQ(a.samples, b.samples);
      EXPECT_GT(compare(expected, Image(96, 96), true).compared_pixels, 500);
    }
  }
}

/// The golden pictures are made by the best set; packages run on machines with less.
TEST(PropertyRender, EveryInstructionSetGivesThePictureOfTheBest) {
  const Geometry geometry = cube_geometry(kBodySize);
  Renderer renderer(geometry, rough_volume());
  const OffsetField bent = sample_offsets(bump_warp(Vec3d(23.5), 18, 4), geometry,
                                          voxels_of(Vec3i(kBodySize), everywhere));
  renderer.set_offsets(&bent);
  const Camera camera = default_camera(geometry, 1);
  const Image best = renderer.render(camera, surface_function(), small_picture(96));
  const std::vector<std::string> sets = sampling_instruction_sets();
#ifdef SUPPLE_TEST_ALL_LANES
  EXPECT_GE(sets.size(), 2u);
#endif
  for (const std::string& set : sets) {
    choose_sampling_instruction_set(set);
    const Image image = renderer.render(camera, surface_function(), small_picture(96));
    const Comparison comparison = compare(best, image, true);
    EXPECT_GT(comparison.compared_pixels, 500) << set;
    EXPECT_LE(comparison.rmse, 1e-3) << set;
    EXPECT_GE(comparison.ssim, 0.999) << set;
  }
  choose_sampling_instruction_set("");
}

TEST(PropertyRender, TinyOffsetsTakeTheDeformedPathAndHardlyChangeThePicture) {
  const Geometry geometry = cube_geometry(kBodySize);
  const DensityGrid grid = rough_volume();
  Renderer straight(geometry, grid), offset(geometry, grid);
  OffsetField tiny = zero_offsets(geometry, grid.bricks());
  tiny.o.vectors = vectors_of(tiny.o.topology, Vec3f(1e-6f, 0, 0));
  offset.set_offsets(&tiny);
  const Camera camera = default_camera(geometry, 1);
  const Image a = straight.render(camera, surface_function(), small_picture(96));
  const Image b = offset.render(camera, surface_function(), small_picture(96));
  EXPECT_GT(compare(a, b, true).ssim, 0.9999);
}

TEST(PropertyRender, SkippingEmptySpaceDoesNotChangeThePicture) {
  const Geometry geometry = cube_geometry(kBodySize);
  const DensityGrid grid = rough_volume();
  Renderer renderer(geometry, grid);
  const AnalyticWarp warp = bump_warp({24, 24, 24}, 18, 6);
  const OffsetField bump = sample_offsets(warp, geometry, dilate(grid.bricks(), 6));
  for (const OffsetField* offsets : {static_cast<const OffsetField*>(nullptr), &bump}) {
    renderer.set_offsets(offsets);
    for (const std::string& view : some_views()) {
      for (const auto& [stride, classification] : {std::pair(1, Classification::post),
                                                   {3, Classification::post},
                                                   {4, Classification::post},
                                                   {1, Classification::pre_integrated},
                                                   {3, Classification::pre_integrated}}) {
        RenderSettings with = small_picture(80);
        with.stride = stride;
        with.classification = classification;
        RenderSettings without = with;
        without.skip_empty_space = false;
        RenderReport a, b;
        const Camera camera = default_camera(geometry, 1, view);
        EXPECT_EQ(renderer.render(camera, surface_function(), with, &a).rgba,
                  renderer.render(camera, surface_function(), without, &b).rgba);
        EXPECT_EQ(a.rays, b.rays);
        // Batches begin elsewhere.
        EXPECT_NEAR(double(a.samples), double(b.samples), 0.1 * double(b.samples));
      }
    }
  }
}

TEST(PropertyRender, ThePictureDoesNotDependOnTheNumberOfThreads) {
  const Geometry geometry = cube_geometry(kBodySize);
  const Renderer renderer(geometry, rough_volume());
  const Camera camera = default_camera(geometry, 1);
  const auto render = [&] {
    return renderer.render(camera, surface_function(), small_picture(100));
  };
  const Image one = on_threads(1, render);
  for (const int threads : {2, 5}) EXPECT_EQ(on_threads(threads, render).rgba, one.rgba);
}

TEST(PropertyRender, LeftHandedAndPermutedStoragesShowTheSamePicture) {
  const DensityFunction body = lobed_body({2, -1, 3}, 14);  // in mm
  const Vec3i dims(kBodySize, kBodySize, kBodySize);
  const double m = 0.5 * (kBodySize - 1);
  const Geometry storages[] = {
      {dims, {-m, -m, -m}, {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}}},
      {dims, {m, -m, -m}, {Vec3d(-1, 0, 0), {0, 1, 0}, {0, 0, 1}}},   // left-handed
      {dims, {-m, m, -m}, {Vec3d(1, 0, 0), {0, -1, 0}, {0, 0, 1}}},   // left-handed, as ct_head
      {dims, {-m, -m, -m}, {Vec3d(0, 0, 1), {1, 0, 0}, {0, 1, 0}}}};  // permuted
  Image first;
  for (const Geometry& geometry : storages) {
    const BrickTopology where = voxels_of(dims, everywhere);
    const DensityGrid grid =
        grid_of(where, [&](const Vec3d& p) { return body(geometry.world_from_index(p)); });
    const Renderer renderer(geometry, grid);
    const Camera camera = default_camera(storages[0], 1);
    const Image image = renderer.render(camera, surface_function(), small_picture(128));
    if (first.width == 0) first = image;
    EXPECT_LT(compare(first, image, true).rmse, 1e-3);
    EXPECT_GT(compare(first, image, true).ssim, 0.9999);
  }
}

TEST(PropertyRender, ConstantOffsetsShowTheMovedVolume) {
  const Geometry geometry = cube_geometry(kBodySize);
  const Vec3i shift(5, -3, 4);
  const auto near_centre = [](const Vec3i& v) { return (Vec3d(v) - Vec3d(24)).length() < 14; };
  const BrickTopology here = voxels_of(geometry.dims(), near_centre);
  const BrickTopology there =
      voxels_of(geometry.dims(), [&](const Vec3i& v) { return near_centre(v - shift); });
  const DensityFunction body = lobed_body(Vec3d(24), 10);
  Renderer moved(geometry, grid_of(here, body));
  const Renderer expected(geometry,
                          grid_of(there, [&](const Vec3d& p) { return body(p - Vec3d(shift)); }));
  OffsetField offsets = zero_offsets(geometry, there);
  offsets.o.vectors = vectors_of(offsets.o.topology, -Vec3f(shift));
  moved.set_offsets(&offsets);
  const Camera camera = default_camera(geometry, 1);
  const Comparison result =
      compare(moved.render(camera, surface_function(), small_picture(128)),
              expected.render(camera, surface_function(), small_picture(128)), true);
  EXPECT_GT(result.compared_pixels, 1000);
  EXPECT_LE(result.max_diff, 2.0 / 255);
}

TEST(PropertyRender, ALoadedVolumeWithBackgroundRingsLooksLikeTheWholeVolume) {
  // The loader leaves out voxels at the minimum; surfaces beside them must not become jagged.
  const Geometry geometry = cube_geometry(kBodySize);
  const DensityFunction body = lobed_body(Vec3d(23.5), 14);
  const auto density = [&](const Vec3d& p) { return std::max(std::floor(body(p)) - 300, 0.0); };
  const DensityGrid whole = grid_of(voxels_of(geometry.dims(), everywhere), density);
  const DensityGrid loaded = restrict_to(
      whole, voxels_of(geometry.dims(), [&](const Vec3i& v) { return density(Vec3d(v)) > 0; }));
  const Camera camera = default_camera(geometry, 1);
  TransferFunction f = surface_function();
  f.opacity = {{0, 0}, {100, 0.9}};
  const auto picture = [&](const DensityGrid& grid, int rings) {
    return Renderer(geometry, grid, rings).render(camera, f, small_picture(128));
  };
  const Image expected = picture(whole, 0);
  EXPECT_EQ(picture(loaded, 2).rgba, expected.rgba);
  EXPECT_LT(compare(picture(loaded, 0), expected, true).ssim, 0.99);
}

TEST(PropertyRender, ElementsWithTheirShellLookLikeTheVolumeBitForBit) {
  const Geometry geometry = cube_geometry(kBodySize);
  const DensityFunction body = lobed_body(Vec3d(23.5), 14);
  const DensityGrid whole = grid_of(voxels_of(geometry.dims(), everywhere), [&](const Vec3d& p) {
    return p.x < 2 ? -1900 : std::floor(body(p));
  });
  const BrickTopology elements =
      voxels_of(geometry.dims(), [&](const Vec3i& v) { return whole.at(v) >= 350; });
  const DensityGrid state = restrict_to(whole, dilate(elements, 2));
  ASSERT_LT(state.bricks().active_count(), whole.bricks().active_count() / 2);
  const Camera camera = default_camera(geometry, 1);
  EXPECT_EQ(Renderer(geometry, state).render(camera, surface_function(), small_picture(128)).rgba,
            Renderer(geometry, whole).render(camera, surface_function(), small_picture(128)).rgba);
}

TEST(PropertyRender, StrideFindsWhatEverySampleFindsOnThickObjects) {
  const Geometry geometry = cube_geometry(kBodySize);
  const Renderer renderer(
      geometry, grid_of(voxels_of(geometry.dims(), everywhere), lobed_body(Vec3d(23.5), 14)));
  const Camera camera = default_camera(geometry, 1);
  RenderSettings every = small_picture(128), strided = every;
  every.stride = 1;
  RenderReport a, b;
  const Image expected = renderer.render(camera, surface_function(), every, &a);
  EXPECT_GT(compare(expected, renderer.render(camera, surface_function(), strided, &b), true).ssim,
            0.995);
  EXPECT_LT(b.samples, a.samples);
}

TEST(PropertyRender, AHomogeneousSlabFollowsBeerAndLambert) {
  // 16 cells of 1 mm; opacity 0.1 per mm: 1 - 0.9^16, whatever the step.
  const Geometry geometry = cube_geometry(24);
  const BrickTopology where =
      voxels_of(geometry.dims(), [](const Vec3i& v) { return v.y >= 4 && v.y <= 20; });
  const Renderer renderer(geometry, grid_of(where, [](const Vec3d&) { return 100; }));
  const Camera camera = default_camera(geometry, 1, "anterior", Projection::orthographic);
  for (const double step : {0.125, 0.25, 0.5, 1.0}) {
    RenderSettings settings = small_picture(3, step);
    settings.lighting.model = ShadingModel::none;
    const Image image = renderer.render(camera, fog_function(0.1), settings);
    EXPECT_NEAR(image.rgba[4 * 4 + 3], 255 * (1 - std::pow(0.9, 16)), 0.51) << "step " << step;
    EXPECT_EQ(image.rgba[4 * 4], 255);
  }
}

TEST(PropertyRender, GradientOpacityHidesHomogeneousPlaces) {
  const Geometry geometry = cube_geometry(24);
  const Renderer renderer(geometry,
                          grid_of(voxels_of(geometry.dims(), everywhere),
                                  [](const Vec3d& p) { return p.z < 12 ? 500 : 60 * p.z; }));
  TransferFunction f = fog_function(0.5);
  f.gradient_opacity = {{0, 0}, {30, 1}};
  const Camera camera = default_camera(geometry, 1, "anterior", Projection::orthographic);
  const Image image = renderer.render(camera, f, small_picture(24));
  EXPECT_EQ(image.rgba[4 * (20 * 24 + 12) + 3], 0);   // low, constant
  EXPECT_GT(image.rgba[4 * (4 * 24 + 12) + 3], 250);  // high, steep
}

class CancelAtOnce : public Progress {
 public:
  void stage(std::string_view) override {}
  void update(double) override {}
  bool cancelled() const override { return true; }
};

TEST(UnitRender, CancellingThrows) {
  const Renderer renderer(cube_geometry(8), DensityGrid());
  CancelAtOnce progress;
  EXPECT_THROW(renderer.render(Camera(), surface_function(), small_picture(64), nullptr, &progress),
               Cancelled);
}

TEST(UnitRender, WeakGradientsFadeToFacingTheLight) {
  // A ramp across the view: its normal points away from the camera's light, 4 densities per mm. It
  // begins behind the volume's border, which is a face of its own.
  const Geometry geometry = cube_geometry(24);
  const BrickTopology where = voxels_of(geometry.dims(), [](const Vec3i& v) { return v.y >= 5; });
  Renderer renderer(geometry, grid_of(where, [](const Vec3d& p) { return 4 * p.z; }));
  const Camera camera = default_camera(geometry, 1, "anterior", Projection::orthographic);
  const auto grey_at_centre = [&](double full_shading_gradient) {
    TransferFunction f = fog_function(1);
    f.ambient = 0.1, f.diffuse = 0.8, f.specular = 0;
    f.full_shading_gradient = full_shading_gradient;
    const Image image = renderer.render(camera, f, small_picture(9));
    return double(image.rgba[4 * (4 * 9 + 4)]) / 255;
  };
  const double trusted = grey_at_centre(0), facing = grey_at_centre(1e9);
  EXPECT_NEAR(facing, 0.9, 0.01);
  EXPECT_LT(trusted, 0.6);
  EXPECT_NEAR(grey_at_centre(8), 0.5 * (trusted + facing), 0.01);
  EXPECT_NEAR(grey_at_centre(4), trusted, 0.005);
}

TEST(UnitRender, WrongSettingsAndForeignOffsetsAreInputErrors) {
  Renderer renderer(cube_geometry(8), DensityGrid());
  RenderSettings settings = small_picture(8);
  settings.step_voxels = 0;
  EXPECT_THROW(renderer.render(Camera(), surface_function(), settings), InputError);
  settings = small_picture(8);
  settings.stride = 17;
  EXPECT_THROW(renderer.render(Camera(), surface_function(), settings), InputError);
  EXPECT_THROW(renderer.render(Camera(), surface_function(), small_picture(20000)), InputError);
  const OffsetField foreign = zero_offsets(cube_geometry(9), {});
  EXPECT_THROW(renderer.set_offsets(&foreign), InputError);
}

TEST(PropertyRenderCt, ZeroOffsetsGiveTheStraightPictureOfAHead) {
  const std::string path = test::public_volume("ct_head.nhdr");
  if (path.empty()) GTEST_SKIP() << "no head CT (tools/fetch_ct_head.sh)";
  const Volume head = load_volume(path);
  Renderer renderer(head.geometry, head.density);
  const Camera camera = default_camera(head.geometry, 1);
  const Image straight = renderer.render(camera, preset("Bone"), small_picture(200));
  const OffsetField zero = zero_offsets(head.geometry, head.density.bricks());
  renderer.set_offsets(&zero);
  EXPECT_EQ(straight.rgba, renderer.render(camera, preset("Bone"), small_picture(200)).rgba);
}

/// SSIM of `ct_head` by preset and quality, as docs/pictures.md has them.
std::map<std::string, double> documented_ssim() {
  const char* source = std::getenv("SUPPLE_SOURCE_DIR");
  std::ifstream page(std::string(source != nullptr ? source : ".") + "/docs/pictures.md");
  std::map<std::string, double> found;
  for (std::string line; std::getline(page, line);) {
    for (const char* quality : {"draft", "default", "accurate"}) {
      const std::string start = std::string("| `") + quality + "` |";
      double steps, bone, soft;
      if (line.rfind(start, 0) == 0 &&
          std::sscanf(line.c_str() + start.size(), " %lf | %lf | %lf |", &steps, &bone, &soft) ==
              3) {
        found[std::string("Bone ") + quality] = bone;
        found[std::string("Skin ") + quality] = soft;
      }
    }
  }
  return found;
}

TEST(ConvergenceRenderCt, QualitiesAreAsNearToTheReferenceAsTheTableSays) {
  const std::string path = test::public_volume("ct_head.nhdr");
  if (path.empty()) GTEST_SKIP() << "no head CT (tools/fetch_ct_head.sh)";
  if (digest_volume(*open_volume(path)).sha256 != test::kHeadCtSha256) {
    GTEST_SKIP() << path << " holds the phantom that stands in offline";
  }
  const std::map<std::string, double> documented = documented_ssim();
  ASSERT_EQ(documented.size(), 6u);
  const Volume head = load_volume(path);
  const Renderer renderer(head.geometry, head.density);
  const Camera camera = default_camera(head.geometry, 1);
  for (const char* look : {"Bone", "Skin"}) {
    RenderSettings settings = small_picture(350, 0.05);
    settings.stride = 1;
    settings.early_termination = 1;
    const Image reference = renderer.render(camera, preset(look), settings);
    settings.early_termination = RenderSettings().early_termination;
    for (const char* quality : {"draft", "default", "accurate"}) {
      settings.set_quality(parse_quality(quality));
      const Image image = renderer.render(camera, preset(look), settings);
      EXPECT_NEAR(compare(image, reference, true).ssim,
                  documented.at(std::string(look) + " " + quality), 0.001)
          << look << " " << quality;
    }
  }
}

}  // namespace
}  // namespace supple
