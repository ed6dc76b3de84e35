// Finite elements under the hand: the responses of a handle, found in the background level by
// level, and the pose of the body for any target of the hand as a sum of them.
//
// It is made by the thread of the session when something is grabbed; run() belongs to another
// thread, until it is done or cancelled. At any time and from any thread pose() tells what a target
// of the hand makes of the best level so far, and displacements() of it the elements that a picture
// needs.
//
// Levels are elements of 8 and 4 voxels, then of 1 after 2, 3, 5, 10 and 21 iterations and at the
// end, each started from the one before. Then found() has the solutions of the last level, for the
// step that the hand ends with. A direction is a target of the handle, such as a shift along each
// axis of a view, or turns by 90 and 180 degrees about the axis of a ring: two span all targets of
// their plane or ring.
//
// Memory: of the best level, and of what poses still have, 12 bytes per element and direction;
// while one is found, 12 of the one before it, what solvers take (44 bytes per unknown and
// direction), and 16 bytes per unknown and direction.
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <mutex>
#include <vector>

#include "lib/session/hand/piece_moments.h"
#include "lib/session/kept_voxels.h"
#include "lib/session/session_body.h"

namespace supple {

/// No body has more levels.
constexpr int kAllLevels = 8;

/// Responses of one level.
struct LiveLevel;

/// A target of the hand in the responses of a level, which it keeps.
struct LivePose {
  std::shared_ptr<const LiveLevel> of;
  int level = -1;      // of those that are there, from 0; -1: none is yet
  int doublings = -1;  // elements of 2^doublings voxels
  /// 95th percentile of the displacement's error beside elements of one voxel, where a direction
  /// moves the body by a twentieth of its largest displacement at least; estimated from the change
  /// since the level before, infinite at the first level, 0 at the last.
  double error_mm = std::numeric_limits<double>::infinity();
  double beyond_mm = 0;       // of the handle's motion, in the mean, that no direction has
  std::vector<double> parts;  // one per direction
};

class LiveResponses {
 public:
  /// `grab`: a step on the grid with finite elements and one drag that moves nothing yet; its
  /// motion, and those of `directions`, count from here on. Copies what it needs of the body: `in`
  /// may go on. Throws InputError as such a step does, and where why_no_sum() has a reason.
  LiveResponses(const SessionBody& in, const Step& grab, std::vector<DragPose> directions);
  ~LiveResponses();

  /// Finds all levels, or the first ones. `ahead`: the solid, where somebody has made it; null:
  /// not. Throws NotConverged, Cancelled: what is there stays.
  void run(Progress* progress, std::shared_ptr<KeptVoxels> ahead = nullptr,
           int levels = kAllLevels);

  std::size_t elements() const { return std::size_t(m_body.elements.active_count()); }
  /// The number of levels that are there, and whether the last one is.
  int ready() const;
  bool is_done() const { return found() != nullptr; }
  LivePose pose(const DragPose& target) const;
  /// Displacements from rest of the elements `begin` to `end`, in the order of the bricks, in mm,
  /// LPS. `pose` must have a level.
  void displacements(const LivePose& pose, std::size_t begin, std::size_t end, Vec3f* out) const;
  /// The force with which the body pulls at the handle, in N, LPS.
  Vec3d force_n(const LivePose& pose) const;
  /// Poses of all rigid pieces, the nearest to where their elements go.
  std::vector<RigidPose> piece_poses(const LivePose& pose) const;

  /// The solutions of the last level, once run() is done; null before.
  std::shared_ptr<const FemResponses> found() const;
  std::size_t bytes() const;

 private:
  using Affine = std::array<double, 12>;  // shift, and linear map in rows, about m_about_mm
  Affine affine_of(const DragPose& pose) const;
  std::vector<NodalLoads> loads(const VoxelFemModel& model, const FemTask& task,
                                Progress* progress);
  std::shared_ptr<LiveLevel> level_of(const VoxelFemModel& model,
                                      const std::vector<NodalLoads>& loads,
                                      const std::vector<NodalSolution>& solutions,
                                      const LiveLevel* before) const;
  void publish(std::shared_ptr<const LiveLevel> level);
  void keep(const std::vector<NodalLoads>& loads, std::vector<NodalSolution> solutions);

  Body m_body;
  PieceFits m_fits;
  DensityGrid m_density;
  BrickValues m_labels;
  LinkCuts m_cuts;
  std::vector<Region> m_anchors;
  Holds m_holds;
  FemStep m_step;
  std::shared_ptr<KeptVoxels> m_voxels;        // of the session, or null
  std::vector<std::vector<Handle>> m_handles;  // where it is, and of each direction
  std::vector<PieceMotion> m_pieces;
  Vec3d m_about_mm{0, 0, 0};  // the middle of the handle
  double m_radius_mm = 0;
  std::vector<Affine> m_directions;  // as m_handles
  std::vector<bool> m_is_handle;     // per held set of loads
  mutable std::mutex m_mutex;
  std::shared_ptr<const LiveLevel> m_best;
  int m_ready = 0;
  std::shared_ptr<const FemResponses> m_found;
};

}  // namespace supple
