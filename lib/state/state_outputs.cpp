#include "lib/state/state_outputs.h"

#include "lib/state/warp_jumps.h"
#include "volumes/base/json.h"
#include "volumes/field/dense/resample.h"
#include "volumes/grid/b_spline.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/volume_writer.h"

namespace supple {

Fields fields(GridChoice& choice) {
  return {
      Field("grid", choice.file, "Take the output grid from this volume").path(),
      Field("margin", choice.margin_mm, "Grow the grid on every side").unit("mm").range(0, 1e6),
  };
}

std::optional<Geometry> grid_of_file(const GridChoice& choice) {
  if (choice.file.empty()) return std::nullopt;
  return open_volume(choice.file)->header().geometry;
}

Geometry choose_grid(const Geometry& source, const GridChoice& choice) {
  const Geometry grid = grid_of_file(choice).value_or(source);
  return choice.margin_mm > 0 ? with_margin(grid, choice.margin_mm) : grid;
}

namespace {

std::int64_t warn_of_lost_material(const std::string& path, const State& state, const Pose& pose,
                                   const Geometry& grid, Progress* progress) {
  const std::int64_t lost =
      count_outside(on_elements(state.geometry, state.elements, &pose.displacement), grid);
  if (lost > 0) {
    warn(progress, path + ": " + std::to_string(lost) +
                       " voxels of material lie outside the grid; a margin keeps them");
  }
  return lost;
}

/// Velocities of tissue in mm/s: that at x has come from x + o(x) within s seconds.
VectorSliceSource velocities(const VectorSliceSource& offsets_mm, const Geometry& grid, double s) {
  const std::size_t count = std::size_t(grid.dims().x) * grid.dims().y;
  return [=](int k, Vec3f* out) {
    offsets_mm(k, out);
    for (std::size_t n = 0; n < count; ++n) out[n] *= float(-1 / s);
  };
}

}  // namespace

std::int64_t write_state_warp(const WarpOutput& output, const State& state, const Pose& pose,
                              Progress* progress) {
  WarpFacts facts{state.geometry, output.direction, ""};
  VectorSliceSource slices;
  std::optional<VectorBricks> sparse;
  std::int64_t lost = 0;
  const bool is_material = output.direction == WarpDirection::material;
  const bool may_be_sparse = keeps_bricks(output.path);
  if (is_material) {
    if (may_be_sparse) sparse = sparse_displacement(pose.displacement);
    if (!sparse) slices = dense_displacement(pose.displacement);
  } else {
    lost = warn_of_lost_material(output.path, state, pose, output.grid, progress);
    facts.geometry = output.grid;
    facts.certificate = json_text(to_value(pose.offsets.certificate));
    if (may_be_sparse && output.void_mode == VoidMode::nearest && output.grid == state.geometry) {
      sparse = sparse_offsets(pose.offsets, state.density.bricks());
    }
    if (!sparse) {
      slices = dense_offsets(pose.offsets, state.density.bricks(), output.grid, output.void_mode,
                             &state.elements);
    }
  }
  WarpJumps jumps(facts.geometry);
  const auto watched = [&](int k, Vec3f* out) {
    slices(k, out);
    jumps.add(out);
  };
  if (sparse) {
    jumps.add(*sparse);
    warn_of_all(output.path, write_warp(output.path, facts, *sparse, progress, output.options),
                progress);
  } else {
    warn_of_all(output.path, write_warp(output.path, facts, watched, progress, output.options),
                progress);
  }
  note(progress, output.path + ": " +
                     (is_material ? "for moving points and meshes from rest, not for resampling"
                                  : use_of_warp(output.void_mode, jumps)));
  return lost;
}

std::int64_t write_resampled(const std::string& path, const State& state, const Pose& pose,
                             const Geometry& grid, const WriteOptions& options, Progress* progress,
                             bool is_cubic, double velocity_s) {
  const std::int64_t lost = warn_of_lost_material(path, state, pose, grid, progress);
  ValueType type = ValueType::float32;
  find_numpy_type(state.source_type, type);
  std::optional<SplineDensity> spline;
  if (is_cubic) spline.emplace(state.density, state.geometry.dims(), true);
  const auto between = [&](const Vec3d& index) { return float(spline->at(index)); };
  const float fill = state.density.background();
  const auto slices = is_cubic ? dense_resampled(pose.offsets, between, grid, fill)
                               : dense_resampled(pose.offsets, state.density, grid, fill);
  WriteOptions with_velocity = options;
  if (velocity_s > 0) {
    with_velocity.velocity = velocities(dense_offsets(pose.offsets, state.density.bricks(), grid,
                                                      VoidMode::nearest, &state.elements),
                                        grid, velocity_s);
  }
  warn_of_all(path, write_volume(path, grid, type, slices, progress, with_velocity), progress);
  return lost;
}

}  // namespace supple
