#include "tools/scene/live/replay.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <thread>
#include <vector>

#include "raycast/pictures/compare.h"
#include "tools/scene/file/scene.h"
#include "tools/scene/live/event_mailbox.h"
#include "tools/scene/pictures/picture_options.h"
#include "volumes/base/parallel.h"
#include "volumes/base/sha256.h"

namespace supple::tools {

namespace {

/// Two pixels in a row and the part of the later one, in 256ths.
struct Between {
  int low, high, part;
};

std::vector<Between> places_between(int to, int from) {
  std::vector<Between> places;
  for (int n = 0; n < to; ++n) {
    const double place = std::clamp((n + 0.5) * from / to - 0.5, 0.0, double(from - 1));
    places.push_back({int(place), std::min(int(place) + 1, from - 1),
                      int(std::lround(256 * (place - std::floor(place))))});
  }
  return places;
}

}  // namespace

Image enlarged(const Image& image, int width, int height) {
  if (image.width == width && image.height == height) return image;
  Image large(width, height);
  large.has_alpha = image.has_alpha;
  const std::vector<Between> across = places_between(width, image.width);
  const std::vector<Between> down = places_between(height, image.height);
  parallel_for(height, [&](int y) {
    const std::uint8_t* upper = &image.rgba[std::size_t(down[y].low) * image.width * 4];
    const std::uint8_t* lower = &image.rgba[std::size_t(down[y].high) * image.width * 4];
    std::uint8_t* out = &large.rgba[std::size_t(y) * width * 4];
    const int v = down[y].part;
    for (const Between& x : across) {
      const int u = x.part;
      for (int c = 0; c < 4; ++c) {
        const int top = upper[4 * x.low + c] * (256 - u) + upper[4 * x.high + c] * u;
        const int bottom = lower[4 * x.low + c] * (256 - u) + lower[4 * x.high + c] * u;
        *out++ = std::uint8_t((top * (256 - v) + bottom * v + (1 << 15)) >> 16);
      }
    }
  });
  return large;
}

namespace {

/// A pause of the hand after which the picture settles.
constexpr double kPauseMs = 500;
/// Longer pauses of a film are not, ms.
constexpr double kLongestPauseMs = 1000;

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
      Field("fps", options.frames_per_second, "Pictures a second of a film").range(0.1, 240),
  };
}

std::vector<int> film_frames(const std::vector<LiveEvent>& events, double frames_per_second,
                             double speed) {
  const double frame_ms = 1000 / frames_per_second;
  double now = 0, latest = 0;  // in the film, in the journal
  std::vector<double> since = {0};
  for (const LiveEvent& event : events) {
    const double pause = std::min((event.at_ms - latest) / speed, kLongestPauseMs);
    now += pause > 0 ? pause : frame_ms;
    latest = std::max(latest, event.at_ms);
    since.push_back(now);
  }
  since.push_back(now + std::max(kLongestPauseMs, frame_ms));
  const auto frames_before = [&](double ms) { return int(std::ceil(ms / frame_ms - 1e-9)); };
  std::vector<int> frames;
  for (std::size_t n = 0; n + 1 < since.size(); ++n) {
    frames.push_back(frames_before(since[n + 1]) - frames_before(since[n]));
  }
  return frames;
}

double quantile(std::vector<double> values, double part) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const auto rank = std::ptrdiff_t(std::ceil(part * double(values.size()))) - 1;
  return values[std::size_t(std::max<std::ptrdiff_t>(rank, 0))];
}

Replay::Replay(const Table& root, const ReplayOptions& options, Progress& listener,
               Progress& progress)
    : m_options(options),
      m_progress(progress),
      m_live(root, &progress),
      m_loop(m_live, {options.size, true, options.budget_ms}, *this, listener, &progress) {}

void Replay::run(bool compares) {
  m_compares = compares;
  stage(&m_progress, "replaying");
  m_loop.settle();
  if (m_options.speed > 0) {
    run_in_time();
  } else {
    run_at_once();
  }
}

void Replay::run_at_once() {
  const std::vector<LiveEvent>& events = m_live.events();
  for (std::size_t n = 0; n < events.size(); ++n) {
    poll(&m_progress);
    LiveEvent event = events[n];
    event.merged = 0;  // those that it replaced are not in the journal
    m_loop.show(event, std::chrono::steady_clock::now());
    while (m_live.has_more()) m_loop.go_on();
    const bool is_last = n + 1 == events.size();
    const bool pauses = is_last || events[n].kind == EventKind::release ||
                        events[n + 1].at_ms - events[n].at_ms >= kPauseMs;
    while (pauses && m_loop.refine()) {
    }
  }
}

std::vector<int> Replay::film_frames() const {
  const double speed = m_options.speed > 0 ? m_options.speed : 1;
  return tools::film_frames(m_live.events(), m_options.frames_per_second, speed);
}

int Replay::film_length() const {
  const std::vector<int> frames = film_frames();
  const auto length = std::accumulate(frames.begin(), frames.end(), std::int64_t(0));
  if (length > kMostFrames) {
    throw InputError(
        {m_live.scene().file, "film", std::to_string(length) + " pictures",
         "at most " + std::to_string(kMostFrames) + ": a larger speed, a smaller fps"});
  }
  return int(length);
}

void Replay::film(const std::function<void(const Image&)>& add) {
  stage(&m_progress, "film");
  m_loop.settle();
  const std::vector<int> frames = film_frames();
  for (std::size_t n = 0; n < frames.size(); ++n) {
    supple::report(&m_progress, double(n) / double(frames.size()));
    if (n > 0) m_loop.show(m_live.events()[n - 1], std::chrono::steady_clock::now());
    while (m_live.has_more()) m_loop.go_on();
    if (frames[n] == 0) continue;
    m_loop.wait_for_lead();
    while (m_loop.refine()) poll(&m_progress);
    for (int shown = 0; shown < frames[n]; ++shown) add(*settled());
  }
}

void Replay::run_in_time() {
  EventMailbox mailbox;
  std::atomic<bool> ends{false};
  std::thread hand([&] {
    const auto start = std::chrono::steady_clock::now();
    for (const LiveEvent& event : m_live.events()) {
      constexpr double kLatestMs = 1e12;  // what a clock can hold
      const double at_ms = std::min(event.at_ms / m_options.speed, kLatestMs);
      const auto due = start + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                   std::chrono::duration<double, std::milli>(at_ms));
      const auto waits = [&] {
        return !ends && !m_progress.cancelled() && std::chrono::steady_clock::now() < due;
      };
      while (waits()) {
        const auto soon = std::chrono::steady_clock::now() + std::chrono::milliseconds(50);
        std::this_thread::sleep_until(std::min(due, soon));
      }
      LiveEvent posted = event;
      posted.merged = 0;  // those that it replaced are not in the journal
      mailbox.post(std::move(posted));
      m_loop.interrupt();
      if (ends || m_progress.cancelled()) break;
    }
    mailbox.close();
  });
  try {
    m_loop.run(mailbox);
  } catch (...) {
    ends = true;
    hand.join();
    throw;
  }
  hand.join();
}

void Replay::spent(LivePhase phase, const Stopwatch& time) {
  PhaseTimes& times = m_report.phases[std::size_t(phase)];
  times.ms.push_back(time.ms());
  times.cpu_ms.push_back(time.cpu_ms());
}

void Replay::carried_out(const LiveEvent& event) {
  ++m_report.events;
  m_report.merged += event.merged;
  const std::vector<StepRecord>& steps = m_live.session().records();
  if (steps.size() > m_steps) {
    m_report.moved_max = std::max(m_report.moved_max, steps.back().report.moved);
  }
  m_steps = steps.size();
}

void Replay::drew(const Image& first, const LiveCost& cost, const Stopwatch&) {
  m_first = first;
  m_report.least_part = std::min(m_report.least_part, double(cost.width) / m_options.size[0]);
}

void Replay::settled(const Image& image, const Stopwatch&) {
  if (!m_compares) return;
  const Image first = enlarged(m_first, image.width, image.height);
  m_report.first_pixels_ssim.push_back(compare(first, image, true).ssim);
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
  if (state.beyond) {
    for (const BrickValues& beyond : *state.beyond) feed(sha, beyond, bricks);
  }
  feed(sha, state.pieces, bricks);
  for (const auto& axis : state.rest) {
    for (const BrickValues& rest : axis) feed(sha, rest, bricks);
  }
  for (const auto& velocity : state.velocity_mm_s) feed(sha, velocity, bricks);
  return sha.hex();
}

}  // namespace supple::tools
