#include "tools/scene/operation/operation_loop.h"

#include <algorithm>
#include <cmath>

#include "tools/scene/live/replay.h"
#include "volumes/base/stopwatch.h"

namespace supple::tools {

namespace {

constexpr std::size_t kMostTimes = 500;
/// Steps that are made up for at most, and that may pass without a picture.
constexpr int kMostBehind = 4;

/// From its last word on a hand rests.
constexpr auto kHandRests = std::chrono::milliseconds(150);
/// The part of the width that pictures have at least while a hand moves something.
constexpr double kLeastPart = 0.375;

}  // namespace

void RecentTimes::add(double ms) {
  m_ms.push_back(ms);
  if (m_ms.size() > kMostTimes) m_ms.pop_front();
}

double RecentTimes::quantile_ms(double part) const {
  return quantile({m_ms.begin(), m_ms.end()}, part);
}

OperationLoop::OperationLoop(LiveOperation& live, OperationListener& listener,
                             double led_picture_ms)
    : m_live(live),
      m_listener(listener),
      m_led_picture_ms(led_picture_ms),
      m_length(std::chrono::duration_cast<Clock::duration>(
          std::chrono::duration<double>(live.scene().setup.step_s))) {}

void OperationLoop::post(std::function<void()> work) {
  {
    const std::lock_guard lock(m_guard);
    m_posted.push_back(std::move(work));
  }
  m_changed.notify_one();
}

void OperationLoop::end() {
  {
    const std::lock_guard lock(m_guard);
    m_ends = true;
  }
  m_changed.notify_one();
}

void OperationLoop::do_posted() {
  std::deque<std::function<void()>> posted;
  {
    const std::lock_guard lock(m_guard);
    posted.swap(m_posted);
  }
  for (const auto& work : posted) work();
  if (!posted.empty()) m_is_seen = false;
}

void OperationLoop::tell_hand() {
  m_hand_told = Clock::now();
  m_hand_waits = true;
}

bool OperationLoop::is_led() const {
  return Clock::now() - m_hand_told < kHandRests;
}

bool OperationLoop::wait_until(Clock::time_point due) {
  const auto is_called = [&] { return m_ends || !m_posted.empty(); };
  const auto begin = [&] { return m_hand_waits ? due - m_length / 2 : due; };
  while (true) {
    {
      std::unique_lock lock(m_guard);
      m_changed.wait_until(lock, begin(), is_called);
      if (m_ends) return false;
    }
    do_posted();
    if (Clock::now() >= begin() || stands()) return true;
  }
}

void OperationLoop::step() {
  const Stopwatch watch;
  const OperationSample& sample = m_live.step();
  m_step_times.add(watch.ms());
  m_is_seen = m_hand_waits = false;
  m_listener.stepped(sample);
}

MicroscopeView OperationLoop::drawn_view() const {
  MicroscopeView view = m_live.view();
  const double whole_ms = m_pixel.of(double(view.size[0]) * view.size[1]);
  if (!is_led() || whole_ms <= m_led_picture_ms) return view;
  // Sixteenths, so that a hand does not see each change of the machine's load.
  const double part = std::floor(16 * std::sqrt(m_led_picture_ms / whole_ms)) / 16;
  for (int& pixels : view.size) {
    pixels = std::max(1, int(std::lround(std::max(part, kLeastPart) * pixels)));
  }
  return view;
}

void OperationLoop::draw() {
  if (!m_is_watched || (m_is_seen && (m_is_whole || is_led()))) return;
  // What was removed does not come back to a picture.
  if (m_restarts != m_live.restarts()) {
    m_picture = std::make_unique<OperationPicture>(m_live.scene(), m_live.operation());
    m_restarts = m_live.restarts();
  }
  const MicroscopeView view = drawn_view();
  const PixelSize whole = m_live.view().size;
  const Stopwatch watch;
  m_picture->follow(m_live.operation(), m_live.record().balls());
  const Image& image = m_picture->draw(view, m_live.time_s());
  m_picture_times.add(watch.ms());
  m_pixel.add(watch.ms(), double(view.size[0]) * view.size[1]);
  m_is_seen = true;
  m_is_whole = view.size == whole;
  m_drawn = Clock::now();
  const int eyes = image.width / view.size[0];
  m_listener.pictured(image, {eyes * whole[0], whole[1]});
}

void OperationLoop::run() {
  Clock::time_point due = Clock::now();
  while (wait_until(due)) {
    const Clock::time_point now = Clock::now();
    if (stands()) {
      draw();
      due = now + m_length;
      continue;
    }
    step();
    due += m_length;
    const Clock::duration behind = Clock::now() - due;
    if (behind > kMostBehind * m_length) {
      m_dropped_s += std::chrono::duration<double>(behind).count();
      due = Clock::now();
    }
    const bool has_time = behind < Clock::duration::zero();
    if (has_time || Clock::now() - m_drawn > kMostBehind * m_length) draw();
  }
}

}  // namespace supple::tools
