#include "tools/scene/operation/operation_loop.h"

#include "tools/scene/live/replay.h"
#include "volumes/base/stopwatch.h"

namespace supple::tools {

namespace {

constexpr std::size_t kMostTimes = 500;
/// Steps that are made up for at most, and that may pass without a picture.
constexpr int kMostBehind = 4;

}  // namespace

void RecentTimes::add(double ms) {
  m_ms.push_back(ms);
  if (m_ms.size() > kMostTimes) m_ms.pop_front();
}

double RecentTimes::quantile_ms(double part) const {
  return quantile({m_ms.begin(), m_ms.end()}, part);
}

OperationLoop::OperationLoop(LiveOperation& live, OperationListener& listener)
    : m_live(live), m_listener(listener) {}

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

bool OperationLoop::wait_until(Clock::time_point due) {
  const auto is_called = [&] { return m_ends || !m_posted.empty(); };
  while (true) {
    {
      std::unique_lock lock(m_guard);
      m_changed.wait_until(lock, due, is_called);
      if (m_ends) return false;
    }
    do_posted();
    if (Clock::now() >= due) return true;
    if (stands()) return true;
  }
}

void OperationLoop::step() {
  const Stopwatch watch;
  const OperationSample& sample = m_live.step();
  m_step_times.add(watch.ms());
  m_is_seen = false;
  m_listener.stepped(sample);
}

void OperationLoop::draw() {
  if (m_is_seen || !m_is_watched) return;
  // What was removed does not come back to a picture.
  if (m_restarts != m_live.restarts()) {
    m_picture = std::make_unique<OperationPicture>(m_live.scene(), m_live.operation());
    m_restarts = m_live.restarts();
  }
  const Stopwatch watch;
  m_picture->follow(m_live.operation(), m_live.record().balls());
  const Image& image = m_picture->draw(m_live.view(), m_live.time_s());
  m_picture_times.add(watch.ms());
  m_is_seen = true;
  m_drawn = Clock::now();
  m_listener.pictured(image);
}

void OperationLoop::run() {
  const auto length = std::chrono::duration_cast<Clock::duration>(
      std::chrono::duration<double>(m_live.scene().setup.step_s));
  Clock::time_point due = Clock::now();
  while (wait_until(due)) {
    const Clock::time_point now = Clock::now();
    if (stands()) {
      draw();
      due = now + length;
      continue;
    }
    step();
    due += length;
    const Clock::duration behind = Clock::now() - due;
    if (behind > kMostBehind * length) {
      m_dropped_s += std::chrono::duration<double>(behind).count();
      due = Clock::now();
    }
    const bool has_time = behind < Clock::duration::zero();
    if (has_time || Clock::now() - m_drawn > kMostBehind * length) draw();
  }
}

}  // namespace supple::tools
