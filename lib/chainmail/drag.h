// Handles that drags of Enhanced ChainMail move, and the reports of drags: by box limits (ecm.h),
// by ball limits (ball_limits.h), and tightened (tighten.h).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "lib/body/region.h"

namespace supple {

/// A two-sided handle takes its elements along whichever way it goes. A push handle is a tool that
/// does not stick: in a coordinate with by > 0 its elements end at least that far, with by < 0 at
/// most, and by = 0 asks for nothing. Held through later drags it keeps its side: it pushes on from
/// where it is, and withdrawing it leaves the tissue where it was pushed to.
enum class HandleKind { two_sided, push };

/// Images of steps of one voxel along the axes of the grid, in voxels.
using GridSteps = std::array<Vec3d, 3>;
inline const GridSteps kUnitSteps{Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 1)};

/// A motion that turns or scales, as elements feel it that have no neighbour to show it: the images
/// of steps between places where it starts.
struct StepMotion {
  GridSteps before = kUnitSteps, after = kUnitSteps;  // up to where the drag begins, and ends
  /// Offsets of the elements where the motion starts; empty: where they are now.
  std::vector<std::array<std::int32_t, 3>> start_q = {};
};

/// A grabbed region and how far its elements move from where they are now, per grid axis in 2^-16
/// voxel: all as one, or each by itself.
struct Handle {
  Handle(const Vec3i& grabbed, const std::array<std::int32_t, 3>& by,
         HandleKind how = HandleKind::two_sided)
      : region(grabbed), by_q(by), kind(how) {}
  Handle(Region grabbed, const std::array<std::int32_t, 3>& by,
         HandleKind how = HandleKind::two_sided)
      : region(std::move(grabbed)), by_q(by), kind(how) {}

  Region region;
  std::array<std::int32_t, 3> by_q;
  HandleKind kind = HandleKind::two_sided;
  /// Displacements of the single elements in place of by_q, in the order of the slots of
  /// elements_of(region); empty: all move by by_q. A part of the drag is that part of each
  /// displacement, so targets stay on straight lines and not on arcs: limits that hold at both ends
  /// of a line hold all along it.
  std::vector<std::array<std::int32_t, 3>> each_by_q = {};
  /// The soft edge of the handle before it, with which reports count it. An edge that pushes only
  /// asks for its displacements: each element goes as far as anchors let it, and shortens the drag
  /// of no other.
  bool is_edge = false;
  /// Motion behind `each_by_q`, of a handle that has it; absent: offsets alone are known. A part
  /// of the drag is that part of `after` - `before`.
  std::optional<StepMotion> steps = {};
};

/// Displacement in mm along the grid axes i, j, k, rounded to the nearest fixed-point number.
/// Throws InputError when not finite or beyond the range of +-16383 voxels.
std::array<std::int32_t, 3> fixed_from_mm(const Vec3d& by_mm, const Vec3d& spacing_mm);

/// A free rigid piece (in Body::rigid) that a drag shifts.
struct PieceShift {
  std::size_t piece;
  std::array<std::int32_t, 3> by_q;
};

/// automatic: flat where bricks hold fewer than 24 elements on average (chains, wires, dust);
/// sheets one voxel thick fill 64 of 512 lanes and still gain from bricks, as axes without links
/// are skipped.
enum class Engine { automatic, block, flat };
const char* name_of(Engine engine);

struct EcmReport {
  /// Part of the drag that anchors allow, kept rational; 1/1 when nothing stops it.
  std::int64_t fraction_numerator = 1;
  std::int64_t fraction_denominator = 1;
  std::int64_t moved = 0;  // elements whose offset changed
  std::vector<PieceShift> shifted = {};
  std::int64_t projected_links = 0;  // links of an invalid start that were wrong
  double projected_max_voxels = 0;   // largest move of the projection
  std::int64_t projected_held = 0;   // elements that are held but that it had to move
  Engine engine = Engine::flat;      // that solved it
  std::int64_t visited = 0;          // bricks (block engine) or nodes, all coordinates
  std::int64_t max_queue = 0;        // that waited at one time
  double milliseconds = 0;

  double fraction() const { return double(fraction_numerator) / double(fraction_denominator); }
};

/// first_moved_first is the original ChainMail's order, there to show how much the order matters.
enum class BallOrder { largest_violation_first, first_moved_first };

struct BallParams {
  /// Excess over its limits, in rest lengths, that a link may keep.
  double tolerance = 1e-3;
  /// The drag ends after this many moves per element that moved, on average over them.
  int moves_per_element = 100;
  BallOrder order = BallOrder::largest_violation_first;

  /// Throws InputError: tolerance outside 1e-4 ... 1, no moves.
  void validate() const;
};

struct BallReport {
  std::int64_t moves = 0;          // of candidates, repeated ones included
  std::int64_t moved = 0;          // elements whose offset changed
  bool capped = false;             // moves_per_element ended it
  std::int64_t links = 0;          // that end at an element that moved
  std::int64_t violated = 0;       // of these, beyond the tolerance
  double worst_excess_voxels = 0;  // of these, in rest lengths of the link
  std::int64_t max_queue = 0;      // links that waited at one time
  std::size_t bytes = 0;           // working memory
  double milliseconds = 0;
};

struct TightenParams {
  int iterations = 20;  // at most
  /// Excess over its tightened limits, in rest lengths, beyond which a link counts as violated.
  double tolerance = 1e-3;

  /// Throws InputError: iterations outside 0 ... 1000, tolerance outside 1e-4 ... 1.
  void validate() const;
};

struct TightenReport {
  std::int64_t projected_links = 0;  // of an invalid start
  double projected_max_voxels = 0;
  std::int64_t projected_held = 0;  // elements that are held but that it had to move
  int iterations = 0;               // that were kept
  bool settled = false;             // no excess is left, or another iteration would not lower it
  std::int64_t moved = 0;           // elements whose offset changed
  /// Links whose limits the result tightens, and those of them that miss these by more than the
  /// tolerance, in rest lengths of the link.
  std::int64_t links = 0, violated = 0;
  double worst_excess_voxels = 0;
  /// Length that all links miss together, as the root of the sum of squares, in the start and the
  /// result.
  double excess_before_voxels = 0, excess_voxels = 0;
  double milliseconds = 0;
};

}  // namespace supple
