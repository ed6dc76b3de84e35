// Golden images: small deterministic renders against committed references, one scene per theme.
// `bash tools/update_golden.sh` renders the references anew.
#include <gtest/gtest.h>

#include "raycast/drawings/value_images.h"
#include "raycast/pictures/compare.h"
#include "tests/tools/golden.h"
#include "volumes/geometry/geometry.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/load/load.h"

using namespace supple;
using namespace supple::test;

namespace {

void expect_all_golden(const GoldenFolder& folder, const std::vector<std::string>& names) {
  for (const std::string& name : names) expect_golden(folder, name + ".png");
}

/// 16-bit pictures and floats are judged as the 8 bits that they round to.
void expect_same(const Image& image, const std::string& reference) {
  const Comparison comparison = compare(image, golden_reference(reference), true);
  EXPECT_LE(comparison.max_diff, 1.01 / 255) << reference;
  EXPECT_GE(comparison.ssim, kMinSsim) << reference;
}

}  // namespace

TEST(GoldenImages, TheHeadPhantomLooksAsItDid) {
  const GoldenFolder folder;
  folder.run("head");
  expect_all_golden(folder,
                    {"head_bone_rest", "head_bone_drag", "head_skin_drag", "head_soft_drag"});
}

TEST(GoldenImages, SamplingPathsLookAsTheyDid) {
  const GoldenFolder folder;
  folder.run("paths");
  expect_all_golden(folder,
                    {"paths_explode_rest", "paths_open_twist_drag", "paths_bend_lattice_drag"});
}

TEST(GoldenImages, TheLatticeOfASliceLooksAsItDid) {
  const GoldenFolder folder;
  folder.run("slice");
  expect_golden(folder, "slice_lattice.png");
}

TEST(GoldenImages, LightsShadowsAndOcclusionLookAsTheyDid) {
  const GoldenFolder folder;
  folder.run("light", "head");
  expect_all_golden(folder, {"light_phong", "light_blinn", "light_shadows", "light_occlusion"});
}

TEST(GoldenImages, MeshesAndTheirShadowsLookAsTheyDid) {
  const GoldenFolder folder;
  folder.run("surfaces", "shear");
  expect_all_golden(folder, {"surfaces_shadows", "surfaces_still", "surfaces_deformed"});
}

TEST(GoldenImages, ClipsOfBothSpacesLookAsTheyDid) {
  const GoldenFolder folder;
  folder.run("clips", "head");
  expect_all_golden(folder, {"clips_box", "clips_source", "clips_deformed"});
}

TEST(GoldenImages, ClassificationsAndQualitiesLookAsTheyDid) {
  const GoldenFolder folder;
  folder.run("sampling", "head");
  expect_all_golden(folder, {"sampling_maximum", "sampling_veil", "sampling_pre_integrated",
                             "sampling_draft", "sampling_accurate", "sampling_jitter"});
}

TEST(GoldenImages, OpenedCutsAndOverlappingLipsLookAsTheyDid) {
  const GoldenFolder folder;
  folder.run("cut");
  expect_all_golden(folder, {"cut_open", "cut_overlap"});
}

TEST(GoldenImages, LipsThatCloseAndAreThenPushedThroughEachOtherLookAsTheyDid) {
  const GoldenFolder folder;
  folder.make("lips.nhdr");
  folder.run("lips");
  expect_all_golden(folder, {"lips_closed", "lips_through", "lips_through_slice"});
}

TEST(GoldenImages, ShearedAndFoldedTissueLooksAsItDid) {
  const GoldenFolder folder;
  folder.run("shear");
  expect_all_golden(folder, {"shear_bone", "shear_skin", "shear_jitter"});
  folder.run("fold");
  expect_all_golden(folder, {"fold_skin", "fold_slice"});
}

TEST(GoldenImages, StereoSlicesAndPicturesBesideThePictureLookAsTheyDid) {
  const GoldenFolder folder;
  folder.run("outputs", "head");
  expect_all_golden(folder, {"outputs_pair", "outputs_anaglyph", "outputs_aux_depth",
                             "outputs_aux_normal", "outputs_aux_offset", "outputs_slices"});
}

TEST(GoldenRealData, AHeadCtLooksAsItDid) {
  const std::string header = public_volume("ct_head.nhdr"), voxels = public_volume("ct_head.raw");
  if (header.empty() || voxels.empty()) GTEST_SKIP() << "no head CT (tools/fetch_ct_head.sh)";
  if (digest_volume(*open_volume(header)).sha256 != kHeadCtSha256) {
    GTEST_SKIP() << header << " holds the phantom that stands in offline";
  }
  const GoldenFolder folder;
  folder.link(header);
  folder.link(voxels);
  folder.run("ct");
  folder.run("cheek");
  expect_all_golden(folder, {"ct_bone_drag", "ct_below", "ct_cheek"});
}

TEST(GoldenRealData, AHeadMriLooksAsItDid) {
  const std::string head = public_volume("ch2.nii.gz");
  if (head.empty()) GTEST_SKIP() << "mricron-data is not installed";
  const GoldenFolder folder;
  folder.link(head);
  folder.run("mri");
  expect_all_golden(folder, {"mri_corner"});
}

TEST(GoldenImages, DeepPixelsAndFloatsReadBackAsThePictureThatTheyHold) {
  const GoldenFolder folder;
  folder.run("outputs", "head");
  expect_same(read_png(folder / "outputs_aux.png"), "outputs_aux.png");
  const FloatImage floats = read_exr(folder / "outputs_floats.exr");
  expect_same(to_image(floats), "outputs_aux.png");
  expect_same(depth_image(floats, range_of(floats.depth_mm)), "outputs_aux_depth.png");
  expect_same(normal_image(floats), "outputs_aux_normal.png");
  const Vec3f towards_camera(Vec3d(260, -360, 40).normalized());
  expect_same(offset_image(floats, {0, 13}, {towards_camera.x, towards_camera.y, towards_camera.z}),
              "outputs_aux_offset.png");
}

TEST(GoldenImages, OneThreadAndTwoDrawTheSameFiles) {
  const GoldenFolder one, two;
  for (const char* scene : {"head", "shear", "paths", "slice", "light", "surfaces", "clips",
                            "sampling", "outputs", "cut", "fold"}) {
    one.run(scene, "", 1);
    two.run(scene, "", 2);
  }
  ASSERT_GT(one.pictures().size(), 35u);
  for (const std::string& name : one.pictures()) {
    EXPECT_TRUE(read_text(one / name) == read_text(two / name)) << name;
  }
}
