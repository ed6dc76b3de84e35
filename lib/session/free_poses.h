// Free rigid pieces of a drag: where handles and anchors move them through tissue, each goes to the
// smallest motion of six unknowns (lib/body/smallest_motion.h) that the limits of links allow.
//
// While all else of the drag stands, the limits are bounds of single elements
// (EcmSolver::bounds_of), and tissue between two places of the same piece; poses that these forbid
// are brought back toward the shift that Enhanced ChainMail found, which is always possible.
// Several pieces take turns, each among the others where they are; what else is held bounds them in
// all turns alike, and is found once (piece_bounds.h).
#pragma once

#include <vector>

#include "lib/model/voxel_ecm_model.h"

namespace supple {

struct FreePose {
  std::size_t piece;  // in Body::rigid
  RigidPose pose;
};

class FreePoses {
 public:
  /// Both outlive it; the body stays as it is.
  FreePoses(Body& body, VoxelEcmModel& ecm, Progress* progress)
      : m_body(body), m_ecm(ecm), m_progress(progress) {}

  /// Poses to which the drag of a report shifts pieces.
  std::vector<FreePose> shifted(const EcmReport& report) const;

  /// Leads poses that the whole drag of the handles allows to smaller motions. Pieces that these
  /// would shift are added.
  void shrink(const std::vector<Handle>& handles, std::vector<FreePose>& poses);
  /// Leads any poses to ones that the whole drag of the handles allows; false where it finds none.
  bool find(const std::vector<Handle>& handles, std::vector<FreePose>& poses);
  /// The handles, and one for each pose.
  std::vector<Handle> with(const std::vector<Handle>& handles, const std::vector<FreePose>& poses,
                           const std::vector<std::size_t>& left_out = {}) const;

 private:
  using Group = std::vector<std::size_t>;  // places in a list of poses
  std::vector<Group> groups_of(const std::vector<FreePose>& poses, std::size_t first) const;
  bool find_group(const std::vector<Handle>& handles, std::vector<FreePose>& poses,
                  const Group& group, bool skips_impossible, LastingBounds& lasting);
  void shrink_group(const std::vector<Handle>& handles, std::vector<FreePose>& poses,
                    const Group& group, LastingBounds& lasting);
  double reach(const std::vector<FreePose>& poses, const Group& group) const;
  LastingBounds lasting_bounds(const std::vector<Handle>& handles,
                               const std::vector<FreePose>& poses) const;
  double shift_mm(const FreePose& free) const;
  double longest_way(const RigidPiece& piece, const RigidPose& pose) const;

  Body& m_body;
  VoxelEcmModel& m_ecm;
  Progress* m_progress;
};

/// The handles, shortened to a part of the drag.
std::vector<Handle> shortened(std::vector<Handle> handles, std::int64_t numerator,
                              std::int64_t denominator);

}  // namespace supple
