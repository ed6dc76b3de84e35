// The thread of a live operation: steps at the pace of a clock, and pictures of the newest step
// where there is time. All steps are equally long; where the machine falls behind, the operation
// takes longer than the clock says. While it pauses, pictures follow what is asked for.
//
// A hand sees soon what it does: its word makes a step begin up to half of a step early, and while
// it moves something pictures are as much smaller as this machine needs to draw them in time. The
// next picture after that is whole again.
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
#include "volumes/base/stopwatch.h"

namespace supple::tools {

/// Listener of a loop, called from the thread that runs it.
class OperationListener {
 public:
  virtual ~OperationListener() = default;
  virtual void stepped(const OperationSample&) {}
  /// A picture of the view, or a smaller one that is to be stretched to its size.
  virtual void pictured(const Image&, const PixelSize& size) { (void)size; }
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
  /// Time that a picture may take while a hand moves something: it is seen after the one that is
  /// being drawn, so that two of them and what the page takes are to be soon enough.
  static constexpr double kLedPicture_ms = 12;

  /// All outlive the loop.
  OperationLoop(LiveOperation& live, OperationListener& listener,
                double led_picture_ms = kLedPicture_ms);

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
  /// A hand has moved something, and wants to see it.
  void tell_hand();

  const RecentTimes& step_times() const { return m_step_times; }
  /// Whole pictures and smaller ones.
  const RecentTimes& picture_times() const { return m_picture_times; }
  /// Time of the clock for which there were no steps.
  double dropped_s() const { return m_dropped_s; }

 private:
  using Clock = std::chrono::steady_clock;
  /// Does posted work until it is time, or a hand wants it to be. Returns false where it is to end.
  bool wait_until(Clock::time_point due);
  void do_posted();
  bool stands() const { return m_is_paused || !m_is_watched; }
  bool is_led() const;
  /// The view as the next picture draws it.
  MicroscopeView drawn_view() const;
  void step();
  void draw();

  LiveOperation& m_live;
  OperationListener& m_listener;
  const double m_led_picture_ms;
  const Clock::duration m_length;  // of a step
  std::unique_ptr<OperationPicture> m_picture;
  int m_restarts = -1;  // of the operation that it shows

  std::mutex m_guard;  // of what follows
  std::condition_variable m_changed;
  std::deque<std::function<void()>> m_posted;
  bool m_ends = false;

  bool m_is_paused = false, m_is_watched = true;
  bool m_is_seen = false;     // the state as it is
  bool m_is_whole = false;    // the last picture
  bool m_hand_waits = false;  // for a step
  Clock::time_point m_drawn, m_hand_told;
  CostPer m_pixel{0};
  double m_dropped_s = 0;
  RecentTimes m_step_times, m_picture_times;
};

}  // namespace supple::tools
