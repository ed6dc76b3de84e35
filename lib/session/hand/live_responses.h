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
// their plane or ring. Further directions may come at any time: they are brought to the level of
// the others, then all go on together. All have the same bits whenever they came.
//
// Memory: of the best level, and of what poses still have, 12 bytes per element and direction;
// while one is found, 12 of the one before it, what solvers take (32 bytes per unknown and
// direction), and 16 bytes per unknown and direction.
#pragma once

#include <array>
#include <atomic>
#include <limits>
#include <memory>
#include <mutex>
#include <vector>

#include "lib/session/hand/piece_moments.h"
#include "lib/session/kept_voxels.h"
#include "lib/session/session_body.h"

namespace supple {

class LevelSolver;

/// No body has more levels.
constexpr int kAllLevels = 8;

/// The best responses so far.
struct LiveLevel;

/// A target of the hand in the responses of a level, which it keeps.
struct LivePose {
  std::shared_ptr<const LiveLevel> of;
  int level = -1;      // number of the better ones that came before it; -1: none is there yet
  int doublings = -1;  // elements of 2^doublings voxels, the largest of all directions
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

  /// Takes a further direction, from the thread that made this; run() finds it, too, or another one
  /// does after it. Throws InputError as such a step does.
  void add(const SessionBody& in, const Step& grab, DragPose direction);
  /// True where a direction waits for a run().
  bool has_asked() const { return m_has_asked; }

  /// Finds all levels, or until so many are ready. `ahead`: the solid, where somebody has made it;
  /// null: not. Throws NotConverged, Cancelled: what is there stays.
  void run(Progress* progress, std::shared_ptr<KeptVoxels> ahead = nullptr,
           int levels = std::numeric_limits<int>::max());

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
  struct Direction;
  using Affine = std::array<double, 12>;  // shift, and linear map in rows, about m_about_mm
  Affine affine_of(const DragPose& pose) const;
  void make_solid(const FemTask& task, std::shared_ptr<KeptVoxels> ahead, Progress* progress);
  void take_asked(const FemTask& task, Progress* progress);
  std::vector<NodalLoads> loads(const std::vector<std::vector<Handle>>& handles,
                                const FemTask& task, Progress* progress);
  bool solve_level(int number, const FemParams& params, Progress* progress);
  void publish(int number);
  void keep();

  Body m_body;
  PieceFits m_fits;
  DensityGrid m_density;
  BrickValues m_labels;
  LinkCuts m_cuts;
  std::vector<Region> m_anchors;
  Holds m_holds;
  FemStep m_step;
  std::shared_ptr<KeptVoxels> m_voxels;  // of the session, or null
  std::vector<PieceMotion> m_pieces;
  Vec3d m_about_mm{0, 0, 0};  // the middle of the handle
  double m_radius_mm = 0;
  std::vector<bool> m_is_handle;  // per held set of loads
  std::unique_ptr<LevelSolver> m_solver;
  std::vector<std::unique_ptr<Direction>> m_found;  // where the handle is, then each direction
  std::shared_ptr<FemResponses> m_kept;
  std::atomic<bool> m_has_asked{false};
  mutable std::mutex m_mutex;                // for all below
  std::vector<std::vector<Handle>> m_asked;  // that run() has not taken, in the order of m_ways
  std::vector<Affine> m_ways;                // of directions
  std::shared_ptr<const LiveLevel> m_best;
  int m_ready = 0;
  std::shared_ptr<const FemResponses> m_all;  // once all directions have their last level
};

}  // namespace supple
