// Records of a live session: a journal of its events, as they happen and as a whole, and a scene of
// the steps that have not been taken back.
#pragma once

#include "tools/scene/live/live_session.h"
#include "tools/scene/live/live_view.h"

namespace supple::tools {

class LiveJournal {
 public:
  /// Keeps the tables of the root that say what is opened, with absolute paths.
  LiveJournal(const Table& root, const Scene& scene);

  void record_with(LiveSession::Recorder recorder) { m_recorder = std::move(recorder); }
  void add(const LiveEvent& event, bool replaces_last = false);
  /// The kind of the event that was added last.
  EventKind last() const { return m_last; }

  /// The events, as a file that replays to the same state. `view`: that of the session.
  Value written(const LiveView& view) const;
  /// The steps, as a scene that `supple run` brings to the same state.
  Value batch_scene(const std::vector<DoneStep>& steps, const LiveView& view, bool refers) const;

 private:
  Value m_head;  // the file without steps, events and outputs
  std::vector<Value> m_events;
  EventKind m_last = EventKind::step;
  LiveSession::Recorder m_recorder;
};

}  // namespace supple::tools
