// The view of a live session: which of a file's views it begins with, and the parts of it that
// events replace. Other views are left to `supple run`.
#pragma once

#include "tools/scene/file/live_event.h"
#include "tools/scene/file/scene.h"

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

  /// See LiveSession::begin_with_look().
  void begin_with_look(const std::string& preset);
  /// The keys that events of this kind replace.
  Value part(EventKind kind) const;
  /// Replaces these keys. `place`: of the event, for errors; its files lie beside it.
  void set_part(EventKind kind, const Value& part, const std::string& place = "");

 private:
  Table::Admits m_admits;  // asks before files are read that events name
  SceneView m_shown;
  Value m_keys, m_first_keys;
};

}  // namespace supple::tools
