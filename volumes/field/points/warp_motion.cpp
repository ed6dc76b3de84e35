// Points through a dense warp, along its vectors and against them.
#include <array>
#include <unordered_map>

#include "volumes/base/parallel.h"
#include "volumes/field/dense/grid_positions.h"
#include "volumes/field/points/folded_places.h"
#include "volumes/field/points/point_motion.h"
#include "volumes/field/points/point_solver.h"
#include "volumes/grid/cell.h"

namespace supple {

namespace {

// Grid steps between the points that searches begin at, and how many of them a search tries.
constexpr int kSeedSpacing = 4;
constexpr std::size_t kSeedsTried = 12;
constexpr double kBorder = 0.5 + kNodeSnap;  // beyond the outer grid points, steps
constexpr double kLongest = 1e6;             // grid steps

/// The vectors as displacements in the index frame of the grid. For half a step around the outer
/// grid points they are the same, as in ITK.
class WarpCells {
 public:
  explicit WarpCells(const Warp& warp) : m_warp(warp), m_dims(warp.geometry.dims()) {}

  Vec3d vector(const Vec3i& p) const {
    const std::size_t row = std::size_t(p.z) * m_dims.y + p.y;
    return m_warp.geometry.index_vector_from_world(Vec3d(m_warp.vectors[row * m_dims.x + p.x]));
  }

  /// A cell of the grid, or one around it.
  bool cell(const Vec3i& voxel, TrilinearCell& cell) const {
    for (int a = 0; a < 3; ++a) {
      if (voxel[a] < -1 || voxel[a] >= m_dims[a]) return false;
    }
    for (int n = 0; n < 8; ++n) {
      Vec3i p = voxel + cell_corner(n);
      for (int a = 0; a < 3; ++a) p[a] = std::clamp(p[a], 0, m_dims[a] - 1);
      cell.u[n] = vector(p);
    }
    return true;
  }

  bool cell_at(const Vec3d& X, Vec3i& voxel, TrilinearCell& cell) const {
    for (int a = 0; a < 3; ++a) {
      if (!(X[a] >= -kBorder && X[a] <= m_dims[a] - 1 + kBorder)) return false;
      voxel[a] = std::min(int(std::floor(X[a])), m_dims[a] - 1);
    }
    return this->cell(voxel, cell);
  }

  bool is_within(const Vec3d& X) const {
    Vec3i voxel;
    TrilinearCell cell;
    return cell_at(X, voxel, cell);
  }

  const Geometry& geometry() const { return m_warp.geometry; }
  const Vec3i& dims() const { return m_dims; }

 private:
  const Warp& m_warp;
  Vec3i m_dims;
};

/// x -> x + v(x).
class AlongWarp final : public PointMotion {
 public:
  explicit AlongWarp(const Warp& warp) : m_cells(warp) {}

  MovedPoint move(const Vec3d& lps_mm) const override {
    const Geometry& geometry = m_cells.geometry();
    const Vec3d X = geometry.index_from_world(lps_mm);
    Vec3i voxel;
    TrilinearCell cell;
    if (!m_cells.cell_at(X, voxel, cell)) return {lps_mm, PlaceKind::outside};
    const CellPlace place = cell.at(X - Vec3d(voxel));
    return {lps_mm + geometry.world_vector_from_index(place.u),
            cell.is_folded() ? PlaceKind::folded : PlaceKind::inside,
            in_world(geometry, place.gradient())};
  }

 private:
  WarpCells m_cells;
};

/// Some grid points and the places they go to, for searches nearby to begin at.
class Seeds {
 public:
  explicit Seeds(const WarpCells& cells) {
    const Vec3i& dims = cells.dims();
    for (int z = 0; z < dims.z; z += kSeedSpacing) {
      for (int y = 0; y < dims.y; y += kSeedSpacing) {
        for (int x = 0; x < dims.x; x += kSeedSpacing) {
          const Vec3d at(x, y, z), image = at + cells.vector({x, y, z});
          if (is_near(image)) m_blocks[block_of(image)].push_back({image, at});
        }
      }
    }
  }

  /// Grid points whose images are nearest to x, nearest first.
  std::vector<Vec3d> around(const Vec3d& x) const {
    std::vector<std::pair<double, Vec3d>> found;
    if (!is_near(x)) return {};
    for (int ring = 1; ring <= 4 && found.size() < kSeedsTried; ring *= 2) {
      found.clear();
      for (int i = -ring; i <= ring; ++i) {
        for (int j = -ring; j <= ring; ++j) {
          for (int k = -ring; k <= ring; ++k) {
            const auto block = m_blocks.find(block_of(x) + Vec3i(i, j, k));
            if (block == m_blocks.end()) continue;
            for (const Seed& seed : block->second) {
              found.emplace_back((seed.image - x).length2(), seed.at);
            }
          }
        }
      }
    }
    const std::size_t count = std::min(found.size(), kSeedsTried);
    std::partial_sort(found.begin(), found.begin() + std::ptrdiff_t(count), found.end(),
                      [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<Vec3d> places;
    for (std::size_t n = 0; n < count; ++n) places.push_back(found[n].second);
    return places;
  }

 private:
  struct Seed {
    Vec3d image, at;
  };
  static bool is_near(const Vec3d& p) {
    return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) < 1e8;
  }
  static Vec3i block_of(const Vec3d& p) { return floor_voxel(p / double(kSeedSpacing)); }

  std::unordered_map<Vec3i, std::vector<Seed>, VoxelHash> m_blocks;
};

/// x with x + v(x) = X.
class AgainstWarp final : public PointMotion {
 public:
  explicit AgainstWarp(const Warp& warp) : m_cells(require_near(warp)), m_seeds(m_cells) {
    find_folds();
  }

  MovedPoint move(const Vec3d& lps_mm) const override {
    const Geometry& geometry = m_cells.geometry();
    const Vec3d from = geometry.index_from_world(lps_mm);
    Vec3d to;
    if (!solve(from, to)) {
      return {lps_mm, m_cells.is_within(from) ? PlaceKind::unresolved : PlaceKind::outside};
    }
    MovedPoint moved{lps_mm + geometry.world_vector_from_index(to - from),
                     m_folds.contains(from) ? PlaceKind::folded : PlaceKind::inside};
    Vec3i voxel;
    TrilinearCell cell;
    Columns inverse;
    if (m_cells.cell_at(to, voxel, cell) &&
        invert(cell.at(to - Vec3d(voxel)).gradient(), inverse)) {
      moved.gradient = in_world(geometry, inverse);
    }
    return moved;
  }

 private:
  static const Warp& require_near(const Warp& warp) {
    for (std::size_t n = 0; n < warp.vectors.size(); ++n) {
      const Vec3f v = warp.vectors[n];
      const Vec3d u = warp.geometry.index_vector_from_world(Vec3d(v));
      if (std::max({std::abs(u.x), std::abs(u.y), std::abs(u.z)}) <= kLongest) continue;
      throw InputError({warp.path, "vectors", "one of " + number_text(Vec3d(v).length()) + " mm",
                        "at most 10^6 grid steps along each axis"});
    }
    return warp;
  }

  void find_folds() {
    const Vec3i& dims = m_cells.dims();
    PerThread<std::vector<std::pair<Vec3i, CellCorners>>> found;
    parallel_for(-1, dims.z, [&](int z) {
      for (int y = -1; y < dims.y; ++y) {
        for (int x = -1; x < dims.x; ++x) {
          TrilinearCell cell;
          const Vec3i voxel(x, y, z);
          if (m_cells.cell(voxel, cell) && cell.is_folded()) {
            found.local().emplace_back(voxel, cell.corners());
          }
        }
      }
    });
    for (const auto& cells : found) {
      for (const auto& [cell, corners] : cells) m_folds.add(cell, corners);
    }
  }

  /// One solution is enough where nothing folds.
  bool solve(const Vec3d& x, Vec3d& X) const {
    const PointSolver solver(m_cells);
    const bool in_fold = m_folds.contains(x);
    bool is_solved = false;
    const auto try_from = [&](const Vec3d& start) {
      Vec3d found;
      if (!solver.solve(x, start, found) || !m_cells.is_within(found)) return false;
      if (is_solved && (found - x).length2() >= (X - x).length2()) return false;
      X = found;
      is_solved = true;
      return true;
    };
    if (try_from(x) && !in_fold) return true;
    for (const Vec3d& start : m_seeds.around(x)) {
      if (try_from(start) && !in_fold) return true;
    }
    return is_solved;
  }

  WarpCells m_cells;
  Seeds m_seeds;
  FoldedPlaces m_folds;
};

}  // namespace

std::unique_ptr<PointMotion> motion_through(const Warp& warp, bool back) {
  const bool is_material = warp.direction == WarpDirection::material;
  if (is_material != back) return std::make_unique<AlongWarp>(warp);
  return std::make_unique<AgainstWarp>(warp);
}

}  // namespace supple
