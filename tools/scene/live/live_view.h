// The view of a live session: which of a file's views it begins with, and the parts of it that
// events replace; other views are left to `supple run`. And its records: a journal of its events,
// as they happen and as a whole, and a scene of the steps that have not been taken back.
#pragma once

#include "tools/scene/file/scene.h"
#include "tools/scene/live/live_session.h"

namespace supple::tools {

/// The first view of the volume in space that shows the body as the steps leave it, or else the
/// first in space; null where there is none.
const SceneView* shown_view(const Scene& scene);

class LiveView {
 public:
  LiveView(const Scene& scene, const Table& root, Progress* progress);

  /// The view that the events so far ask for, and its keys, now and as it was opened.
  const SceneView& shown() const { return m_shown; }
  const Value& keys() const { return m_keys; }
  const Value& first_keys() const { return m_first_keys; }

  /// See LiveSession::begin_with_look(); false where the file has a look.
  bool begin_with_look(const Value& look);
  /// The keys that events of this kind replace.
  Value part(EventKind kind) const;
  /// Replaces these keys. `place`: of the event, for errors; its files lie beside it.
  void set_part(EventKind kind, const Value& part, const std::string& place = "");

 private:
  Table::Admits m_admits;  // asks before files are read that events name
  SceneView m_shown;
  Value m_keys, m_first_keys;
  bool m_has_own_look = false;  // the file says how it is looked at
};

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
