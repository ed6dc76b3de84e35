#include "lib/session/free_poses.h"

#include <algorithm>
#include <cmath>

#include "lib/chainmail/fraction.h"
#include "lib/session/rigid_drag.h"

namespace supple {

namespace {

/// Pieces that take turns change less with every sweep.
constexpr int kMostSweeps = 4;
/// Of the way from a shift to the smallest motion, where tissue forbids the whole.
constexpr int kWayParts = 64;

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
                                    std::size_t left_out) const {
  std::vector<Handle> all = handles;
  for (std::size_t n = 0; n < poses.size(); ++n) {
    if (n == left_out) continue;
    all.push_back(handle_at(m_body, m_body.rigid.list[poses[n].piece], poses[n].pose));
  }
  return all;
}

/// In voxels, of any element along any axis.
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

/// Bounds are looked for as far as elements may go; where they go further, once more.
std::optional<RigidPose> FreePoses::smallest(const std::vector<Handle>& handles,
                                             const std::vector<FreePose>& poses, std::size_t n) {
  const RigidPiece& piece = m_body.rigid.list[poses[n].piece];
  const std::vector<Handle> others = with(handles, poses, n);
  double reach = 2 * longest_way(piece, poses[n].pose) + 1;
  for (;;) {
    const double reach_q = std::min(reach * kFixedOne, double(kMaxOffset));
    const auto bounds = m_ecm.bounds_of(piece, others, std::int32_t(reach_q), m_progress);
    const std::optional<RigidPose> pose = smallest_pose(m_body, piece, bounds);
    const double way = pose ? longest_way(piece, *pose) : 0;
    if (way < reach || reach_q == kMaxOffset) return pose;
    reach = 2 * way;
  }
}

bool FreePoses::shrink_one(const std::vector<Handle>& handles, std::vector<FreePose>& poses,
                           std::size_t n) {
  const RigidPose before = poses[n].pose;
  const std::optional<RigidPose> target = smallest(handles, poses, n);
  if (!target || *target == before) return false;
  const auto allows = [&](int part) {
    poses[n].pose =
        part == kWayParts ? *target : between(before, *target, double(part) / kWayParts);
    return m_ecm.allows(with(handles, poses), m_progress);
  };
  if (!allows(kWayParts)) {
    int done = 0, stopped = kWayParts;
    while (stopped - done > 1) {
      const int part = (done + stopped) / 2;
      (allows(part) ? done : stopped) = part;
    }
    if (done == 0 || !allows(done)) {
      poses[n].pose = before;
      return false;
    }
  }
  for (FreePose& also : shifted(m_ecm.report())) poses.push_back(std::move(also));
  return true;
}

void FreePoses::shrink(const std::vector<Handle>& handles, std::vector<FreePose>& poses) {
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    const std::size_t count = poses.size();
    bool has_changed = false;
    for (std::size_t n = 0; n < poses.size(); ++n) has_changed |= shrink_one(handles, poses, n);
    if (!has_changed || (count == 1 && poses.size() == 1)) return;
  }
}

bool FreePoses::find(const std::vector<Handle>& handles, std::vector<FreePose>& poses) {
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    bool has_changed = false;
    for (std::size_t n = 0; n < poses.size(); ++n) {
      const std::optional<RigidPose> pose = smallest(handles, poses, n);
      if (!pose) return false;
      has_changed |= !(*pose == poses[n].pose);
      poses[n].pose = *pose;
    }
    if (!has_changed || poses.size() == 1) break;
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
