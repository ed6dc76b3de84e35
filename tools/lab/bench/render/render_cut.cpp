#include "tools/lab/bench/render/render_cut.h"

#include <algorithm>
#include <cmath>

#include "raycast/render.h"
#include "tools/lab/bench/bodies/block_topology.h"
#include "tools/lab/bench/bodies/half_sampled_head.h"
#include "volumes/base/parallel.h"
#include "volumes/base/units.h"
#include "volumes/field/cuts/cut_offsets.h"
#include "volumes/field/procedural.h"

namespace supple::tools {

namespace {

constexpr int kShell = 2;  // voxels of air around the tissue that move with it
// Sizes of the incision in parts of the head's width: its half length, and how far each lip goes.
constexpr double kReach = 0.12, kOpening = 0.03;

struct CutHead {
  Geometry geometry;
  BrickTopology elements;
  DensityGrid density;
  Vec3d middle;  // of the incision, on the skin, index space
  double reach, opening;
  LinkCuts cuts;
};

/// Middle of the face, a third of its height up, where a ray from the front meets tissue.
Vec3d middle_of_face(const Geometry& geometry, const BrickTopology& elements) {
  const Vec3i& dims = geometry.dims();
  const bool is_front_last = geometry.index_vector_from_world({0, -1, 0}).y > 0;
  Vec3i voxel(dims.x / 2, is_front_last ? dims.y - 1 : 0, dims.z / 3);
  while (!elements.is_active(voxel)) voxel.y += is_front_last ? -1 : 1;
  return Vec3d(voxel) + Vec3d(0.5, 0, 0);
}

CutHead make_cut_head(const Vec3i& size) {
  const HalfSampledHead head(size);
  CutHead result{head_phantom(size).geometry, {}, {}, Vec3d(0), kReach * size.x,
                 kOpening * size.x,           {}};
  result.elements = block_topology(size, [&](const Vec3i& voxel) { return head.is_tissue(voxel); });
  const BrickTopology voxels = dilate_inside(result.elements, kShell, size);
  const auto fill = [&](std::size_t b, float* out) {
    for (int n = 0; n < kBrickVoxels; ++n) out[n] = head(voxels.origin(b) + brick_local(n));
  };
  result.density = fill_density_grid(voxels, fill, -1000);
  result.middle = middle_of_face(result.geometry, result.elements);
  const BrickTopology& elements = result.elements;
  for (std::size_t b = 0; b < elements.brick_count(); ++b) {
    for_each_active(elements.mask(b), [&](int offset) {
      const Vec3i voxel = elements.origin(b) + brick_local(offset);
      const bool is_beside = voxel.x == int(result.middle.x);
      if (!is_beside || (Vec3d(voxel) - result.middle).length() > result.reach) return;
      if (!elements.is_active(voxel + Vec3i(1, 0, 0))) return;
      result.cuts.cut(b, offset, 0, LinkCuts::place_of(0.5));
    });
  }
  return result;
}

/// Both lips go sideways, less the further away they are; apart, or both the same way.
Displacement moved(const CutHead& head, bool is_apart) {
  const auto u = [&head, is_apart](const Vec3d& X) {
    const Vec3d from = X - head.middle;
    const double rest = std::max(1 - from.length2() / (head.reach * head.reach), 0.0);
    return Vec3d((is_apart && from.x < 0 ? -1 : 1) * head.opening * rest * rest, 0, 0);
  };
  return sample_displacement({u, nullptr}, head.geometry, head.elements);
}

OffsetField offsets_of(const CutHead& head, bool is_cut) {
  const LinkCuts none;
  const CutElements body{head.elements, is_cut ? head.cuts : none};
  InvertParams params;
  params.material = &head.elements;
  return invert_cut(extend_past_cuts(moved(head, is_cut), head.density.bricks(), body), body,
                    params);
}

/// The incision fills most of the picture.
Camera camera_of(const CutHead& head) {
  Camera camera = default_camera(head.geometry, 1);
  const Vec3d towards = camera.target_lps_mm - camera.position_lps_mm;
  camera.target_lps_mm = head.geometry.world_from_index(head.middle);
  camera.position_lps_mm = camera.target_lps_mm - towards;
  const double half_mm = 1.25 * head.reach * head.geometry.spacing_mm().z;
  camera.vertical_fov_degrees = 2 * std::atan(half_mm / towards.length()) * 180 / kPi;
  return camera;
}

}  // namespace

std::vector<CutSide> cut_sides() {
  return {{"default"}, {"accurate"}};
}

std::string cut_row_name(const CutSide& side) {
  return "frame/cut/" + side.setting + "/1";
}

std::vector<BenchRow> measure_cut(const Vec3i& size, int image_size,
                                  const std::vector<CutSide>& sides, const RoundLimits& limits,
                                  const std::function<void()>& before_run) {
  const ThreadLimit one(1);
  const CutHead head = make_cut_head(size);
  const OffsetField cut = offsets_of(head, true), uncut = offsets_of(head, false);
  Renderer renderers[3] = {Renderer(head.geometry, head.density),
                           Renderer(head.geometry, head.density),
                           Renderer(head.geometry, head.density)};
  renderers[0].set_offsets(&cut);
  renderers[1].set_offsets(&uncut);
  const Camera camera = camera_of(head);
  std::vector<BenchRow> rows;
  for (const CutSide& side : sides) {
    RenderSettings settings;
    settings.width = settings.height = image_size;
    settings.set_quality(parse_quality(side.setting));
    RenderReport reports[3];
    std::vector<TimedSide> timed(3);
    for (int n = 0; n < 3; ++n) {
      timed[std::size_t(n)].run = [&, n](Times& times) {
        times.ms.push_back(cpu_time_ms(
            [&] { renderers[n].render(camera, preset("Muscle"), settings, &reports[n]); }));
      };
    }
    take_turns(timed, limits, before_run);
    const double cut_ms = timed[0].times.median();
    BenchRow row = {{"case", "cut"},
                    {"setting", side.setting},
                    {"size", {size.x, size.y, size.z}},
                    {"image", {image_size, image_size}},
                    {"samples", reports[0].samples},
                    {"of_straight", cut_ms / timed[2].times.median()},
                    {"of_uncut", cut_ms / timed[1].times.median()},
                    {"split_bricks", cut.split->bricks().brick_count()},
                    {"mbytes", double(reports[0].bytes) / 1e6}};
    add_times(row, timed[0].times, 1);
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace supple::tools
