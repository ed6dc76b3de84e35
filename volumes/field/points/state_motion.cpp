// Points along with a body and back.

#include "volumes/base/parallel.h"
#include "volumes/field/inversion/source_cells.h"
#include "volumes/field/points/carried_displacement.h"
#include "volumes/field/points/folded_places.h"
#include "volumes/field/points/point_motion.h"
#include "volumes/field/points/point_solver.h"
#include "volumes/field/split_offsets.h"
#include "volumes/grid/cell.h"

namespace supple {

namespace {

constexpr double kFarthest = 1e7;  // voxels

PlaceKind kind_of(const CarriedDisplacement::Place& place) {
  if (place.is_torn) return PlaceKind::torn;
  if (place.is_folded) return PlaceKind::folded;
  return place.is_known ? PlaceKind::inside : PlaceKind::outside;
}

class MotionAlong final : public PointMotion {
 public:
  MotionAlong(const Displacement& displacement, const CutElements& body)
      : m_geometry(displacement.geometry), m_u(displacement, body) {}

  MovedPoint move(const Vec3d& lps_mm) const override {
    const CarriedDisplacement::Place place = m_u.at(m_geometry.index_from_world(lps_mm));
    return {lps_mm + m_geometry.world_vector_from_index(place.u), kind_of(place),
            in_world(m_geometry, place.gradient())};
  }

 private:
  Geometry m_geometry;
  CarriedDisplacement m_u;
};

class MotionToRest final : public PointMotion {
 public:
  MotionToRest(const Displacement& displacement, const CutElements& body,
               const OffsetField& offsets)
      : m_geometry(displacement.geometry),
        m_u(displacement, body),
        m_elements(body.elements),
        m_offsets(offsets),
        m_start(offsets.o) {
    find_folds();
  }

  MovedPoint move(const Vec3d& lps_mm) const override {
    const Vec3d x = m_geometry.index_from_world(lps_mm);
    Found found = find(x);
    if (found.kind == PlaceKind::inside && m_folds.contains(x)) found.kind = PlaceKind::folded;
    MovedPoint moved{lps_mm + m_geometry.world_vector_from_index(found.offset), found.kind};
    Columns inverse;
    if (invert(found.gradient, inverse)) moved.gradient = in_world(m_geometry, inverse);
    return moved;
  }

 private:
  struct Found {
    Vec3d offset;
    PlaceKind kind;
    Columns gradient;  // of X -> X + u
  };

  /// Finds the folds of all cells of the body, of torn cells each side by itself, and overlaps.
  void find_folds() {
    const VectorBricks& u = m_u.known();
    PerThread<std::vector<std::pair<Vec3i, CellCorners>>> found;
    parallel_for(u.topology.brick_count(), [&](std::size_t b) {
      SourceCells cells;
      if (!gather_cells(u, b, cells)) return;
      for_each_active(cells.mask, [&](int offset) {
        Vec3f shift;
        if (is_translated(cells, offset, shift)) return;
        const CellCorners corners = cell_corners(cells, offset);
        const Vec3i cell = cells.origin + brick_local(offset);
        if (!is_folded(corners) || m_u.is_in_torn_cell(Vec3d(cell))) return;
        found.local().emplace_back(cell, corners);
      });
    });
    for (const auto& cells : found) {
      for (const auto& [cell, corners] : cells) m_folds.add(cell, corners);
    }
    m_u.for_torn_sides([&](const CutPiece& side) {
      if (side.is_folded) m_folds.add(side.cell, side.corners());
    });
    const BrickTopology& overlaps = m_offsets.overlaps;
    for (std::size_t b = 0; b < overlaps.brick_count(); ++b) {
      for_each_active(overlaps.mask(b),
                      [&](int offset) { m_folds.add(overlaps.origin(b) + brick_local(offset)); });
    }
  }

  Found found_at(const Vec3d& X, const Vec3d& offset) const {
    const CarriedDisplacement::Place place = m_u.at(X);
    return {offset, kind_of(place), place.gradient()};
  }

  Found find(const Vec3d& x) const {
    Vec3d offset;
    if (!is_near(x)) return {-m_u.stretched(x).u, PlaceKind::outside, identity_columns()};
    Vec3d X;
    bool is_overlapped = false;
    if (in_split_brick(x) && m_offsets.split->place_at(x, X, is_overlapped)) {
      Found found = found_at(X, X - x);
      if (is_overlapped) found.kind = PlaceKind::folded;
      return found;
    }
    is_overlapped = false;
    if (!solve(x, X, is_overlapped)) {
      offset = m_start.sample(x);
      return {offset, PlaceKind::unresolved, identity_columns()};
    }
    Found found{X - x, PlaceKind::torn, m_u.stretched(X).gradient()};
    if (!m_u.is_in_torn_cell(X)) found = found_at(X, found.offset);
    if (is_overlapped) found.kind = PlaceKind::folded;
    return found;
  }

  /// True if a place is not so far away that the displacement is constant.
  static bool is_near(const Vec3d& x) {
    return std::max({std::abs(x.x), std::abs(x.y), std::abs(x.z)}) < kFarthest;
  }

  bool in_split_brick(const Vec3d& x) const {
    if (m_offsets.split == nullptr) return false;
    const Vec3i voxel(int(std::floor(x.x)), int(std::floor(x.y)), int(std::floor(x.z)));
    return m_offsets.split->bricks().find(voxel) >= 0;
  }

  /// True if the voxel nearest to X is an element.
  bool is_tissue(const Vec3d& X) const {
    Vec3i voxel = floor_voxel(X + Vec3d(0.5));
    for (int a = 0; a < 3; ++a) {
      if (m_geometry.dims()[a] == 1) voxel[a] = 0;
    }
    return m_elements.is_active(voxel);
  }

  /// True if the offsets at the nodes around x differ by more than a voxel. What lies between such
  /// nodes may have come from several places, though none of the nodes has.
  bool is_at_jump(const Vec3d& x) const {
    const Vec3i low = floor_voxel(x);
    Vec3f lo(HUGE_VALF), hi(-HUGE_VALF), offset;
    for (int n = 0; n < kCellCorners; ++n) {
      if (!m_offsets.o.at(low + cell_corner(n), offset)) continue;
      for (int a = 0; a < 3; ++a) {
        lo[a] = std::min(lo[a], offset[a]);
        hi[a] = std::max(hi[a], offset[a]);
      }
    }
    return lo.x <= hi.x && (hi - lo).length() > 1;
  }

  /// Finds, of the solutions that the offsets around lead to, one in tissue before one in air, then
  /// that with the shortest way; one in tissue is enough where there are no folds. `is_overlapped`:
  /// set where several are in tissue.
  bool solve(const Vec3d& x, Vec3d& X, bool& is_overlapped) const {
    const PointSolver solver(m_u);
    const bool in_fold = m_folds.contains(x) || is_at_jump(x);
    bool is_solved = false, in_tissue = false;
    const auto try_from = [&](const Vec3d& start) {
      Vec3d found;
      if (!solver.solve(x, start, found)) return;
      const bool is_better = is_tissue(found);
      if (in_tissue && !is_better) return;
      is_overlapped = is_overlapped || (in_tissue && (found - X).length() > kSamePlace);
      if (is_solved && in_tissue == is_better && (found - x).length2() >= (X - x).length2()) {
        return;
      }
      X = found;
      is_solved = true;
      in_tissue = is_better;
    };
    try_from(x + m_start.sample(x));
    const Vec3d low(floor_voxel(x));
    for (int n = 0; n < 8 && (in_fold || !in_tissue); ++n) {
      const Vec3d start = x + m_start.sample(low + Vec3d(cell_corner(n)));
      if (in_fold || !is_solved || is_tissue(start)) try_from(start);
    }
    if (!is_solved) try_from(x);
    if (!is_solved) try_from(x - m_u.stretched(x).u);
    return is_solved;
  }

  Geometry m_geometry;
  CarriedDisplacement m_u;
  const BrickTopology& m_elements;
  const OffsetField& m_offsets;
  SmoothExtension m_start;
  FoldedPlaces m_folds;
};

}  // namespace

std::unique_ptr<PointMotion> motion_along(const Displacement& displacement,
                                          const CutElements& body) {
  return std::make_unique<MotionAlong>(displacement, body);
}

std::unique_ptr<PointMotion> motion_to_rest(const Displacement& displacement,
                                            const CutElements& body, const OffsetField& offsets) {
  return std::make_unique<MotionToRest>(displacement, body, offsets);
}

}  // namespace supple
