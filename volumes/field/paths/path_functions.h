// The functions of sampling paths: bend, twist and taper after Barr ([Bar84], thesis eq. 3.21),
// cut open and explode (thesis section 3.3.5), free-form deformation with a lattice of Bernstein
// polynomials ([SP86], thesis section 3.3.1). Positions and vectors in LPS mm; parameters are those
// of the deformation that one sees.
//
// Each function throws InputError, naming the parameter, for values that are not finite, vectors of
// length 0 and whatever is said below, and returns null where nothing moves.
#pragma once

#include <array>
#include <string>

#include "volumes/field/paths/sampling_path.h"
#include "volumes/geometry/geometry.h"

namespace supple {

/// A stretch of an axis: mm along `axis` from `point`.
struct AxisRange {
  Vec3d point{0, 0, 0};
  Vec3d axis{0, 0, 1};
  double begin_mm = 0, end_mm = 0;  // begin < end
};

/// The body before the range stays. From there on the axis becomes an arc towards a direction
/// across it, and the body beyond goes on straight. The axis keeps its length. Within half a turn;
/// material beyond the arc's centre is refused when it comes to be bent.
struct BendParams {
  AxisRange range;
  Vec3d towards{0, 1, 0};  // its part across the axis counts
  double angle_degrees = 0;
};
std::shared_ptr<const PathFunction> make_bend(const BendParams& params);

/// Turns about the axis, right-handed, by an angle that grows along the range.
struct TwistParams {
  AxisRange range;
  double angle_degrees = 0;
};
std::shared_ptr<const PathFunction> make_twist(const TwistParams& params);

/// Scales across the axis by a factor that goes from 1 to `factor` (0.01 … 100) along the range.
struct TaperParams {
  AxisRange range;
  double factor = 1;
};
std::shared_ptr<const PathFunction> make_taper(const TaperParams& params);

/// Two halves move apart from a plane: by a gap along its normal, or turning about a hinge in the
/// plane, each by half of the angle (at most 180 degrees), so that they open where `point` is.
struct CutOpenParams {
  Vec3d point{0, 0, 0};
  Vec3d normal{1, 0, 0};
  double gap_mm = 0;
  double angle_degrees = 0;
  Vec3d hinge{0, 0, 0};  // a point of the hinge; across the plane it counts as in it
  Vec3d hinge_axis{0, 0, 1};
};
std::shared_ptr<const PathFunction> make_cut_open(const CutOpenParams& params);

/// The box (index space, its corners in any order) falls into a grid of equal pieces, at most 4096,
/// that move apart along the grid axes until there is a gap between neighbours. The middle stays;
/// the outermost pieces include the body beyond the box.
struct ExplodeParams {
  std::array<int, 3> grid = {1, 1, 1};
  Vec3d corner_index{0, 0, 0}, opposite_index{0, 0, 0};
  double gap_mm = 0;
};
std::shared_ptr<const PathFunction> make_explode(const ExplodeParams& params,
                                                 const Geometry& geometry);

/// A block of control points over a box (index space), 2 … 10 along each axis. Some of them move
/// and the material inside follows: X + sum B_i(r) B_j(s) B_k(t) d_ijk with Bernstein polynomials
/// of the box's coordinates. Beyond the box the material moves as the nearest place of its faces
/// does, so that there is no jump. A lattice that folds the material is refused.
struct LatticeParams {
  struct Move {
    std::string place;  // for errors
    std::array<int, 3> point;
    Vec3d by_mm;
  };
  std::array<int, 3> points = {2, 2, 2};
  Vec3d corner_index{0, 0, 0}, opposite_index{0, 0, 0};
  std::vector<Move> moves;  // of one point several add up
};
std::shared_ptr<const PathFunction> make_lattice(const LatticeParams& params,
                                                 const Geometry& geometry);

/// The range of an axis through a point that a box of voxels spans, outer faces included.
void span_box(const Geometry& geometry, AxisRange& range);

}  // namespace supple
