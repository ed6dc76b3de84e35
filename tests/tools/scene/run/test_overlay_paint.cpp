// Values over tissue, against what they are by hand: of motions, and of volumes on grids of their
// own; and the options that ask for them.
#include <cmath>

#include <gtest/gtest.h>

#include "raycast/pictures/compare.h"
#include "raycast/pictures/image.h"
#include "tests/support/program.h"
#include "tools/scene/run/overlay_paint.h"
#include "volumes/grid/voxel_sets.h"

using namespace supple;
using namespace supple::test;
using namespace supple::tools;

namespace {

/// Voxels of [2, 6)^3.
BrickTopology cube() {
  std::vector<Vec3i> voxels;
  for (int k = 2; k < 6; ++k) {
    for (int j = 2; j < 6; ++j) {
      for (int i = 2; i < 6; ++i) voxels.push_back({i, j, k});
    }
  }
  return topology_of(voxels);
}

/// 3 + x mm of its own voxels' places, those with x < 4 mm void.
std::shared_ptr<const Volume> ramp(const Geometry& geometry) {
  auto volume = std::make_shared<Volume>();
  std::vector<Vec3i> voxels;
  const Vec3i& dims = geometry.dims();
  for (int k = 0; k < dims.z; ++k) {
    for (int j = 0; j < dims.y; ++j) {
      for (int i = 0; i < dims.x; ++i) {
        if (geometry.world_from_index(Vec3d(i, j, k)).x >= 4) voxels.push_back({i, j, k});
      }
    }
  }
  const BrickTopology bricks = topology_of(voxels);
  std::vector<float> values(bricks.brick_count() * kBrickVoxels);
  for (std::size_t b = 0; b < bricks.brick_count(); ++b) {
    for (int n = 0; n < kBrickVoxels; ++n) {
      const Vec3d place = geometry.world_from_index(Vec3d(bricks.origin(b) + brick_local(n)));
      values[b * kBrickVoxels + std::size_t(n)] = float(3 + place.x);
    }
  }
  volume->geometry = geometry;
  volume->density = make_density_grid(bricks, values, 0);
  volume->statistics.min = 0;
  volume->statistics.max = 12;
  return volume;
}

const Geometry kBody({8, 8, 8}, {0, 0, 0}, {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}});

}  // namespace

TEST(UnitOverlayPaint, DisplacementsAreLengthsInMmOfElementsAlone) {
  const BrickTopology elements = cube();
  const Geometry wide({8, 8, 8}, {0, 0, 0}, {Vec3d(2, 0, 0), {0, 1, 0}, {0, 0, 1}});
  const PaintedBody body{wide, elements, [](const Vec3d& x, Vec3d& at_rest) {
                           at_rest = x - Vec3d(1.5, 0, 0);
                           return true;
                         }};
  TissueMarks marks;
  marks.overlay = "displacement";
  marks = with_overlay_range(marks, 4);
  EXPECT_EQ(*marks.overlay_range, NumberPair(0, 4));
  const ValuePaint paint = overlay_paint(marks, body, PaintEdge::halfway);
  ASSERT_TRUE(paint.value({5, 4, 4}));
  EXPECT_NEAR(*paint.value({5, 4, 4}), 3, 1e-12);  // 1.5 voxels of 2 mm
  EXPECT_FALSE(paint.value({2.4, 4, 4}));          // 0.9 at rest: nearest voxel is no element
  EXPECT_FALSE(paint.value({2.9, 4, 4}));          // 1.4: beside one
  EXPECT_TRUE(overlay_paint(marks, body, PaintEdge::beside).value({2.9, 4, 4}));
  EXPECT_FALSE(overlay_paint(marks, body, PaintEdge::beside).value({2.4, 4, 4}));
}

TEST(UnitOverlayPaint, DetFOfAStretchIsItsRatio) {
  const BrickTopology elements = cube();
  const PaintedBody body{kBody, elements, [](const Vec3d& x, Vec3d& at_rest) {
                           at_rest = {x.x / 1.25, x.y, x.z};
                           return true;
                         }};
  TissueMarks marks;
  marks.overlay = "det_f";
  const ValuePaint paint = overlay_paint(with_overlay_range(marks, 0), body, PaintEdge::halfway);
  EXPECT_NEAR(*paint.value({5, 4, 4}), 1.25, 1e-12);
  EXPECT_EQ(paint.range.lo, 0.5);
  EXPECT_EQ(paint.colours, ValueColours::about_middle);
}

/// The volume has other voxels and is read at the place where tissue was at rest.
TEST(UnitOverlayPaint, AVolumeIsReadWhereTissueWasAtRestByItsOwnGrid) {
  const BrickTopology elements = cube();
  const Geometry fine({40, 24, 24}, {-2, -1, -1}, {Vec3d(0.4, 0, 0), {0, 0.5, 0}, {0, 0, 0.5}});
  const PaintedBody body{kBody, elements, [](const Vec3d& x, Vec3d& at_rest) {
                           at_rest = x - Vec3d(0, 1, 0);
                           return x.z < 6;
                         }};
  TissueMarks marks;
  marks.overlay = "ramp.nrrd";
  marks.overlay_volume = ramp(fine);
  marks = with_overlay_range(marks, 0);
  EXPECT_EQ(*marks.overlay_range, NumberPair(0, 12));
  const ValuePaint paint = overlay_paint(marks, body, PaintEdge::halfway);
  EXPECT_EQ(paint.colours, ValueColours::ascending);
  ASSERT_TRUE(paint.value({4.7, 5, 4}));
  EXPECT_NEAR(*paint.value({4.7, 5, 4}), 7.7, 1e-5);
  EXPECT_FALSE(paint.value({4.7, 7.2, 4}));  // 6.2 at rest: no element
  EXPECT_FALSE(paint.value({4.7, 2.2, 4}));  // 1.2
  EXPECT_FALSE(paint.value({4.7, 5, 6.5}));  // no place at rest is known
  EXPECT_FALSE(paint.value({3.2, 5, 4}));    // no value there
}

/// Voxels without a value do not take part, so that values are not faded at the skin.
TEST(UnitOverlayPaint, ValuesAtAnEdgeAreThoseOfTheVoxelsThatHaveOne) {
  const BrickTopology elements = cube();
  const PaintedBody body{kBody, elements, nullptr};
  TissueMarks marks;
  marks.overlay = "ramp.nrrd";
  marks.overlay_volume = ramp(kBody);
  marks = with_overlay_range(marks, 0);
  const ValuePaint slice = overlay_paint(marks, body, PaintEdge::halfway);
  const ValuePaint space = overlay_paint(marks, body, PaintEdge::beside);
  EXPECT_NEAR(*slice.value({3.7, 4, 4}), 7, 1e-6);  // of voxel 4 alone
  EXPECT_FALSE(slice.value({3.4, 4, 4}));
  EXPECT_NEAR(*space.value({3.4, 4, 4}), 7, 1e-6);
  EXPECT_FALSE(space.value({2.9, 4, 4}));
  // A plain volume is painted where it has values.
  const PaintedBody bodiless{kBody, marks.overlay_volume->density.bricks(), nullptr};
  EXPECT_TRUE(overlay_paint(marks, bodiless, PaintEdge::halfway).value({7, 7, 7}));
  EXPECT_FALSE(slice.value({7, 7, 7}));
}

TEST(UnitOverlayPaint, ValuesOfBothSignsHaveTheirMiddleAtZero) {
  auto volume = std::make_shared<Volume>(*ramp(kBody));
  TissueMarks marks;
  marks.overlay = "pressure.nrrd";
  marks.overlay_volume = volume;
  for (const auto& [least, most] : {NumberPair(-2, 1), NumberPair(-1, 2)}) {
    volume->statistics.min = least;
    volume->statistics.max = most;
    EXPECT_EQ(*with_overlay_range(marks, 0).overlay_range, NumberPair(-2, 2));
  }
  marks = with_overlay_range(marks, 0);
  const PaintedBody body{kBody, volume->density.bricks(), nullptr};
  EXPECT_EQ(overlay_paint(marks, body, PaintEdge::halfway).colours, ValueColours::about_middle);
}

namespace {

class UnitOverlayOptions : public testing::Test {
 protected:
  UnitOverlayOptions() {
    write_ball(m_folder, "ball", 24);
    write_soft_material(m_folder / "soft.toml");
    EXPECT_EQ(run({"deform", m_folder / "ball.nhdr", "--material", m_folder / "soft.toml", "--grab",
                   "12,12,12", "--by", "4,0,0", "-o", m_folder / "drag.vdb"}),
              "");
  }
  /// Runs the program; returns its error output when it fails.
  std::string run(const std::vector<std::string>& arguments) {
    const Outcome outcome = run_supple(arguments);
    return outcome.exit_code == 0 ? "" : outcome.err;
  }
  Image picture(const std::string& command, std::vector<std::string> more) {
    std::vector<std::string> arguments = {command, m_folder / "drag.vdb", "-o", m_folder / "a.png",
                                          "--force"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    EXPECT_EQ(run(arguments), "");
    return read_png(m_folder / "a.png");
  }
  std::string refusal(const std::string& input, std::vector<std::string> more) {
    std::vector<std::string> arguments = {"render", m_folder / input,   "--size", "20,20",
                                          "-o",     m_folder / "b.png", "--force"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }

  const TemporaryFolder m_folder;
};

/// Pixels that are not grey.
int coloured(const Image& image) {
  int count = 0;
  for (std::size_t n = 0; n < image.rgba.size(); n += 4) {
    const std::uint8_t* rgba = &image.rgba[n];
    count += std::max({rgba[0], rgba[1], rgba[2]}) - std::min({rgba[0], rgba[1], rgba[2]}) > 20;
  }
  return count;
}

}  // namespace

TEST_F(UnitOverlayOptions, SlicesAndPicturesArePaintedOverTheBodyAlone) {
  const std::vector<std::string> plain = {"--plane", "axial", "--no-outline"};
  std::vector<std::string> painted = plain;
  painted.insert(painted.end(), {"--overlay", "displacement"});
  EXPECT_EQ(coloured(picture("slice", plain)), 0);
  const Image slice = picture("slice", painted);
  EXPECT_GT(coloured(slice), 100);
  EXPECT_EQ(slice.rgba[0], 0);  // air
  // The volume itself as values, which are 0 outside of the ball.
  const Image grey = picture("render", {"--size", "60,60", "--preset", "MR-Default"});
  const Image values = picture(
      "render", {"--size", "60,60", "--preset", "MR-Default", "--overlay", m_folder / "ball.nhdr"});
  int changed = 0;
  for (std::size_t n = 0; n < grey.rgba.size(); n += 4) {
    const bool differs = !std::equal(&grey.rgba[n], &grey.rgba[n + 3], &values.rgba[n]);
    EXPECT_TRUE(!differs || grey.rgba[n + 3] > 0);
    changed += differs;
  }
  EXPECT_GT(changed, 200);
}

TEST_F(UnitOverlayOptions, TheOutlineAtRestIsDrawnWhereTheBodyWas) {
  const std::vector<std::string> plain = {"--size", "60,60", "--preset", "MR-Default"};
  std::vector<std::string> outlined = plain;
  outlined.emplace_back("--outline");
  const Image without = picture("render", plain), with = picture("render", outlined);
  int yellow = 0, changed = 0;
  for (std::size_t n = 0; n < with.rgba.size(); n += 4) {
    const bool differs = !std::equal(&with.rgba[n], &with.rgba[n + 4], &without.rgba[n]);
    changed += differs;
    yellow += differs && with.rgba[n] == 255 && with.rgba[n + 1] == 200 && with.rgba[n + 2] == 0;
  }
  EXPECT_GT(yellow, 60);
  EXPECT_EQ(changed, yellow);
}

TEST_F(UnitOverlayOptions, SamplesThatSolveForThemselvesArePaintedAsThroughTheInverse) {
  const std::vector<std::string> exact = {"--size",     "60,60",     "--preset",
                                          "MR-Default", "--overlay", "displacement"};
  std::vector<std::string> solved = exact;
  solved.emplace_back("--no-inverse");
  EXPECT_GT(compare(picture("render", exact), picture("render", solved), true).ssim, 0.98);
}

/// Words are no files of the scene's folder, and files lie beside it.
TEST_F(UnitOverlayOptions, AScenePaintsAsTheCommandLineDoes) {
  const auto of_scene = [&](const std::string& overlay) {
    write_text(
        m_folder / "s.toml",
        "[volume]\npath = \"ball.nhdr\"\n[material]\ntable = \"soft.toml\"\n[[step]]\ngrab = [12, "
        "12, 12]\nby = [4.0, 0.0, 0.0]\n[[view]]\nimage = \"p.png\"\nsize = [60, 60]\npreset = "
        "\"MR-Default\"\noverlay = \"" +
            overlay + "\"\n[[view]]\nimage = \"q.png\"\nslice = { plane = \"axial\", overlay = \"" +
            overlay + "\" }\n");
    EXPECT_EQ(run({"run", m_folder / "s.toml", "-o", m_folder / "out", "--force"}), "");
    return std::pair(read_png(m_folder / "out/p.png"), read_png(m_folder / "out/q.png"));
  };
  for (const std::string& overlay : {std::string("displacement"), std::string("ball.nhdr")}) {
    const bool is_file = overlay == "ball.nhdr";
    const std::string given = is_file ? m_folder / overlay : overlay;
    const auto [space, slice] = of_scene(overlay);
    EXPECT_EQ(
        space.rgba,
        picture("render", {"--size", "60,60", "--preset", "MR-Default", "--overlay", given}).rgba);
    EXPECT_EQ(slice.rgba, picture("slice", {"--plane", "axial", "--overlay", given}).rgba);
  }
}

TEST_F(UnitOverlayOptions, AFilmOfDisplacementsNeedsARange) {
  const auto film = [&](const std::string& range) {
    write_text(
        m_folder / "f.toml",
        "[volume]\npath = \"ball.nhdr\"\n[material]\ntable = \"soft.toml\"\n[film]\nframes = "
        "2\n[[step]]\ngrab = [12, 12, 12]\nby = [1.0, 0.0, 0.0]\n[[view]]\nimage = "
        "\"f_%d.png\"\nsize = [20, 20]\noverlay = \"displacement\"\n" +
            range);
    return run({"run", m_folder / "f.toml", "-o", m_folder / "film", "--force"});
  };
  const std::string refused = film("");
  EXPECT_NE(refused.find("overlay_range: found none beside displacements"), std::string::npos)
      << refused;
  EXPECT_EQ(film("overlay_range = [0, 2]\n"), "");
}

TEST_F(UnitOverlayOptions, WhatCannotBePaintedIsRefusedWithTheOption) {
  const auto expect = [&](const std::string& input, const std::vector<std::string>& more,
                          const std::string& words) {
    const std::string found = refusal(input, more);
    EXPECT_NE(found.find(words), std::string::npos) << found;
  };
  expect("ball.nhdr", {"--overlay", "displacement"}, "--overlay: found nothing that has moved");
  expect("drag.vdb", {"--overlay", "displacment"},
         "expected displacement, det_f or a readable file");
  expect("drag.vdb", {"--overlay", "det_f", "--overlay-range", "2,1"},
         "--overlay-range: found 2,1");
  expect("drag.vdb", {"--overlay-range", "1,2"}, "a range without an overlay");
  expect("ball.nhdr", {"--outline"}, "--outline: found a volume, not a body");
  expect("drag.vdb", {"--overlay", "det_f", "--lattice"}, "a lattice to draw");
  expect("drag.vdb", {"--outline", "--lattice"}, "a lattice to draw");
}
