// A journal or a scene as a live session without a page: one event after the other with its first
// pixels, or at the pace at which they came.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "raycast/pictures/image.h"
#include "tools/scene/live/live_loop.h"

namespace supple::tools {

// Small pictures at the size of the view.

/// Stretches an image to that size, linear between pixels.
Image enlarged(const Image& image, int width, int height);

struct ReplayOptions {
  double speed = 0;       // of the journal's times; 0: each event when the last is done
  double budget_ms = 50;  // from event to first pixels; 0: as long as it takes
  PixelSize size{512, 512};
  double frames_per_second = 25;  // of a film
};
Fields fields(ReplayOptions& options);

/// Numbers of pictures of a film that show the body as it was opened, and what each event leads to.
/// Events come at the journal's times, pauses of more than a second last one; of events between two
/// pictures the last is seen, but those of one time have a picture each. The end stays for a
/// second.
std::vector<int> film_frames(const std::vector<LiveEvent>& events, double frames_per_second,
                             double speed);

/// Milliseconds of one phase, and of processor time, all threads together: that hardly depends on
/// what else the machine does.
struct PhaseTimes {
  std::vector<double> ms, cpu_ms;
};
/// Returns the value of the nearest rank; 0 where there are no values.
double quantile(std::vector<double> values, double part);

struct ReplayReport {
  int events = 0, merged = 0;
  std::int64_t moved_max = 0;             // elements, by one event
  PhaseTimes phases[5];                   // by LivePhase
  double least_part = 1;                  // of the view's width that first pixels had
  std::vector<double> first_pixels_ssim;  // against the settled picture

  const PhaseTimes& of(LivePhase phase) const { return phases[std::size_t(phase)]; }
};

class Replay final : public LoopWatcher {
 public:
  /// Opens what the root of a journal or scene describes. Throws as LiveSession. `progress`: of
  /// what takes long, which cancels it.
  Replay(const Table& root, const ReplayOptions& options, Progress& listener, Progress& progress);

  /// Carries out all events. `compares`: first pixels with what they become.
  void run(bool compares);
  /// Number of pictures of a film of the events. Throws InputError for more than kMostFrames.
  int film_length() const;
  /// Carries out all events, one after the other, and hands on settled pictures as film_frames().
  void film(const std::function<void(const Image&)>& add);

  LiveSession& live() { return m_live; }
  /// The displacement that is shown.
  const Displacement& displacement() { return m_loop.picture().displacement(); }
  const ReplayReport& report() const { return m_report; }
  /// The last settled picture.
  const std::optional<Image>& settled() { return m_loop.picture().settled(); }

 private:
  void run_at_once();
  void run_in_time();
  void spent(LivePhase phase, const Stopwatch& time) override;
  void carried_out(const LiveEvent& event) override;
  void drew(const Image& first, const LiveCost& cost, const Stopwatch& since_event) override;
  void settled(const Image& image, const Stopwatch& since_event) override;

  std::vector<int> film_frames() const;

  const ReplayOptions m_options;
  Progress& m_progress;
  LiveSession m_live;
  LiveLoop m_loop;
  ReplayReport m_report;
  std::size_t m_steps = 0;
  bool m_compares = false;
  Image m_first;
};

/// SHA-256 of elements, offsets, cuts, pieces, rest lengths and velocities: equal for equal bodies,
/// however they came there.
std::string hash_of(const State& state);

}  // namespace supple::tools
