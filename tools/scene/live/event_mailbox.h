// Events on their way to the thread that carries them out. What that has not begun is merged with
// what follows: of several places of a drag, cameras, looks or clips of one page in a row only the
// last is left, and says how many it replaced. So the queue never grows behind a hand. Tasks keep
// their place among the events.
//
// Who moves the body for long asks here whether something waits that may move it, and takes what
// only looks at it meanwhile.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <vector>

#include "tools/scene/file/live_event.h"

namespace supple::tools {

/// A task that moves or replaces the body; one that reads the body, which has to be whole for it;
/// one that reads pictures and how they are looked at, and leaves the body alone.
enum class TaskKind { moves, reads, looks };

struct PostedEvent {
  LiveEvent event;
  std::function<void()> task;                    // instead of an event
  std::chrono::steady_clock::time_point posted;  // of those merged the last
  TaskKind kind = TaskKind::moves;               // of events of the view: looks
};

class EventMailbox {
 public:
  void post(LiveEvent event);
  void post(std::function<void()> task, TaskKind kind = TaskKind::moves);
  /// Closes the mailbox: no event comes any more.
  void close();
  /// The oldest; none where there is none now. `waits`: until there is one, or none comes any more.
  std::optional<PostedEvent> take(bool waits);
  /// Waits for an event, but not longer than until then.
  std::optional<PostedEvent> take_until(std::chrono::steady_clock::time_point end);
  /// Takes the oldest that only looks, past what reads the body, but not past what moves it.
  std::optional<PostedEvent> take_look();
  /// Takes the events out that wait and may move the body; tasks and what only looks stay.
  std::vector<LiveEvent> drop_moves();
  /// True if something waits that may move the body.
  bool moves_wait() const { return m_moves > 0; }
  bool is_closed() const;

 private:
  std::optional<PostedEvent> take_first();
  std::optional<PostedEvent> take_at(std::deque<PostedEvent>::iterator at);

  mutable std::mutex m_guard;
  std::condition_variable m_changed;
  std::deque<PostedEvent> m_waiting;
  std::atomic<int> m_moves{0};  // of m_waiting
  bool m_is_closed = false;
};

}  // namespace supple::tools
