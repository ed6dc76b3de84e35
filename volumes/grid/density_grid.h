// A sparse density grid: an openvdb::FloatGrid in index space behind a light face. Files that
// create or edit the grid include "volumes/grid/density_grid_vdb.h"; all others see bricks.
// Cost: 2.1 kB per occupied brick; nothing for empty space. A Volume is such a grid as it was
// scanned, with its geometry and the statistics of its reading.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "volumes/geometry/geometry.h"
#include "volumes/grid/brick_topology.h"

namespace supple {

class DensityLeaf;

/// How densities between the voxels are read. `linear`: trilinear, through every voxel's density.
/// `cubic`: the tricubic B-spline whose coefficients are the densities themselves. It has
/// continuous second derivatives and never leaves the range of the 4^3 voxels around, so that it
/// rings nowhere. It smooths: a quadratic comes out a third of its second derivative's half higher
/// (x^2 as x^2 + 1/3), linear densities are kept. `interpolating`: the one through every voxel's
/// density, as smooth; thin walls stay, and beside sharp edges it overshoots, which may show as
/// shells around bone (volumes/grid/b_spline.h).
enum class Interpolation { linear, cubic, interpolating };

class DensityGrid {
 public:
  struct Vdb;  // holds the openvdb::FloatGrid

  /// Empty grid with background 0.
  DensityGrid();
  /// Takes a grid whose active voxels all lie in leaves (no active tiles).
  explicit DensityGrid(std::shared_ptr<const Vdb> vdb);

  /// Active voxels of the grid.
  const BrickTopology& bricks() const { return m_bricks; }
  /// The 512 densities of brick b in brick order; inactive ones hold background().
  const float* values(std::size_t b) const { return (*m_values)[b]; }
  /// Extremes of the active densities of every brick; null in grids from files of OpenVDB, whose
  /// densities nobody looked at.
  const BrickExtremes* extremes() const {
    return m_extremes == nullptr ? nullptr : m_extremes->data();
  }
  /// Value of inactive voxels.
  float background() const { return m_background; }
  /// Density of one voxel, background() where inactive.
  float at(const Vec3i& voxel) const;

  /// Memory of the tree and of the brick table.
  std::size_t bytes() const;
  const Vdb& vdb() const { return *m_vdb; }

 private:
  friend DensityGrid assemble_density_grid(BrickTopology bricks,
                                           const std::function<DensityLeaf(std::size_t b)>& take,
                                           float background);
  /// Wraps a grid whose bricks are known, with their densities and extremes.
  DensityGrid(std::shared_ptr<const Vdb> vdb, BrickTopology bricks,
              std::vector<const float*> values, std::vector<BrickExtremes> extremes);

  std::shared_ptr<const Vdb> m_vdb;
  BrickTopology m_bricks;
  std::shared_ptr<const std::vector<const float*>> m_values;
  std::shared_ptr<const std::vector<BrickExtremes>> m_extremes;  // null: unknown
  float m_background = 0;
};

/// Builds a grid from bricks; `values[512 * b + offset]` as in BrickTopology order.
DensityGrid make_density_grid(const BrickTopology& bricks, const std::vector<float>& values,
                              float background);
/// The same with `fill(b, out)` asked for the 512 values of every brick, once each and from several
/// threads: for callers that do not hold all values at once.
DensityGrid fill_density_grid(const BrickTopology& bricks,
                              const std::function<void(std::size_t b, float* out)>& fill,
                              float background);

/// The bytes() of a grid with these bricks, without building it.
std::size_t density_grid_bytes(const BrickTopology& bricks);

/// The same densities on fewer voxels: those that are active in `keep`.
DensityGrid restrict_to(const DensityGrid& grid, const BrickTopology& keep);

/// Face-connected pieces of the active voxels, largest first (ties: smallest first voxel in brick
/// order); at most `count` of them are kept.
BrickTopology largest_components(const BrickTopology& topology, int count);
/// The face-connected piece that holds the voxel; empty where the voxel is not active.
BrickTopology component_at(const BrickTopology& topology, const Vec3i& voxel);

/// Facts about a file's values, gathered in the one pass that reads them.
struct VolumeStatistics {
  double min = 0;  // after slope and intercept, NaN left out
  double max = 0;
  double mean = 0;
  std::int64_t nan_count = 0;
  std::int64_t infinite_count = 0;   // values that overflow a float included
  std::int64_t above_min_count = 0;  // voxels with a value > min
};

/// True if densities that reach down to `lowest` are Hounsfield units: air lies at -1000 HU.
inline bool are_hounsfield_units(double lowest) {
  return lowest < -200;
}

/// "3 NaN voxels and 1 infinite voxel"; empty where there are neither. They are void.
std::string void_values_text(const VolumeStatistics& statistics);

struct Volume {
  Geometry geometry;
  DensityGrid density;          // index space, active voxels as asked for when loading
  VolumeStatistics statistics;  // of the whole file
  std::string format;           // "nrrd", "metaimage", "nifti", "png", "tiff", "raw", "vdb"
  std::string value_type;  // numpy name: the stored type, float32 when slope or intercept apply
};

/// Trilinear density at an index-space position; corners that are inactive count as `outside`.
float sample_trilinear(const DensityGrid& grid, const Vec3d& pos_index, float outside);

}  // namespace supple
