// Other people's programs apply our warp files: transformix (elastix) and plastimatch pull the
// source volume through the exported field and must agree with our own trilinear reading of it.
// Teem checks the NRRD headers. Each judge is skipped where it is not installed (tools/setup.sh
// --with-judges).
#include <cmath>
#include <cstdlib>
#include <functional>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/support/program.h"
#include "tests/support/random_state.h"
#include "tests/support/temporary_folder.h"
#include "volumes/field/dense/resample.h"
#include "volumes/field/inversion/invert.h"
#include "volumes/field/procedural.h"
#include "volumes/grid/density_grid.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/volume_writer.h"

using namespace supple;
using namespace supple::test;

namespace {

const std::vector<std::string> kImages = {"warp.nrrd", "warp.mha", "warp.nhdr",
                                          "warp.mhd",  "warp.nii", "warp.nii.gz"};
constexpr int kBorder = 2;
constexpr double kTolerance = 0.01;  // mean grey levels; both judges are at float rounding (3e-7)
constexpr double kFarOff = 10;       // mean grey levels; no warp at all is 12.8 away
const Vec3i kHeadDims(48, 40, 36);
using Image = std::vector<float>;  // kHeadDims, i fastest

std::size_t slot(int i, int j, int k) {
  return (std::size_t(k) * kHeadDims.y + j) * kHeadDims.x + i;
}

template <class Visit>
void for_each_voxel(Visit&& visit) {
  for (int k = 0; k < kHeadDims.z; ++k) {
    for (int j = 0; j < kHeadDims.y; ++j) {
      for (int i = 0; i < kHeadDims.x; ++i) visit(i, j, k);
    }
  }
}

/// Left-handed like ct_head: j to the anterior.
Geometry ct_like_grid() {
  return {kHeadDims, {-22, 25, -40}, {Vec3d(0.9, 0, 0), {0, -0.9, 0}, {0, 0, 1.5}}};
}

Geometry oblique_anisotropic_grid() {
  const double c = std::cos(0.5), s = std::sin(0.5), d = std::cos(-0.35), t = std::sin(-0.35);
  return {kHeadDims,
          {-20, 15, -33},
          {Vec3d(c, s, 0) * 0.8, Vec3d(-s * d, c * d, t) * 1.4, Vec3d(s * t, -c * t, d) * 2.3}};
}

/// Smooth grey values, 7 to 247.
Image grey_source() {
  Image image(slot(0, 0, kHeadDims.z));
  for_each_voxel([&](int i, int j, int k) {
    image[slot(i, j, k)] = float(127 + 60 * std::sin(0.3 * i) * std::cos(0.25 * j) +
                                 60 * std::sin(0.35 * k + 0.1 * i));
  });
  return image;
}

/// Offsets of several voxels that vanish on the faces of the box.
Vec3d windowed_offset(const Vec3d& p) {
  constexpr double kPi = 3.14159265358979323846;
  const double window = std::sin(kPi * p.x / (kHeadDims.x - 1)) *
                        std::sin(kPi * p.y / (kHeadDims.y - 1)) *
                        std::sin(kPi * p.z / (kHeadDims.z - 1));
  return Vec3d(4.5 * std::cos(0.12 * p.y), -4 * std::cos(0.15 * p.z), 3 * std::cos(0.1 * p.x)) *
         window;
}

BrickTopology whole_box() {
  return bricks_where(kHeadDims, [](const Vec3i&) { return true; });
}

DensityGrid grid_of(const Image& image) {
  const BrickTopology bricks = whole_box();
  std::vector<float> values(bricks.brick_count() * kBrickVoxels);
  for_each_voxel([&](int i, int j, int k) {
    values[std::size_t(bricks.find({i, j, k})) * kBrickVoxels + brick_offset({i, j, k})] =
        image[slot(i, j, k)];
  });
  return make_density_grid(bricks, values, 0);
}

/// out(x) = in(x + sign * o(x)), both trilinear: what a judge should answer.
Image own_reading(const Image& source, const OffsetField& offsets, double sign) {
  const DensityGrid grid = grid_of(source);
  Image image(source.size());
  for_each_voxel([&](int i, int j, int k) {
    Vec3f o;
    EXPECT_TRUE(offsets.o.at({i, j, k}, o));
    image[slot(i, j, k)] = sample_trilinear(grid, Vec3d(i, j, k) + Vec3d(o) * sign, 0);
  });
  return image;
}

void export_warp(const std::string& path, const OffsetField& offsets, double sign) {
  const Geometry& geometry = offsets.geometry;
  write_warp(path, {geometry, WarpDirection::resample}, [&](int k, Vec3f* out) {
    for (int j = 0; j < kHeadDims.y; ++j) {
      for (int i = 0; i < kHeadDims.x; ++i) {
        Vec3f o;
        offsets.o.at({i, j, k}, o);
        *out++ = Vec3f(geometry.world_vector_from_index(Vec3d(o) * sign));
      }
    }
  });
}

Image read_image(const std::string& path) {
  const auto file = open_volume(path);
  EXPECT_EQ(file->header().type, ValueType::float32);
  EXPECT_EQ(file->header().geometry.dims(), kHeadDims);
  Image image(slot(0, 0, kHeadDims.z));
  for (int k = 0; k < kHeadDims.z; ++k) file->read_slice(&image[slot(0, 0, k)]);
  return image;
}

double mean_difference(const Image& a, const Image& b) {
  double sum = 0;
  int count = 0;
  for (int k = kBorder; k < kHeadDims.z - kBorder; ++k) {
    for (int j = kBorder; j < kHeadDims.y - kBorder; ++j) {
      for (int i = kBorder; i < kHeadDims.x - kBorder; ++i, ++count) {
        sum += std::abs(double(a[slot(i, j, k)]) - b[slot(i, j, k)]);
      }
    }
  }
  return sum / count;
}

/// Pulls `source` through the field at `warp`; returns the path of the result.
using Judge =
    std::function<std::string(const TemporaryFolder&, const Geometry&, const std::string& warp)>;

std::string transformix(const TemporaryFolder& folder, const Geometry& geometry,
                        const std::string& warp) {
  std::ostringstream text;
  text.precision(17);
  const auto put = [&](const Vec3d& v) { text << " " << v.x << " " << v.y << " " << v.z; };
  text
      << "(Transform \"DeformationFieldTransform\")\n(NumberOfParameters 0)\n"
      << "(DeformationFieldFileName \"" << warp << "\")\n(DeformationFieldInterpolationOrder 1)\n"
      << "(InitialTransformParametersFileName \"NoInitialTransform\")\n"
      << "(HowToCombineTransforms \"Compose\")\n(FixedImageDimension 3)\n(MovingImageDimension 3)\n"
      << "(FixedInternalImagePixelType \"float\")\n(MovingInternalImagePixelType \"float\")\n"
      << "(Size " << kHeadDims.x << " " << kHeadDims.y << " " << kHeadDims.z
      << ")\n(Index 0 0 0)\n(Spacing";
  put(geometry.spacing_mm());
  text << ")\n(Origin";
  put(geometry.origin_lps_mm());
  text << ")\n(Direction";
  for (const Vec3d& axis : geometry.direction()) put(axis);
  text
      << ")\n(UseDirectionCosines \"true\")\n(Resampler \"DefaultResampler\")\n"
      << "(ResampleInterpolator \"FinalBSplineInterpolator\")\n(FinalBSplineInterpolationOrder 1)\n"
      << "(DefaultPixelValue 0)\n(ResultImageFormat \"mha\")\n(ResultImagePixelType \"float\")\n"
      << "(CompressResultImage \"false\")\n";
  write_text(folder / "transform.txt", text.str());
  std::filesystem::remove(folder / "result.mha");
  EXPECT_TRUE(runs("transformix -in " + (folder / "source.mha") + " -tp " +
                   (folder / "transform.txt") + " -out " + (folder / "")));
  return folder / "result.mha";
}

std::string plastimatch(const TemporaryFolder& folder, const Geometry&, const std::string& warp) {
  std::filesystem::remove(folder / "result.mha");
  EXPECT_TRUE(runs("plastimatch convert --input " + (folder / "source.mha") + " --fixed " +
                   (folder / "source.mha") + " --xf " + warp +
                   " --interpolation linear --output-type float --output-img " +
                   (folder / "result.mha")));
  return folder / "result.mha";
}

/// ITK itself, which alone reads transform files here; `supple-itk-transform` beside the program.
std::string itk_judge() {
  const char* binary = std::getenv("SUPPLE_BINARY");
  const std::filesystem::path program = binary != nullptr ? binary : "";
  const std::filesystem::path judge = program.parent_path() / "supple-itk-transform";
  return std::filesystem::exists(judge) ? judge.string() : "";
}

std::string itk(const TemporaryFolder& folder, const Geometry&, const std::string& warp) {
  std::filesystem::remove(folder / "result.mha");
  EXPECT_TRUE(runs(itk_judge() + " " + (folder / "source.mha") + " " + warp + " " +
                   (folder / "result.mha")));
  return folder / "result.mha";
}

/// The judge reads these files on both grids as we do; a flipped sign or no warp at all is far off.
void expect_agreement(const Judge& judge, const std::vector<std::string>& names) {
  const Image source = grey_source();
  for (const Geometry& geometry : {ct_like_grid(), oblique_anisotropic_grid()}) {
    const TemporaryFolder folder;
    const OffsetField offsets = sample_offsets({{}, windowed_offset}, geometry, whole_box());
    const Image expected = own_reading(source, offsets, 1);
    write_volume(folder / "source.mha", geometry, ValueType::float32, [&](int k, float* out) {
      std::copy_n(&source[slot(0, 0, k)], kHeadDims.x * kHeadDims.y, out);
    });
    EXPECT_GT(mean_difference(source, expected), kFarOff);

    for (const std::string& name : names) {
      export_warp(folder / name, offsets, 1);
      const double off =
          mean_difference(read_image(judge(folder, geometry, folder / name)), expected);
      EXPECT_LE(off, kTolerance) << name;
    }
    const std::string opposite = folder / ("flipped-" + names[0]);
    export_warp(opposite, offsets, -1);
    const Image flipped = read_image(judge(folder, geometry, opposite));
    EXPECT_GT(mean_difference(flipped, expected), kFarOff);
    EXPECT_LE(mean_difference(flipped, own_reading(source, offsets, -1)), kTolerance);
  }
}

/// A ball of tissue in air, pushed by up to `height` voxels along the axes: elements and shell.
State pushed_ball(const Geometry& geometry, const Image& grey, double height) {
  const auto ball = [](double radius) {
    return bricks_where(kHeadDims, [radius](const Vec3i& voxel) {
      return (Vec3d(voxel) - Vec3d(24, 20, 18)).length() < radius;
    });
  };
  State state;
  state.geometry = geometry;
  state.elements = ball(11);
  state.density = restrict_to(grid_of(grey), ball(13));
  for (int c = 0; c < 3; ++c) {
    state.q[c].resize(state.elements.brick_count());
    for (std::size_t b = 0; b < state.elements.brick_count(); ++b) {
      for_each_active(state.elements.mask(b), [&](int offset) {
        const Vec3d pos(state.elements.origin(b) + brick_local(offset));
        const double distance = (pos - Vec3d(22, 24, 20)).length();
        const double push = height / (1 + c) * std::exp(-distance * distance / 60);
        state.q[c].touch(b)[offset] = std::int32_t(push * kFixedOne);
      });
    }
  }
  return state;
}

/// The whole way: state, extension, inversion, dense warp with air where tissue left. The judge
/// applies it to the source; we resample with the offset field itself.
void expect_agreement_on_inverted_states(const Judge& judge,
                                         const std::vector<std::string>& names) {
  for (const Geometry& geometry : {ct_like_grid(), oblique_anisotropic_grid()}) {
    const TemporaryFolder folder;
    const State state = pushed_ball(geometry, grey_source(), 3);
    const OffsetField offsets = invert(extended_displacement_of(state));
    Image source, expected(slot(0, 0, kHeadDims.z));
    const ScalarSliceSource resampled = dense_resampled(offsets, state.density, geometry, 0);
    for (int k = 0; k < kHeadDims.z; ++k) resampled(k, &expected[slot(0, 0, k)]);
    for_each_voxel([&](int i, int j, int k) { source.push_back(state.density.at({i, j, k})); });

    write_volume(folder / "source.mha", geometry, ValueType::float32, [&](int k, float* out) {
      std::copy_n(&source[slot(0, 0, k)], kHeadDims.x * kHeadDims.y, out);
    });
    for (const std::string& name : names) {
      write_warp(folder / name, {geometry, WarpDirection::resample},
                 dense_offsets(offsets, state.density.bricks(), geometry, VoidMode::nearest));
      const Image pulled = read_image(judge(folder, geometry, folder / name));
      EXPECT_LE(mean_difference(pulled, expected), kTolerance) << name;
      EXPECT_GT(mean_difference(source, expected), 100 * kTolerance);
    }
  }
}

}  // namespace

TEST(InteropExport, TransformixPullsThroughOurWarpsAsWeDo) {
  if (!runs("transformix --version")) GTEST_SKIP() << "transformix (elastix) is not installed";
  expect_agreement(transformix, kImages);
  expect_agreement_on_inverted_states(transformix, {"warp.nrrd", "warp.mha"});
}

TEST(InteropExport, PlastimatchPullsThroughOurWarpsAsWeDo) {
  if (!runs("plastimatch --version")) GTEST_SKIP() << "plastimatch is not installed";
  expect_agreement(plastimatch, kImages);
  expect_agreement_on_inverted_states(plastimatch, {"warp.nrrd", "warp.mha"});
}

TEST(InteropExport, ItkPullsThroughOurTransformFilesAsWeDo) {
  if (itk_judge().empty()) GTEST_SKIP() << "libinsighttoolkit5-dev is not installed";
  expect_agreement(itk, {"warp.h5", "warp.hdf5"});
  expect_agreement_on_inverted_states(itk, {"warp.h5"});
}

TEST(InteropExport, TeemKeepsTheDirectionAndTheGeometryOfOurNrrd) {
  if (!runs("command -v teem-unu")) GTEST_SKIP() << "teem-apps is not installed";
  const TemporaryFolder folder;
  const Geometry geometry = oblique_anisotropic_grid();
  export_warp(folder / "warp.nhdr", sample_offsets({{}, windowed_offset}, geometry, whole_box()),
              1);
  ASSERT_TRUE(
      runs("teem-unu save -f nrrd -i " + (folder / "warp.nhdr") + " -o " + (folder / "teem.nrrd")));
  const std::string header = read_text(folder / "teem.nrrd").substr(0, 1000);
  for (const char* line : {"space: left-posterior-superior\n", "sizes: 3 48 40 36\n",
                           "kinds: vector domain domain domain\n", "space directions: none (",
                           "\nsupple direction:=resample\n"}) {
    EXPECT_NE(header.find(line), std::string::npos) << line << header;
  }
}
