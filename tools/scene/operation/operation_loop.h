// The thread of a live operation: steps at the pace of a clock, and pictures of the newest step
// where there is time. All steps are equally long; where the machine falls behind, the operation
// takes longer than the clock says. While it pauses, pictures follow what is asked for.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include "raycast/pictures/image.h"
#include "tools/scene/operation/live_operation.h"
#include "tools/scene/operation/operation_picture.h"

namespace supple::tools {

/// Listener of a loop, called from the thread that runs it.
class OperationListener {
 public:
  virtual ~OperationListener() = default;
  virtual void stepped(const OperationSample&) {}
  virtual void pictured(const Image&) {}
};

/// The last few times of something.
class RecentTimes {
 public:
  void add(double ms);
  void clear() { m_ms.clear(); }
  std::size_t count() const { return m_ms.size(); }
  /// The value that this part of them does not exceed; 0 where there are none.
  double quantile_ms(double part) const;

 private:
  std::deque<double> m_ms;
};

class OperationLoop {
 public:
  /// All outlive the loop.
  OperationLoop(LiveOperation& live, OperationListener& listener);

  /// Runs until end(). Throws what a step or a picture throws.
  void run();

  // From any thread:

  /// Does a piece of work before the next step, in the order in which it was posted. It may not
  /// throw.
  void post(std::function<void()> work);
  void end();

  // From the thread of the loop:

  void pause(bool pauses) { m_is_paused = pauses; }
  bool is_paused() const { return m_is_paused; }
  /// Nobody looks: time stands still, and nothing is drawn.
  void watch(bool is_watched) { m_is_watched = is_watched; }

  const RecentTimes& step_times() const { return m_step_times; }
  const RecentTimes& picture_times() const { return m_picture_times; }
  /// Time of the clock for which there were no steps.
  double dropped_s() const { return m_dropped_s; }

 private:
  using Clock = std::chrono::steady_clock;
  /// Does posted work until it is time. Returns false where it is to end.
  bool wait_until(Clock::time_point due);
  void do_posted();
  bool stands() const { return m_is_paused || !m_is_watched; }
  void step();
  void draw();

  LiveOperation& m_live;
  OperationListener& m_listener;
  std::unique_ptr<OperationPicture> m_picture;
  int m_restarts = -1;  // of the operation that it shows

  std::mutex m_guard;  // of what follows
  std::condition_variable m_changed;
  std::deque<std::function<void()>> m_posted;
  bool m_ends = false;

  bool m_is_paused = false, m_is_watched = true;
  bool m_is_seen = false;  // the state as it is
  Clock::time_point m_drawn;
  double m_dropped_s = 0;
  RecentTimes m_step_times, m_picture_times;
};

}  // namespace supple::tools
