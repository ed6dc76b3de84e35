#include "tools/live/event_mailbox.h"

#include <utility>

namespace supple::tools {

namespace {

bool replaces(const LiveEvent& later, const PostedEvent& posted) {
  const LiveEvent& earlier = posted.event;
  if (posted.task || later.kind != earlier.kind) return false;
  return later.kind == EventKind::drag || later.is_of_view();
}

}  // namespace

void EventMailbox::post(LiveEvent event) {
  const auto now = std::chrono::steady_clock::now();
  {
    const std::lock_guard lock(m_guard);
    if (!m_waiting.empty() && replaces(event, m_waiting.back())) {
      event.merged += m_waiting.back().event.merged + 1;
      m_waiting.back() = {std::move(event), {}, now};
    } else {
      m_waiting.push_back({std::move(event), {}, now});
    }
  }
  m_changed.notify_one();
}

void EventMailbox::post(std::function<void()> task) {
  {
    const std::lock_guard lock(m_guard);
    m_waiting.push_back({LiveEvent(), std::move(task), std::chrono::steady_clock::now()});
  }
  m_changed.notify_one();
}

void EventMailbox::close() {
  {
    const std::lock_guard lock(m_guard);
    m_is_closed = true;
  }
  m_changed.notify_one();
}

std::optional<PostedEvent> EventMailbox::take(bool waits) {
  std::unique_lock lock(m_guard);
  if (waits) m_changed.wait(lock, [&] { return !m_waiting.empty() || m_is_closed; });
  return take_first();
}

std::optional<PostedEvent> EventMailbox::take_until(std::chrono::steady_clock::time_point end) {
  std::unique_lock lock(m_guard);
  m_changed.wait_until(lock, end, [&] { return !m_waiting.empty() || m_is_closed; });
  return take_first();
}

std::optional<PostedEvent> EventMailbox::take_first() {
  if (m_waiting.empty()) return std::nullopt;
  PostedEvent first = std::move(m_waiting.front());
  m_waiting.pop_front();
  return first;
}

bool EventMailbox::is_closed() const {
  const std::lock_guard lock(m_guard);
  return m_is_closed;
}

std::size_t EventMailbox::size() const {
  const std::lock_guard lock(m_guard);
  return m_waiting.size();
}

}  // namespace supple::tools
