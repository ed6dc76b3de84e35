#include "tools/live/replay.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <thread>

#include <sys/resource.h>

#include "raycast/pictures/compare.h"
#include "tools/live/event_mailbox.h"
#include "volumes/base/sha256.h"

namespace supple::tools {

namespace {

/// A pause of the hand after which the picture settles.
constexpr double kPauseMs = 500;

SceneView sized(SceneView view, const PixelSize& size) {
  view.size = size;
  return view;
}

/// Of the process, all threads.
double cpu_ms() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return double(now.tv_sec) * 1e3 + double(now.tv_nsec) * 1e-6;
}

template <class T>
void feed(Sha256& sha, const BrickArray<T>& values, std::size_t bricks) {
  for (std::size_t b = 0; b < bricks; ++b) {
    sha.update(values.brick_or_zero(b), sizeof(T) * kBrickVoxels);
  }
}

}  // namespace

Fields fields(ReplayOptions& options) {
  return {
      Field("speed", options.speed, "Of the journal's times; 0: each event when the last is done")
          .at_least(0),
      Field("budget", options.budget_ms, "From event to first pixels; 0: as long as it takes")
          .unit("ms")
          .at_least(0),
      Field("size", options.size, "Pixels").range(1, 16384),
  };
}

double quantile(std::vector<double> values, double part) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const auto rank = std::ptrdiff_t(std::ceil(part * double(values.size()))) - 1;
  return values[std::size_t(std::max<std::ptrdiff_t>(rank, 0))];
}

Stopwatch::Stopwatch(std::chrono::steady_clock::time_point started)
    : m_start(started), m_cpu_ms(cpu_ms()) {}

void Stopwatch::add_to(PhaseTimes& times) const {
  times.ms.push_back(ms());
  times.cpu_ms.push_back(cpu_ms() - m_cpu_ms);
}

Replay::Replay(const std::string& path, const ReplayOptions& options, Console& console)
    : m_options(options),
      m_console(console),
      m_live(path, console),
      m_picture(m_live.session(), sized(m_live.view(), options.size), console) {}

void Replay::run(bool compares) {
  m_compares = compares;
  stage(&m_console, "replaying");
  m_picture.follow();
  m_picture.prepare();
  m_picture.first_pixels(0);  // of the body as it was opened, not of an event
  while (refine()) {
  }
  if (m_options.speed > 0) {
    run_in_time();
  } else {
    run_at_once();
  }
}

void Replay::run_at_once() {
  const std::vector<LiveEvent>& events = m_live.events();
  for (std::size_t n = 0; n < events.size(); ++n) {
    poll(&m_console);
    show(events[n], std::chrono::steady_clock::now());
    while (m_live.pending() > 0) relax_on();
    const bool is_last = n + 1 == events.size();
    const bool pauses = is_last || events[n].kind == EventKind::release ||
                        events[n + 1].at_ms - events[n].at_ms >= kPauseMs;
    while (pauses && refine()) {
    }
  }
}

void Replay::run_in_time() {
  EventMailbox mailbox;
  std::thread hand([&] {
    const auto start = std::chrono::steady_clock::now();
    for (const LiveEvent& event : m_live.events()) {
      std::this_thread::sleep_until(
          start + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                      std::chrono::duration<double, std::milli>(event.at_ms / m_options.speed)));
      mailbox.post(event);
      m_picture.interrupt();
      if (m_console.cancelled()) break;
    }
    mailbox.close();
  });
  try {
    bool is_settled = false;
    while (true) {
      poll(&m_console);
      const bool is_idle = is_settled && m_live.pending() == 0;
      if (auto posted = mailbox.take(is_idle)) {
        show(posted->event, posted->posted);
        is_settled = false;
      } else if (m_live.pending() > 0) {
        relax_on();
      } else if (!is_settled) {
        is_settled = !refine();
      } else if (mailbox.is_closed()) {
        break;
      }
    }
  } catch (...) {
    hand.join();
    throw;
  }
  hand.join();
}

void Replay::show(const LiveEvent& event, std::chrono::steady_clock::time_point posted) {
  const Stopwatch since_event(posted);
  ++m_report.events;
  m_report.merged += event.merged;
  const std::size_t steps = m_live.session().records().size();
  const Stopwatch solving;
  m_live.carry_out(event);
  if (!event.is_of_view()) solving.add_to(m_report.solve);
  if (m_live.session().records().size() > steps) {
    m_report.moved_max =
        std::max(m_report.moved_max, m_live.session().records().back().report.moved);
  }
  if (event.is_of_view()) m_picture.look(sized(m_live.view(), m_options.size));
  draw(since_event);
}

void Replay::relax_on() {
  const Stopwatch since_event;
  m_live.relax_on();
  since_event.add_to(m_report.solve);
  draw(since_event);
}

/// Nothing where nothing has changed.
void Replay::draw(const Stopwatch& since_event) {
  const Stopwatch preparing;
  if (!m_picture.follow()) return;
  m_picture.prepare();
  preparing.add_to(m_report.prepare);
  const Stopwatch drawing;
  const double budget = m_options.budget_ms;
  m_first = m_picture.first_pixels(budget > 0 ? std::max(budget - since_event.ms(), 1e-3) : 0);
  drawing.add_to(m_report.frame);
  since_event.add_to(m_report.first_pixels);
  m_report.least_part =
      std::min(m_report.least_part, double(m_picture.cost().width) / m_first.width);
  m_asked = since_event;
}

/// One pass more; false when there is nothing left to do.
bool Replay::refine() {
  if (m_picture.settled()) return false;
  if (m_picture.refine()) return true;
  if (m_report.events == 0) return false;
  m_asked.add_to(m_report.refined);
  if (m_compares) {
    m_report.first_pixels_ssim.push_back(compare(m_first, *m_picture.settled(), true).ssim);
  }
  return false;
}

std::string hash_of(const State& state) {
  Sha256 sha;
  const std::size_t bricks = state.elements.brick_count();
  for (std::size_t b = 0; b < bricks; ++b) {
    const Vec3i origin = state.elements.origin(b);
    const int place[3] = {origin.x, origin.y, origin.z};
    sha.update(place, sizeof(place));
    sha.update(&state.elements.mask(b), sizeof(BrickMask));
    const LinkCuts::BrickCuts none{};
    const LinkCuts::BrickCuts* cuts = state.cuts.brick(b);
    sha.update(cuts != nullptr ? cuts : &none, sizeof(none));
  }
  for (const BrickValues& q : state.q) feed(sha, q, bricks);
  feed(sha, state.pieces, bricks);
  for (const auto& axis : state.rest) {
    for (const BrickValues& rest : axis) feed(sha, rest, bricks);
  }
  for (const auto& velocity : state.velocity_mm_s) feed(sha, velocity, bricks);
  return sha.hex();
}

double peak_rss_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return double(usage.ru_maxrss) * 1024 / 1e6;
}

}  // namespace supple::tools
