// Views that VTK's ray caster draws (`caster = "vtk"`), beside the same ones of Supple.
#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>

#include "raycast/pictures/compare.h"
#include "tests/support/program.h"
#include "tools/scene/peers/vtk_peer.h"
#include "volumes/io/volume_writer.h"

using namespace supple;
using namespace supple::test;

namespace {

/// Three blocks of different sizes and densities, so that no two axes can be taken for each other,
/// in a grid of voxels that are no cubes; the middle one is dragged.
class VtkPicture : public testing::Test {
 protected:
  void write(const std::array<Vec3d, 3>& axes_mm) const {
    const Geometry geometry(Vec3i(30, 26, 22), Vec3d(10, -20, 30), axes_mm);
    write_volume(m_folder / "blocks.nrrd", geometry, ValueType::int16, [](int k, float* out) {
      for (int j = 0; j < 26; ++j) {
        for (int i = 0; i < 30; ++i) {
          const bool is_small = i >= 4 && i < 10 && j >= 4 && j < 10 && k >= 4 && k < 8;
          const bool is_long = i >= 4 && i < 26 && j >= 14 && j < 20 && k >= 6 && k < 10;
          const bool is_high = i >= 16 && i < 22 && j >= 8 && j < 20 && k >= 10 && k < 19;
          *out++ = is_small ? 400 : is_long ? 700 : is_high ? 1000 : 0;
        }
      }
    });
  }
  Outcome draw(const std::string& view) const {
    write_text(m_folder / "scene.toml",
               "[volume]\npath = \"blocks.nrrd\"\n[material]\ndomain = [0, 1000]\n"
               "active = [1, 1000]\nmax_length = [[0, 1.3]]\nmin_length = [[0, 0.7]]\n"
               "shear = [[0, 0.4]]\n[[step]]\ngrab = [19, 14, 17]\nby = [9.0, 0.0, 4.0]\n"
               "[[view]]\npreset = \"Bone\"\nsize = [200, 160]\nbackground = \"black\"\n"
               "step = 0.25\n" +
                   view);
    return run_supple({"run", m_folder / "scene.toml", "-o", m_folder / "", "--force"});
  }
  Image picture(const std::string& name, const std::string& keys) const {
    const Outcome outcome = draw("image = \"" + name + "\"\n" + keys);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return read_png(m_folder / name);
  }

  TemporaryFolder m_folder;
};

/// The correlation of what changes from the first picture to the second, pair by pair.
double likeness_of_changes(const std::array<Image, 2>& a, const std::array<Image, 2>& b) {
  double ab = 0, aa = 0, bb = 0;
  for (std::size_t n = 0; n < a[0].rgba.size(); ++n) {
    const double of_a = double(a[1].rgba[n]) - a[0].rgba[n];
    const double of_b = double(b[1].rgba[n]) - b[0].rgba[n];
    ab += of_a * of_b;
    aa += of_a * of_a;
    bb += of_b * of_b;
  }
  return ab / std::sqrt(aa * bb);
}

using InteropVtk = VtkPicture;
using FaultVtk = VtkPicture;

}  // namespace

TEST_F(InteropVtk, PicturesAreThoseOfSupple) {
  if (!tools::VtkPeer::is_installed()) GTEST_SKIP() << "VTK for Python or Xvfb is not installed";
  const double s = std::sqrt(0.5);
  const std::array<Vec3d, 3> turned = {Vec3d(s, s, 0), {-1.5 * s, 1.5 * s, 0}, {0, 0, 2}};
  const std::array<Vec3d, 3> left_handed = {Vec3d(s, s, 0), {-1.5 * s, 1.5 * s, 0}, {0, 0, -2}};
  for (const auto& axes : {turned, left_handed}) {
    write(axes);
    for (const std::string camera : {"shading = \"none\"\nfit = \"body\"\ncamera = { position = "
                                     "[150.0, -190.0, 160.0], target = [5.0, 5.0, "
                                     "45.0], up = [0.0, 0.0, 1.0], fov = 12.0 }\n",
                                     "shading = \"none\"\nfit = \"body\"\ncamera = { view = "
                                     "\"left\", projection = \"orthographic\" }\n"}) {
      const Image own = picture("own.png", camera);
      const Image theirs = picture("theirs.png", "caster = \"vtk\"\n" + camera);
      const Image at_rest = picture("rest.png", "deformed = false\n" + camera);
      EXPECT_GT(compare(theirs, own, true).ssim, 0.95) << camera;
      EXPECT_LT(compare(theirs, own, true).rmse, 0.5 * compare(theirs, at_rest, true).rmse)
          << camera;
    }
  }
}

TEST_F(InteropVtk, LightComesFromTheSameSide) {
  if (!tools::VtkPeer::is_installed()) GTEST_SKIP() << "VTK for Python or Xvfb is not installed";
  write({Vec3d(0, 1, 0), {-1.5, 0, 0}, {0, 0, 2}});
  const std::string left = "light = [{ direction = [-1.0, 0.0, 0.3], frame = \"camera\" }]\n";
  const std::string right = "light = [{ direction = [1.0, 0.0, 0.3], frame = \"camera\" }]\n";
  const std::string frontal = "light = [{ direction = [-1.0, -0.3, 0.0], frame = \"lps\" }]\n";
  const auto by_vtk = [&](const std::string& light) {
    return picture("theirs.png", "caster = \"vtk\"\n" + light);
  };
  const Image own_left = picture("l.png", left), own_right = picture("r.png", right);
  EXPECT_GT(likeness_of_changes({own_left, own_right}, {by_vtk(left), by_vtk(right)}), 0.5);
  EXPECT_GT(likeness_of_changes({own_left, own_right}, {by_vtk(frontal), by_vtk(right)}), 0.5);
}

TEST_F(FaultVtk, WhatVtkDoesNotDrawIsRefused) {
  write({Vec3d(1, 0, 0), {0, 1.5, 0}, {0, 0, 2}});
  const std::pair<const char*, const char*> cases[] = {
      {"inverse = false", "samples that solve for themselves beside caster"},
      {"fit = \"visible\"", "what is visible beside caster"},
      {"sampling = \"cubic\"", "cubic samples beside caster"},
      {"shadows = true", "shadows, occlusion or exposure beside caster"},
      {"aux = [\"depth\"]", "channels beside colours beside caster"},
      {"stereo = \"anaglyph\"", "two eyes beside caster"},
  };
  for (const auto& [keys, line] : cases) {
    const Outcome outcome =
        draw("image = \"a.png\"\ncaster = \"vtk\"\n" + std::string(keys) + "\n");
    EXPECT_EQ(outcome.exit_code, 3) << keys;
    EXPECT_NE(outcome.err.find(line), std::string::npos) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(m_folder / "a.png"));
  }
}
