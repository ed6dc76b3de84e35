// Outputs of a state on regular grids: warps and resampled volumes.
#pragma once

#include <string>
#include <vector>

#include "lib/state/pose.h"
#include "volumes/io/format/volume_file.h"

namespace supple {

/// The grid of a dense output: the source grid, another file's, or grown by a margin.
struct GridChoice {
  std::string file;
  double margin_mm = 0;
};
Fields fields(GridChoice& choice);
Geometry choose_grid(const Geometry& source, const GridChoice& choice);
/// The grid of the choice's file; nothing without one.
std::optional<Geometry> grid_of_file(const GridChoice& choice);

struct WarpOutput {
  std::string path;
  WarpDirection direction = WarpDirection::resample;
  VoidMode void_mode = VoidMode::nearest;  // of the resample direction
  Geometry grid;                           // of the resample direction
  WriteOptions options = {};
};
/// Both warn of material that leaves the grid and return how many voxels of it do. A note tells the
/// uses of a warp: how far neighbouring vectors differ, and how many pairs fold. `velocity_s`,
/// unless 0: the seconds in which the displacement is gone through, for WriteOptions::velocity.
std::int64_t write_state_warp(const WarpOutput& output, const State& state, const Pose& pose,
                              Progress* progress);
std::int64_t write_resampled(const std::string& path, const State& state, const Pose& pose,
                             const Geometry& grid, const WriteOptions& options, Progress* progress,
                             bool is_cubic = false, double velocity_s = 0);

}  // namespace supple
