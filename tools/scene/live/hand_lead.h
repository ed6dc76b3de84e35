// Finite elements under the hand of a live session. While something is dragged, the responses of
// what is held are found on a thread of their own, level by level; pictures show the body that the
// best level so far gives for where the hand is, and ChainMail's before there is one. The body of
// the session waits for the step that the hand ends with.
#pragma once

#include <atomic>
#include <chrono>
#include <exception>
#include <memory>
#include <thread>
#include <vector>

#include "lib/session/hand/live_shape.h"
#include "lib/session/hand/solid_ahead.h"
#include "volumes/base/progress.h"
#include "volumes/base/value.h"

namespace supple::tools {

/// The state of the responses as the page is told it.
struct LeadState {
  LivePose pose;  // level -1: ChainMail is shown
  Vec3d force_n{0, 0,
                0};  // with which the body pulls at the handle, LPS; 0 before a level is there
  bool is_done = false;
};

/// Its edges of elements in voxels, the error that is left, where it is known, and the size of the
/// force.
Value to_value(const LeadState& state);

/// Makes a solid ahead on a thread of its own.
class AheadThread {
 public:
  AheadThread(SessionBody& in, const FemStep& step);
  /// Cancels it.
  ~AheadThread();

  bool is_of(SessionBody& in, const FemStep& step) const { return m_solid.is_of(in, step); }
  /// The solid, waited for; null where it cannot be made. Throws Cancelled where `progress` says
  /// so: it is still being made.
  std::shared_ptr<KeptVoxels> voxels(const Progress* progress) const;

 private:
  SolidAhead m_solid;
  std::atomic<bool> m_is_cancelled{false}, m_is_over{false};
  std::thread m_thread;
};

class HandLead {
 public:
  using Clock = std::chrono::steady_clock;
  /// Begins to find the responses of the handle of `grab`, which is on the grid and moves nothing,
  /// in these directions. `ahead`: the solid that is being made, which is waited for; null: none
  /// is. Throws as LiveResponses.
  HandLead(const SessionBody& in, const Step& grab, std::vector<DragPose> directions,
           std::shared_ptr<AheadThread> ahead);
  /// Cancels what is still being found.
  ~HandLead();

  /// Finds the responses of a further direction, too. Throws as LiveResponses; for the thread of
  /// the session.
  void add(const SessionBody& in, const Step& grab, DragPose direction) {
    m_live.add(in, grab, std::move(direction));
  }
  /// The hand is there, from where it grabbed.
  void lead_to(DragPose target) {
    m_target = std::move(target);
    m_is_led = true;
  }
  bool has_level() const { return m_live.ready() > 0; }
  /// Shows this until a level is there.
  void show_before(const BodyShape& shape);
  /// The body for where the hand is, blended over a fifth of a second from what was shown before
  /// where a better level has come; null: it has not been led, or nothing follows yet. Valid until
  /// the next call.
  const BodyShape* shape(Clock::time_point now = Clock::now());
  /// True if shape() will be another one although the hand rests: it blends, or there is a level
  /// that it has not shown.
  bool is_changing() const { return m_is_led && (m_part < 1 || m_live.ready() - 1 != m_level); }
  /// True until the last level is there, or cannot be found.
  bool is_finding() const { return !m_live.is_done() && !m_has_failed; }
  LeadState state() const;

  /// The responses, waited for. Throws what finding them threw, Cancelled.
  std::shared_ptr<const FemResponses> found(Progress* progress);

 private:
  LiveResponses m_live;
  LiveShape m_elements;
  std::size_t m_bricks = 0;
  DragPose m_target{Vec3d(0), {}};
  BodyShape m_shape, m_from, m_aim;  // shown, before the level, by the level
  bool m_is_led = false, m_has_shape = false;
  int m_level = -1;   // shown
  double m_part = 1;  // of the way from m_from to m_aim
  Clock::time_point m_since;
  std::atomic<bool> m_is_cancelled{false}, m_has_failed{false};
  std::exception_ptr m_failure;  // read once m_has_failed
  std::thread m_thread;
};

}  // namespace supple::tools
