// The input of a row of `supple stress`: a small volume, a material, a load and a view, which
// extremes and models change before the files of a scene are written. `supple run` takes them as
// well.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "volumes/geometry/geometry.h"

namespace supple::tools {

/// Keys of a table with their values, as TOML.
using TomlKeys = std::map<std::string, std::string>;

struct StressInput {
  StressInput();

  /// Another block of tissue, held by its first plane along i and grabbed in the middle of the
  /// last; of one plane nothing is held.
  void take_block(const Vec3i& block_dims);

  Vec3i dims{0, 0, 0};
  Vec3d origin_lps_mm{-20, 10, 5};
  std::array<Vec3d, 3> axes_mm{Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 1.5)};
  std::function<float(const Vec3i& voxel)> density;  // 0: no element

  TomlKeys material;
  Vec3i grabbed{0, 0, 0};  // an element of the handle
  std::string grab;        // what is grabbed, as keys of a handle; empty: that element
  Vec3d by_voxels{2, 0.5, 0};
  std::optional<IndexBox> fixed;
  TomlKeys step;
  std::vector<TomlKeys> later_steps;
  TomlKeys view, transfer;
  bool has_slices = false;  // instead of a picture in space
  TomlKeys slice;

  double spring_step = 10;      // of the longest stable one of symplectic Euler
  int operations = 300;         // of a live session
  double least_covered = 0.02;  // of a picture: part of its pixels in which something is seen
  double most_covered = 1;

  Geometry geometry() const { return {dims, origin_lps_mm, axes_mm}; }
  Vec3d by_mm() const;  // along the grid axes
  bool is_fixed(const Vec3i& voxel) const { return fixed && fixed->contains(voxel); }
};

/// "[1, 2.5, 3]".
std::string toml_text(const Vec3d& v);
/// One value at all densities, as a curve.
std::string toml_curve(double value);
/// A curve between two densities.
std::string toml_curve(double density_a, double a, double density_b, double b);

/// Writes volume.nrrd and scene.toml, with pictures if `has_view`, into the folder; returns the
/// path of the latter. Throws SystemError, InputError for a geometry that there is none of.
std::string write_input(const StressInput& input, const std::string& folder, bool has_view);

}  // namespace supple::tools
