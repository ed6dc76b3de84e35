#include "tools/scene/live/event_mailbox.h"

#include <algorithm>
#include <utility>

namespace supple::tools {

namespace {

bool replaces(const LiveEvent& later, const PostedEvent& posted) {
  const LiveEvent& earlier = posted.event;
  const bool is_alike = later.kind == earlier.kind && later.page == earlier.page;
  if (posted.task || !is_alike) return false;
  return later.replaces_its_kind();
}

}  // namespace

void EventMailbox::post(LiveEvent event) {
  const auto now = std::chrono::steady_clock::now();
  {
    const std::lock_guard lock(m_guard);
    if (!m_waiting.empty() && replaces(event, m_waiting.back())) {
      event.merged += m_waiting.back().event.merged + 1;
      m_waiting.back().event = std::move(event);
      m_waiting.back().posted = now;
    } else {
      const TaskKind kind = event.is_of_view() ? TaskKind::looks : TaskKind::moves;
      m_moves += kind == TaskKind::moves ? 1 : 0;
      m_waiting.push_back({std::move(event), {}, now, kind});
    }
  }
  m_changed.notify_one();
}

void EventMailbox::post(std::function<void()> task, TaskKind kind) {
  {
    const std::lock_guard lock(m_guard);
    m_moves += kind == TaskKind::moves ? 1 : 0;
    m_waiting.push_back({LiveEvent(), std::move(task), std::chrono::steady_clock::now(), kind});
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
  return take_at(m_waiting.begin());
}

std::optional<PostedEvent> EventMailbox::take_look() {
  const std::lock_guard lock(m_guard);
  const auto found =
      std::find_if(m_waiting.begin(), m_waiting.end(),
                   [](const PostedEvent& posted) { return posted.kind != TaskKind::reads; });
  if (found == m_waiting.end() || found->kind == TaskKind::moves) return std::nullopt;
  return take_at(found);
}

std::optional<PostedEvent> EventMailbox::take_at(std::deque<PostedEvent>::iterator at) {
  PostedEvent taken = std::move(*at);
  m_waiting.erase(at);
  m_moves -= taken.kind == TaskKind::moves ? 1 : 0;
  return taken;
}

std::vector<LiveEvent> EventMailbox::drop_moves() {
  const std::lock_guard lock(m_guard);
  std::vector<LiveEvent> dropped;
  std::deque<PostedEvent> left;
  for (PostedEvent& posted : m_waiting) {
    if (posted.task || posted.kind != TaskKind::moves) {
      left.push_back(std::move(posted));
    } else {
      dropped.push_back(std::move(posted.event));
      --m_moves;
    }
  }
  m_waiting = std::move(left);
  return dropped;
}

bool EventMailbox::is_closed() const {
  const std::lock_guard lock(m_guard);
  return m_is_closed;
}

}  // namespace supple::tools
