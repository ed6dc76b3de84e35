#include "tools/lab/stress/stress_extremes.h"

#include <limits>

namespace supple::tools {

namespace {

constexpr float kSoft = 50, kStiff = 200;  // densities of two tissues

/// The grabbed half has `grabbed`, the held one `held`.
void two_halves(StressInput& input, double grabbed_kpa, double held_kpa) {
  const int middle = input.dims.x / 2;
  input.density = [middle](const Vec3i& voxel) { return voxel.x < middle ? kSoft : kStiff; };
  input.material["stiffness"] = toml_curve(kSoft, held_kpa, kStiff, grabbed_kpa);
}
void stiff_handle(StressInput& input) {
  two_halves(input, 1e4, 1e-4);
}
void soft_handle(StressInput& input) {
  two_halves(input, 1e-4, 1e4);
}
void checkered(StressInput& input) {
  input.density = [](const Vec3i& v) { return (v.x + v.y + v.z) % 2 == 0 ? kSoft : kStiff; };
  input.material["stiffness"] = toml_curve(kSoft, 1e-4, kStiff, 1e4);
  input.material["max_length"] = toml_curve(kSoft, 1.5, kStiff, 1);
  input.material["min_length"] = toml_curve(kSoft, 0.5, kStiff, 1);
  input.material["shear"] = toml_curve(kSoft, 0.5, kStiff, 0);
}
void poisson_0(StressInput& input) {
  input.material["poisson"] = toml_curve(0);
}
void poisson_4999(StressInput& input) {
  input.material["poisson"] = toml_curve(0.4999);
}
void poisson_half(StressInput& input) {
  input.material["poisson"] = toml_curve(0.5);
}
void limits_of(StressInput& input, double longest, double shortest, double shear) {
  input.material["max_length"] = toml_curve(longest);
  input.material["min_length"] = toml_curve(shortest);
  input.material["shear"] = toml_curve(shear);
}
void limits_zero(StressInput& input) {
  limits_of(input, 1, 1, 0);
  input.fixed.reset();
}
void limits_zero_held(StressInput& input) {
  limits_of(input, 1, 1, 0);
}
void limits_huge(StressInput& input) {
  limits_of(input, 1e12, 1e-12, 1e12);
}
void limits_infinite(StressInput& input) {
  limits_huge(input);
  input.material["max_length"] = "[[0, inf]]";
}
void drag_of(StressInput& input, double domains) {
  input.by_voxels = Vec3d(input.dims.x, -input.dims.y, input.dims.z) * domains;
}
void far_drag(StressInput& input) {
  drag_of(input, 10);
}
void far_drag_free(StressInput& input) {
  drag_of(input, 10);
  input.fixed.reset();
  input.least_covered = 0;
  // Slices show the air at the volume's least density, here that of the tissue.
  input.most_covered = input.has_slices ? 1 : 0;
}
void beyond_range(StressInput& input) {
  input.by_voxels = {20000, 0, 0};
  input.fixed.reset();
}
void one_voxel(StressInput& input) {
  input.take_block({1, 1, 1});
}
void rod(StressInput& input) {
  input.take_block({1, 1, 200});
  input.grabbed = {0, 0, 199};
  input.fixed = IndexBox{{0, 0, 0}, {0, 0, 0}};
  input.by_voxels = {2, 0.5, 1};
  input.view["lattice"] = "true";
  input.view["zoom"] = "20";
}
void sheet(StressInput& input) {
  input.take_block({64, 64, 1});
  input.by_voxels = {2, 0.5, 0};
}
/// Two cubes that one voxel joins.
void bridge(StressInput& input) {
  input.take_block({11, 5, 5});
  input.density = [](const Vec3i& v) { return v.x != 5 || (v.y == 2 && v.z == 2) ? 100.0f : 0.0f; };
}
/// Voxels that touch by edges alone.
void islands_of(StressInput& input, int size) {
  input.take_block({size, size, size});
  input.density = [](const Vec3i& v) { return (v.x + v.y + v.z) % 2 == 0 ? 100.0f : 0.0f; };
  input.grabbed = {size - 2, size / 2 / 2 * 2, size / 2 / 2 * 2};
  if ((input.grabbed.x + input.grabbed.y + input.grabbed.z) % 2 != 0) ++input.grabbed.x;
}
void islands(StressInput& input) {
  islands_of(input, 16);
}
void million_islands(StressInput& input) {
  islands_of(input, 127);
}
void thin_voxels(StressInput& input) {
  input.axes_mm = {Vec3d(0.01, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 10)};
  input.view["camera"] = "{ view = \"left\" }";
  input.slice["scale"] = "0.05";
}
void far_world(StressInput& input) {
  input.origin_lps_mm = {1e6, -1e6, 1e6};
}
void sheared_grid(StressInput& input) {
  input.axes_mm = {Vec3d(1, 0, 0), Vec3d(0.5, 1, 0), Vec3d(0.3, -0.4, 1.5)};
}
void left_handed(StressInput& input) {
  input.axes_mm = {Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, -1.5)};
}
/// The middle of a block is lifted, all its sides stay.
void bump_inside(StressInput& input) {
  input.take_block({15, 15, 15});
  input.grabbed = {7, 7, 7};
  input.grab = "grab_ball = [7, 7, 7], radius = 1.5, soft = 4";
  input.by_voxels = {0, 0, 1};
}
template <int hundredths>
void spring_steps(StressInput& input) {
  input.take_block({6, 5, 4});
  input.spring_step = hundredths / 100.0;
}
void camera_inside(StressInput& input) {
  const Vec3d middle = input.geometry().world_from_index(Vec3d(input.dims) * 0.5);
  input.view["camera"] = "{ position = " + toml_text(middle) +
                         ", target = " + toml_text(middle + Vec3d(5, 1, 0.5)) +
                         ", up = [0, 0, 1], fov = 120 }";
  input.least_covered = 0.9;
}
void image_1(StressInput& input) {
  input.view["size"] = "[1, 1]";
}
void image_16k(StressInput& input) {
  input.view["size"] = "[16384, 16384]";
}
void image_too_large(StressInput& input) {
  input.view["size"] = "[16385, 1]";
}
void slice_too_large(StressInput& input) {
  thin_voxels(input);
  input.slice["scale"] = "64";
}
void transfer_empty(StressInput& input) {
  input.transfer["opacity"] = "[[0, 0], [255, 0]]";
  input.least_covered = input.most_covered = 0;
}
void transfer_without_keys(StressInput& input) {
  input.transfer["opacity"] = "[]";
}
void transfer_opaque(StressInput& input) {
  input.transfer["opacity"] = "[[0, 1]]";
  input.least_covered = 0.1;
}
void transfer_nan(StressInput& input) {
  input.transfer["opacity"] = "[[0, 0], [100, nan]]";
}
void limits_nan(StressInput& input) {
  input.material["max_length"] = "[[0, nan]]";
}
void stiffness_nan(StressInput& input) {
  input.material["stiffness"] = "[[0, nan]]";
}
void voxels_nan(StressInput& input) {
  input.density = [](const Vec3i& v) {
    return v.y < 2 ? std::numeric_limits<float>::quiet_NaN() : 100.0f;
  };
}
void all_nan(StressInput& input) {
  input.density = [](const Vec3i&) { return std::numeric_limits<float>::quiet_NaN(); };
}
void operations_300(StressInput&) {}
void operations_10000(StressInput& input) {
  input.operations = 10000;
}
void drags_200(StressInput& input) {
  input.operations = 200;
}

}  // namespace

const std::vector<StressExtreme>& stress_extremes() {
  static const std::vector<StressExtreme> extremes = {
      {"stiff-handle", "grabbed half 1e8 times as stiff as the held one", kOfStiffness,
       stiff_handle},
      {"soft-handle", "grabbed half 1e-8 times as stiff as the held one", kOfStiffness,
       soft_handle},
      {"checkered", "voxels in turn rigid and soft, stiffness 1e8 to 1", kOfStiffness | kOfLimits,
       checkered},
      {"poisson-0", "ν = 0", kOfPoisson, poisson_0},
      {"poisson-0.4999", "ν = 0.4999", kOfPoisson, poisson_4999},
      {"poisson-0.5", "ν = 0.5", kOfPoisson, poisson_half, {{{3, "poisson"}}}},
      {"limits-zero", "links that give nothing, nothing fixed", kOfLimits, limits_zero},
      {"limits-zero-held", "links that give nothing, one side fixed", kOfLimits, limits_zero_held},
      {"limits-huge", "lengths 1e-12 to 1e12, shear 1e12", kOfLimits, limits_huge},
      {"limits-infinite", "max_length = inf", kOfLimits, limits_infinite, {{{3, "max_length"}}}},
      {"far-drag",
       "a drag of 10 times the domain, one side fixed",
       kOfBody,
       far_drag,
       {{{1, "finite elements did not converge beyond"}, {"fem-finite"}}}},
      {"far-drag-free",
       "a drag of 10 times the domain, nothing fixed (out of the picture)",
       kOfBody,
       far_drag_free,
       {{{1, "take a shorter step or implicit Euler"}, {"symplectic"}}}},
      {"beyond-range", "a drag of 20000 voxels", kOfBody, beyond_range, {{{3, "16383"}}}},
      {"one-voxel", "1 x 1 x 1 voxels", kOfBody, one_voxel},
      {"rod", "1 x 1 x 200 voxels", kOfBody, rod},
      {"sheet", "64 x 64 x 1 voxels", kOfBody, sheet},
      {"bridge", "two blocks that one voxel joins", kOfBody, bridge},
      {"islands", "2048 islands of one voxel", kOfBody, islands},
      {"thin-voxels", "voxels of 0.01 x 1 x 10 mm", kOfBody, thin_voxels},
      {"far-world", "origin at 1e6 mm", kOfBody, far_world},
      {"sheared", "a sheared grid", kOfBody, sheared_grid},
      {"left-handed", "a left-handed grid", kOfBody, left_handed},
      {"bump-inside", "a bump inside the volume", kOfBody, bump_inside},
      {"step-0.01", "steps of 0.01 of the longest stable one", kOfSteps, spring_steps<1>},
      {"step-0.1", "steps of 0.1 of it", kOfSteps, spring_steps<10>},
      {"step-1", "the longest stable step", kOfSteps, spring_steps<100>},
      {"step-10", "steps of 10 times it", kOfSteps, spring_steps<1000>},
      {"step-100", "steps of 100 times it", kOfSteps, spring_steps<10000>},
      {"camera-inside", "a camera inside the volume", kOfView, camera_inside},
      {"image-1", "a picture of 1 x 1 pixels", kOfView, image_1},
      {"image-too-large",
       "a picture of 16385 x 1 pixels",
       kOfView,
       image_too_large,
       {{{3, "16384"}}}},
      {"slice-too-large",
       "64 pixels a voxel of 0.01 mm",
       kOfView,
       slice_too_large,
       {{{3, "16384"}}},
       false,
       20,
       1000,
       {"slices"}},
      {"transfer-empty", "opacity 0 everywhere (nothing is seen)", kOfTransfer, transfer_empty},
      {"transfer-without-keys",
       "no key of opacity",
       kOfTransfer,
       transfer_without_keys,
       {{{3, "opacity"}}}},
      {"transfer-opaque", "opacity 1 everywhere, air too", kOfTransfer, transfer_opaque},
      {"transfer-nan",
       "an opacity that is no number",
       kOfTransfer,
       transfer_nan,
       {{{3, "opacity"}}}},
      {"limits-nan", "a limit that is no number", kOfLimits, limits_nan, {{{3, "max_length"}}}},
      {"stiffness-nan",
       "a stiffness that is no number",
       kOfStiffness,
       stiffness_nan,
       {{{3, "stiffness"}}}},
      {"voxels-nan", "voxels that are no numbers, which are void", kOfBody, voxels_nan},
      {"all-nan", "no voxel that is a number", kOfBody, all_nan, {{{3, "volume.nrrd"}}}},
      {"operations", "300 random operations", kOfSession, operations_300},
      {"million-islands",
       "1.02 million islands of one voxel",
       kOfBody,
       million_islands,
       {},
       true,
       300,
       8000},
      {"image-16k",
       "a picture of 16384 x 16384 pixels",
       kOfView,
       image_16k,
       {},
       true,
       600,
       12000,
       {"picture"}},
      {"operations-10000",
       "10,000 random operations",
       kOfSession,
       operations_10000,
       {},
       true,
       3600},
      {"head-bones",
       "200 random drags of the upper jaw of `ct_head`",
       kOfBones,
       drags_200,
       {},
       true,
       3600,
       4000},
  };
  return extremes;
}

}  // namespace supple::tools
