// Motion of points: along with the material, back to rest, or through a warp. For landmarks, meshes
// and other data that lie between voxels.
//
// Each point is solved for by itself, so that there and back again is the same place off folds: by
// Newton on the trilinear field, and where kinks hold it up by the cells around (deformed_cell.h).
#pragma once

#include <memory>

#include "volumes/field/columns.h"
#include "volumes/field/cuts/cut_offsets.h"
#include "volumes/field/dense/warp.h"

namespace supple {

/// Kind of a place, which says how its motion was found.
enum class PlaceKind {
  inside,     // in the material or the shell around it; in the grid of a warp
  outside,    // beyond: the motion carries on smoothly there; beyond the grid of a warp it ends
  folded,     // in a fold: several places have come here; the one with the shortest way counts
  torn,       // on or in an open cut, on no side of it: moves as the nearest side or the stretch
  unresolved  // nothing was found; the place is a guess
};

struct MovedPoint {
  Vec3d to_lps_mm;
  PlaceKind kind = PlaceKind::inside;
  Columns gradient = identity_columns();  // d to / d from, LPS
};

/// A motion of points, which several threads may ask at once.
class PointMotion {
 public:
  virtual ~PointMotion() = default;
  virtual MovedPoint move(const Vec3d& lps_mm) const = 0;
};

/// X -> X + u(X). `displacement`: extended as for invert_cut(). Beside an open cut a point goes
/// with its own side. Cost: that of a CarriedDisplacement.
std::unique_ptr<PointMotion> motion_along(const Displacement& displacement,
                                          const CutElements& body);

/// x -> X with X + u(X) = x to within 1e-5 voxel, beside open cuts 1e-4. `offsets`: those of
/// invert_cut(), where the search begins; they and the elements must outlive the motion. Tissue
/// goes before the air around it, and places at which tissue from several places lies are `folded`.
/// Cost: as above and a SmoothExtension of the offsets; 1 to 3 µs per point.
std::unique_ptr<PointMotion> motion_to_rest(const Displacement& displacement,
                                            const CutElements& body, const OffsetField& offsets);

/// Through a warp, which must outlive the motion: along the vectors of a material-direction one,
/// against those of a resample-direction one; `back`: the other way. A warp that does not record
/// its direction counts as resample. Points more than half a step beyond its outer grid points stay
/// where they are, as in ITK. Cost:
/// against the vectors 2 bytes per grid point and 3 µs per point. Throws InputError where it has to
/// run against vectors of more than 10^6 grid steps, or against cells torn over 2^24 voxels.
std::unique_ptr<PointMotion> motion_through(const Warp& warp, bool back);

}  // namespace supple
