#include "tools/scene/live/live_view.h"

#include "tools/scene/run/view_pictures.h"
#include "volumes/base/value.h"

namespace supple::tools {

namespace {

constexpr const char* kNoPicture = "live.png";  // a view in a file names one

bool is_of_volume_in_space(const SceneView& view) {
  return !view.slice && !view.lattice && view.meshes.empty() && view.camera_keys.empty() &&
         view.path.empty() && view.marks.empty() && !view.picture.is_series();
}

/// The keys of a view that events of this kind replace.
std::vector<const char*> keys_of(EventKind kind) {
  if (kind == EventKind::look) return {"preset", "transfer"};
  return {kind == EventKind::clip ? "clip" : "camera"};
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

LiveView::LiveView(const Scene& scene, const Table& root, Progress* progress)
    : m_admits(root.admits()) {
  const std::vector<SceneView>& views = scene.views;
  const SceneView* shown = shown_view(scene);
  if (shown != nullptr) {
    const auto number = std::size_t(shown - views.data());
    m_shown = *shown;
    m_keys = root.written()["view"][number];
    if (views.size() > 1) {
      note(progress, "of " + std::to_string(views.size()) + " views number " +
                         std::to_string(number + 1) +
                         " is shown, of the volume in space: " + m_shown.image);
    }
  } else {
    m_keys = {{"image", kNoPicture}};
    if (!views.empty())
      note(progress, "no view draws the volume in space: a look of its own is shown");
  }
  m_first_keys = m_keys;
  m_has_own_look = m_keys.contains("preset") || m_keys.contains("transfer");
  if (m_shown.image.empty()) m_shown.image = kNoPicture;
}

bool LiveView::begin_with_look(const Value& look) {
  if (m_has_own_look) return false;
  set_part(EventKind::look, look);
  for (const char* key : keys_of(EventKind::look)) {
    m_first_keys.erase(key);
    if (m_keys.contains(key)) m_first_keys[key] = m_keys[key];
  }
  return true;
}

Value LiveView::part(EventKind kind) const {
  Value part = Value::Entries();
  for (const char* key : keys_of(kind)) {
    if (m_keys.contains(key)) part[key] = m_keys[key];
  }
  return part;
}

void LiveView::set_part(EventKind kind, const Value& part, const std::string& place) {
  Value keys = m_keys;
  for (const char* key : keys_of(kind)) keys.erase(key);
  keys.update(part);
  // Files of the view lie beside the journal; carry_out() names the event, not a line of the view.
  Table root({{"view", keys}}, place);
  root.admit_inputs(m_admits);
  Table table = *root.table("view");
  SceneView view = read_view(table, 0);
  check_view(view);
  view.size = m_shown.size;
  m_shown = std::move(view);
  m_keys = root.written()["view"];
}

}  // namespace supple::tools
