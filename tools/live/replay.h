// A journal or a scene as a live session without a page: one event after the other with its first
// pixels, or at the pace at which they came.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "raycast/pictures/image.h"
#include "tools/live/live_picture.h"
#include "tools/live/live_session.h"

namespace supple::tools {

struct ReplayOptions {
  double speed = 0;       // of the journal's times; 0: each event when the last is done
  double budget_ms = 50;  // from event to first pixels; 0: as long as it takes
  PixelSize size{512, 512};
};
Fields fields(ReplayOptions& options);

/// Milliseconds of one phase, and of processor time, all threads together: that hardly depends on
/// what else the machine does.
struct PhaseTimes {
  std::vector<double> ms, cpu_ms;
};
/// Nearest rank; 0 where there are none.
double quantile(std::vector<double> values, double part);

/// Runs from its making.
class Stopwatch {
 public:
  /// `started`: before, for the time; processor time counts from now.
  explicit Stopwatch(
      std::chrono::steady_clock::time_point started = std::chrono::steady_clock::now());
  double ms() const { return ms_since(m_start); }
  void add_to(PhaseTimes& times) const;

 private:
  std::chrono::steady_clock::time_point m_start;
  double m_cpu_ms;
};

struct ReplayReport {
  int events = 0, merged = 0;
  std::int64_t moved_max = 0;  // elements, by one event
  PhaseTimes solve, prepare, frame, first_pixels, refined;
  double least_part = 1;                  // of the view's width that first pixels had
  std::vector<double> first_pixels_ssim;  // against the settled picture
};

class Replay {
 public:
  /// Opens what the file describes.
  Replay(const std::string& path, const ReplayOptions& options, Console& console);

  /// Carries out all events. `compares`: first pixels with what they become.
  void run(bool compares);

  LiveSession& live() { return m_live; }
  const ReplayReport& report() const { return m_report; }
  /// The last settled picture.
  const std::optional<Image>& settled() const { return m_picture.settled(); }

 private:
  void run_at_once();
  void run_in_time();
  void show(const LiveEvent& event, std::chrono::steady_clock::time_point posted);
  void relax_on();
  void draw(const Stopwatch& since_event);
  bool refine();

  const ReplayOptions m_options;
  Console& m_console;
  LiveSession m_live;
  LivePicture m_picture;
  ReplayReport m_report;
  bool m_compares = false;
  Image m_first;
  Stopwatch m_asked;  // since the event that the picture follows
};

/// SHA-256 of elements, offsets, cuts, pieces, rest lengths and velocities: equal for equal bodies,
/// however they came there.
std::string hash_of(const State& state);

/// The largest resident size of the process so far, in millions of bytes.
double peak_rss_mb();

}  // namespace supple::tools
