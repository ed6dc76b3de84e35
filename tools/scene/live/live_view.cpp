// Looks at a live session: the view that a file begins with, and the events that change it.
#include "tools/scene/live/live_view.h"

#include "tools/scene/run/view_pictures.h"
#include "volumes/base/value.h"

namespace supple::tools {

namespace {

constexpr const char* kNoPicture = "live.png";  // a view in a file names one
/// Looks or clips that follow each other so soon are one step: a point that is dragged, a slider.
constexpr double kOneLookMs = 1000;

bool is_of_volume_in_space(const SceneView& view) {
  return !view.slice && !view.lattice && view.meshes.empty() && view.camera_keys.empty() &&
         view.path.empty() && view.marks.empty() && !view.picture.is_series();
}

/// The keys of a view that events of this kind replace.
std::vector<const char*> keys_of(EventKind kind) {
  if (kind == EventKind::look) return {"preset", "transfer"};
  return {kind == EventKind::clip ? "clip" : "camera"};
}

Value part_of(const Value& view, EventKind kind) {
  Value part = Value::table();
  for (const char* key : keys_of(kind)) {
    if (view.contains(key)) part[key] = view[key];
  }
  return part;
}

}  // namespace

const SceneView* shown_view(const Scene& scene) {
  const auto first = [&](const auto& suits) -> const SceneView* {
    for (const SceneView& view : scene.views) {
      if (is_of_volume_in_space(view) && suits(view)) return &view;
    }
    return nullptr;
  };
  const SceneView* at_the_end =
      first([](const SceneView& view) { return view.deformed && !view.after_step; });
  if (at_the_end != nullptr) return at_the_end;
  const SceneView* on_the_way = first([](const SceneView& view) { return view.deformed; });
  return on_the_way != nullptr ? on_the_way : first([](const SceneView&) { return true; });
}

/// Other views are left to `supple run`.
void LiveSession::choose_view(const Table& root, Progress* progress) {
  const std::vector<SceneView>& views = m_scene.views;
  const SceneView* shown = shown_view(m_scene);
  if (shown != nullptr) {
    const auto number = std::size_t(shown - views.data());
    m_view = *shown;
    m_view_keys = root.written()["view"][number];
    if (views.size() > 1) {
      note(progress, "of " + std::to_string(views.size()) + " views number " +
                         std::to_string(number + 1) +
                         " is shown, of the volume in space: " + m_view.image);
    }
  } else {
    m_view_keys = {{"image", kNoPicture}};
    if (!views.empty())
      note(progress, "no view draws the volume in space: a look of its own is shown");
  }
  m_first_view_keys = m_view_keys;
  if (m_view.image.empty()) m_view.image = kNoPicture;
}

void LiveSession::begin_with_look(const std::string& preset) {
  const Value& given = m_first_view_keys;
  if (given.contains("preset") || given.contains("transfer")) return;
  set_part_of_view(EventKind::look, {{"preset", preset}}, "");
  m_first_view_keys = m_view_keys;
}

/// Records the last of cameras in a row alone, and of looks or clips the last of one step.
void LiveSession::change_view(const LiveEvent& event) {
  const Value before = part_of(m_view_keys, event.kind);
  set_part_of_view(event.kind, event.view, event.place);
  LiveEvent carried_out = event;
  carried_out.view = part_of(m_view_keys, event.kind);
  const bool follows_its_kind = event.kind == m_last_recorded;
  if (event.kind == EventKind::camera) return record(carried_out, follows_its_kind);
  m_undone_looks.clear();
  const bool goes_on = !m_looks.empty() && m_looks.back().kind == event.kind &&
                       m_looks.back().order == m_order &&
                       event.at_ms <= m_looks.back().at_ms + kOneLookMs;
  if (goes_on) {
    m_looks.back().at_ms = event.at_ms;
    m_looks.back().after = carried_out.view;
  } else {
    m_looks.push_back({event.kind, ++m_order, event.at_ms, before, carried_out.view});
  }
  record(carried_out, goes_on && follows_its_kind);
}

void LiveSession::set_part_of_view(EventKind kind, const Value& part, const std::string& place) {
  Value keys = m_view_keys;
  for (const char* key : keys_of(kind)) keys.erase(key);
  keys.update(part);
  // Files of the view lie beside the journal; carry_out() names the event, not a line of the view.
  Table root({{"view", keys}}, place);
  root.admit_inputs(m_admits);
  Table table = *root.table("view");
  SceneView view = read_view(table, 0);
  check_view(view);
  view.size = m_view.size;
  m_view = std::move(view);
  m_view_keys = root.written()["view"];
}

bool LiveSession::take_look_back() {
  if (m_looks.empty() || (!m_done.empty() && m_done.back().order > m_looks.back().order)) {
    return false;
  }
  set_part_of_view(m_looks.back().kind, m_looks.back().before, "");
  m_undone_looks.push_back(std::move(m_looks.back()));
  m_looks.pop_back();
  return true;
}

bool LiveSession::make_look_again() {
  const auto& looks = m_undone_looks;
  if (looks.empty() || (!m_undone.empty() && m_undone.back().order < looks.back().order)) {
    return false;
  }
  set_part_of_view(looks.back().kind, looks.back().after, "");
  m_looks.push_back(std::move(m_undone_looks.back()));
  m_undone_looks.pop_back();
  return true;
}

}  // namespace supple::tools
