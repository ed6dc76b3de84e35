#include "lib/session/free_poses.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "lib/chainmail/fraction.h"
#include "lib/chainmail/piece_bounds.h"
#include "lib/session/handles/rigid_drag.h"

namespace supple {

namespace {

/// Up to this many free pieces are solved one by one; the others are solved together.
constexpr std::size_t kSinglePieces = 3;
/// Parts of the way from a shift to the smallest motion, where tissue forbids the whole.
constexpr int kPoseParts = 16;
/// A piece carries tissue along about as far as twice its shift, on all sides: links give way by
/// about half of their length.
constexpr double kCarriedShifts = 4;

std::int32_t reach_q_of(double voxels) {
  return std::int32_t(std::min(voxels * kFixedOne, double(kMaxOffset)));
}

RigidPose between(const RigidPose& a, const RigidPose& b, double part) {
  RigidPose pose;
  pose.turn = supple::between(a.turn, b.turn, part);
  for (std::size_t c = 0; c < 3; ++c) {
    pose.shift_q[c] = a.shift_q[c] + std::llround(double(b.shift_q[c] - a.shift_q[c]) * part);
  }
  return pose;
}

}  // namespace

std::vector<FreePose> FreePoses::shifted(const EcmReport& report) const {
  std::vector<FreePose> poses;
  for (const PieceShift& shift : report.shifted) {
    RigidPose pose = m_body.rigid.list[shift.piece].pose;
    for (std::size_t c = 0; c < 3; ++c) pose.shift_q[c] += shift.by_q[c];
    poses.push_back({shift.piece, pose});
  }
  return poses;
}

std::vector<Handle> FreePoses::with(const std::vector<Handle>& handles,
                                    const std::vector<FreePose>& poses,
                                    const std::vector<std::size_t>& left_out) const {
  std::vector<Handle> all = handles;
  for (std::size_t n = 0; n < poses.size(); ++n) {
    if (std::find(left_out.begin(), left_out.end(), n) != left_out.end()) continue;
    all.push_back(handle_at(m_body, m_body.rigid.list[poses[n].piece], poses[n].pose));
  }
  return all;
}

/// Longest way in voxels of any element along any axis, from where it is.
double FreePoses::longest_way(const RigidPiece& piece, const RigidPose& pose) const {
  RigidPiece moved = piece;
  moved.pose = pose;
  const PoseOffsets offsets(m_body.geometry, moved);
  double longest = 0;
  piece.elements->for_each([&](Slot slot) {
    const std::array<std::int64_t, 3> to = offsets(voxel_of(m_body.elements, slot));
    for (std::size_t c = 0; c < 3; ++c) {
      longest = std::max(longest, std::abs(double(to[c] - m_body.q[c].at(slot))) / kFixedOne);
    }
  });
  return longest;
}

/// Length of the shift from where the piece's motion starts.
double FreePoses::shift_mm(const FreePose& free) const {
  const RigidPose& start = m_body.rigid.list[free.piece].motion_starts_at();
  Vec3d shift;
  for (int c = 0; c < 3; ++c) {
    const auto n = std::size_t(c);
    shift[c] = double(free.pose.shift_q[n] - start.shift_q[n]) / kFixedOne;
  }
  return m_body.geometry.world_vector_from_index(shift).length();
}

/// Groups of pieces in the order in which they go.
std::vector<FreePoses::Group> FreePoses::groups_of(const std::vector<FreePose>& poses,
                                                   std::size_t first) const {
  Group order;
  for (std::size_t n = first; n < poses.size(); ++n) order.push_back(n);
  const auto size = [&](std::size_t n) {
    return m_body.rigid.list[poses[n].piece].elements->size();
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return size(a) > size(b); });
  const std::size_t singles = std::min(kSinglePieces, order.size());
  std::stable_sort(
      order.begin(), order.begin() + std::ptrdiff_t(singles),
      [&](std::size_t a, std::size_t b) { return shift_mm(poses[a]) > shift_mm(poses[b]); });
  std::vector<Group> groups;
  for (std::size_t n = 0; n < singles; ++n) groups.push_back({order[n]});
  if (singles < order.size()) {
    groups.emplace_back(order.begin() + std::ptrdiff_t(singles), order.end());
  }
  return groups;
}

/// Distance in voxels to which bounds are sought: twice as far as any element of the group goes.
double FreePoses::reach(const std::vector<FreePose>& poses, const Group& group) const {
  double reach = 1;
  for (const std::size_t n : group) {
    reach = std::max(reach, 2 * longest_way(m_body.rigid.list[poses[n].piece], poses[n].pose));
  }
  return reach;
}

/// Returns the bounds with which a search from these poses begins.
LastingBounds FreePoses::lasting_bounds(const std::vector<Handle>& handles,
                                        const std::vector<FreePose>& poses) const {
  Group all(poses.size());
  std::iota(all.begin(), all.end(), std::size_t(0));
  return {handles.size(), reach_q_of(reach(poses, all))};
}

/// Puts the poses of the group at their smallest motions. Bounds are looked for as far as elements
/// may go; where they go further, once more. False where no motion meets the bounds of a piece.
bool FreePoses::find_group(const std::vector<Handle>& handles, std::vector<FreePose>& poses,
                           const Group& group, bool skips_impossible, LastingBounds& lasting) {
  const std::vector<Handle> others = with(handles, poses, group);
  std::vector<const RigidPiece*> pieces;
  for (const std::size_t n : group) pieces.push_back(&m_body.rigid.list[poses[n].piece]);
  for (double reach = this->reach(poses, group);;) {
    const std::int32_t reach_q = reach_q_of(reach);
    const auto bounds = m_ecm.bounds_of(pieces, others, reach_q, lasting, m_progress);
    std::vector<FreePose> found = poses;
    double way = 0;
    for (std::size_t g = 0; g < group.size(); ++g) {
      FreePose& free = found[group[g]];
      const auto pose =
          smallest_pose(m_body, *pieces[g], bounds[g], kCarriedShifts * shift_mm(free), m_progress);
      if (!pose && !skips_impossible) return false;
      if (!pose) continue;
      free.pose = *pose;
      way = std::max(way, longest_way(*pieces[g], *pose));
    }
    if (way < reach || reach_q == kMaxOffset) {
      poses = std::move(found);
      return true;
    }
    reach = 2 * way;
  }
}

void FreePoses::shrink_group(const std::vector<Handle>& handles, std::vector<FreePose>& poses,
                             const Group& group, LastingBounds& lasting) {
  const std::vector<FreePose> before = poses;
  std::vector<FreePose> target = poses;
  find_group(handles, target, group, true, lasting);
  const auto allows = [&](int part) {
    for (const std::size_t n : group) {
      poses[n].pose = part == kPoseParts
                          ? target[n].pose
                          : between(before[n].pose, target[n].pose, double(part) / kPoseParts);
    }
    return m_ecm.allows(with(handles, poses), m_progress);
  };
  if (!allows(kPoseParts)) {
    int done = 0, stopped = kPoseParts;
    while (stopped - done > 1) {
      const int part = (done + stopped) / 2;
      (allows(part) ? done : stopped) = part;
    }
    if (done == 0 || !allows(done)) {
      poses = before;
      return;
    }
  }
  for (FreePose& also : shifted(m_ecm.report())) poses.push_back(std::move(also));
}

void FreePoses::shrink(const std::vector<Handle>& handles, std::vector<FreePose>& poses) {
  LastingBounds lasting = lasting_bounds(handles, poses);
  for (std::size_t first = 0; first < poses.size();) {
    const std::vector<Group> groups = groups_of(poses, first);
    first = poses.size();
    for (const Group& group : groups) shrink_group(handles, poses, group, lasting);
  }
}

bool FreePoses::find(const std::vector<Handle>& handles, std::vector<FreePose>& poses) {
  LastingBounds lasting = lasting_bounds(handles, poses);
  for (const Group& group : groups_of(poses, 0)) {
    if (!find_group(handles, poses, group, false, lasting)) return false;
  }
  poses.erase(std::remove_if(poses.begin(), poses.end(),
                             [&](const FreePose& free) {
                               return free.pose == m_body.rigid.list[free.piece].pose;
                             }),
              poses.end());
  return m_ecm.allows(with(handles, poses), m_progress);
}

std::vector<Handle> shortened(std::vector<Handle> handles, std::int64_t numerator,
                              std::int64_t denominator) {
  const Fraction fraction{numerator, denominator};
  for (Handle& handle : handles) {
    for (std::int32_t& by : handle.by_q) by = fraction.scale(by);
    for (auto& each : handle.each_by_q) {
      for (std::int32_t& by : each) by = fraction.scale(by);
    }
  }
  return handles;
}

}  // namespace supple
