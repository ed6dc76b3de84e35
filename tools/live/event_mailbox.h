// Events on their way to the thread that carries them out. What that has not begun is merged with
// what follows: of several places of a drag, cameras, looks or clips in a row only the last is
// left, and says how many it replaced. So the queue never grows behind a hand. Tasks keep their
// place among the events.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>

#include "tools/scene/live_event.h"

namespace supple::tools {

struct PostedEvent {
  LiveEvent event;
  std::function<void()> task;                    // instead of an event
  std::chrono::steady_clock::time_point posted;  // of those merged the last
};

class EventMailbox {
 public:
  void post(LiveEvent event);
  void post(std::function<void()> task);
  /// No event comes any more.
  void close();
  /// The oldest; none where there is none now. `waits`: until there is one, or none comes any more.
  std::optional<PostedEvent> take(bool waits);
  /// Waits, but not longer than until then.
  std::optional<PostedEvent> take_until(std::chrono::steady_clock::time_point end);
  bool is_closed() const;
  std::size_t size() const;

 private:
  std::optional<PostedEvent> take_first();

  mutable std::mutex m_guard;
  std::condition_variable m_changed;
  std::deque<PostedEvent> m_waiting;
  bool m_is_closed = false;
};

}  // namespace supple::tools
