#include "tools/live/live_session.h"

#include <algorithm>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "tools/scene/run_step.h"

namespace supple::tools {

namespace {

constexpr const char* kNoPicture = "live.png";  // a view in a file names one

std::string absolute(const std::string& path) {
  return std::filesystem::absolute(path).lexically_normal().string();
}

/// The tables of the file that say what is opened.
nlohmann::ordered_json head_of(const TomlTable& root, const Scene& scene) {
  const nlohmann::ordered_json file = nlohmann::ordered_json::parse(root.json());
  nlohmann::ordered_json head = nlohmann::ordered_json::object();
  head["volume"] = file["volume"];
  head["volume"]["path"] = absolute(scene.volume_path);
  if (file.contains("labels")) head["labels"] = {{"path", absolute(scene.labels_path)}};
  if (file.contains("material")) {
    head["material"] = file["material"];
    if (!scene.material_path.empty()) head["material"]["table"] = absolute(scene.material_path);
  }
  return head;
}

nlohmann::ordered_json keys_of_event(const LiveEvent& event) {
  nlohmann::ordered_json json = {{"kind", name_of(event.kind)}, {"at", event.at_ms}};
  if (event.merged > 0) json["merged"] = event.merged;
  if (event.kind == EventKind::drag) json["to"] = {event.to.x, event.to.y, event.to.z};
  if (event.all) json["all"] = true;
  if (event.kind == EventKind::limits) {
    json["limits"] = std::vector<std::string>{"box", "ball", "tighten"}[std::size_t(event.limits)];
  }
  json.update(nlohmann::ordered_json::parse(event.keys));
  return json;
}

}  // namespace

LiveSession::LiveSession(const std::string& path, Console& console) : m_scene(read_scene(path)) {
  for (const std::string& line : m_scene.warnings) console.warn(line);
  if (!m_scene.warp_path.empty() || !m_scene.path.empty() || m_scene.film) {
    throw InputError({m_scene.file, "", "a warp, path or film", "a body that events move"});
  }
  read_events(path);
  const SessionOptions options{m_scene.material, m_scene.labels_path, m_scene.read, true};
  m_session = std::make_unique<Session>(m_scene.volume_path, options, &console);
  if (m_session->geometry().dims().z == 1) {
    throw InputError({m_scene.volume_path, "", "one slice", "a volume of several slices"});
  }
  set_view();
}

void LiveSession::read_events(const std::string& path) {
  TomlTable root = TomlTable::read(path);
  m_head = head_of(root, m_scene).dump();
  const nlohmann::ordered_json file = nlohmann::ordered_json::parse(root.json());
  m_view_keys = file.contains("view") ? file["view"][file["view"].size() - 1].dump()
                                      : nlohmann::ordered_json({{"image", kNoPicture}}).dump();
  m_first_view_keys = m_view_keys;
  for (TomlTable& table : root.tables("event")) {
    m_events.push_back(read_event(table, m_scene.label_names));
  }
  for (std::size_t n = 0; n < m_scene.steps.size(); ++n) {
    LiveEvent event;
    event.place = m_scene.steps[n].place;
    event.step = m_scene.steps[n];
    event.keys = file["step"][n].dump();
    m_events.push_back(std::move(event));
  }
}

void LiveSession::set_view() {
  if (!m_scene.views.empty()) m_view = m_scene.views.back();
  m_view.image = m_view.image.empty() ? kNoPicture : m_view.image;
  if (m_view.slice || m_view.lattice || !m_view.meshes.empty() || !m_view.camera_keys.empty() ||
      !m_view.path.empty() || m_view.marks.has_surfaces() || m_view.picture.is_series()) {
    throw InputError({m_view.place, "view", "slices, a lattice, meshes, a path or a series",
                      "one picture of the volume in space"});
  }
}

void LiveSession::carry_out(const LiveEvent& event, Progress* progress) {
  if (event.is_of_view()) {
    change_view(event);
    return record(event);
  }
  m_pending = 0;
  switch (event.kind) {
    case EventKind::grab:
    case EventKind::push: {
      SceneStep asked = event.step;
      asked.handles.front().by = Vec3d(0);
      check_step(asked, m_session->geometry());
      check_step(*m_session, asked);
      m_grab = event;
      m_reached = Vec3d(0);
      break;
    }
    case EventKind::drag:
      drag(event, progress);
      break;
    case EventKind::release:
      if (event.all) {
        SceneStep step;
        step.place = event.place;
        step.release = true;
        run(step, nlohmann::ordered_json({{"release", true}}).dump(), progress);
      }
      m_grab.reset();
      break;
    case EventKind::cut:
      run(event.step,
          nlohmann::ordered_json({{"cut", {nlohmann::ordered_json::parse(event.keys)}}}).dump(),
          progress);
      break;
    case EventKind::anchor:
      run(event.step,
          nlohmann::ordered_json({{"anchors", {nlohmann::ordered_json::parse(event.keys)}}}).dump(),
          progress);
      break;
    case EventKind::relax:
      return relax(event, event.step.relax->passes, progress);
    case EventKind::limits:
      m_limits = event.limits;
      break;
    case EventKind::undo:
      if (m_done.empty() || !m_session->undo()) break;
      m_reached = m_done.back().reached_before;
      m_undone.push_back(std::move(m_done.back()));
      m_done.pop_back();
      break;
    case EventKind::redo:
      if (m_undone.empty()) break;
      do_again(m_undone.back(), progress);
      m_undone.pop_back();
      break;
    default:
      run(event.step, event.keys, progress);
  }
  record(event);
}

/// From where the handle has got to, so that one that an anchor stopped follows at once when it
/// is led back.
void LiveSession::drag(const LiveEvent& event, Progress* progress) {
  if (!m_grab) {
    throw InputError({event.place, "drag", "nothing that is grabbed", "grab or push before it"});
  }
  const Vec3d by = event.to - m_reached;
  if (by == Vec3d(0)) return;
  SceneStep step;
  step.place = event.place;
  step.handles = m_grab->step.handles;
  step.handles.front().by = by;
  step.limits = m_limits;
  step.no_relax = true;
  check_step(step, m_session->geometry());
  nlohmann::ordered_json handle = nlohmann::ordered_json::parse(m_grab->keys);
  handle["by"] = {by.x, by.y, by.z};
  if (step.handles.front().push) handle["push"] = true;
  nlohmann::ordered_json keys = {{"handles", {handle}}, {"no_relax", true}};
  if (m_limits != Limits::box) keys["limits"] = m_limits == Limits::ball ? "ball" : "tighten";
  const Vec3d before = m_reached;
  run(step, keys.dump(), progress);
  m_reached = before + by * m_session->records().back().report.fraction();
  m_done.back().reached_before = before;
  m_done.back().reached = m_reached;
}

void LiveSession::run(const SceneStep& step, const std::string& keys, Progress* progress) {
  run_step(*m_session, step, false, progress);
  m_undone.clear();
  m_done.push_back({step, keys, m_reached, m_reached});
}

void LiveSession::do_again(DoneStep done, Progress* progress) {
  run_step(*m_session, done.step, false, progress);
  m_reached = done.reached;
  m_done.push_back(std::move(done));
}

void LiveSession::relax(const LiveEvent& event, int passes, Progress* progress) {
  LiveEvent slice = event;
  slice.step.relax->passes = std::min(passes, kSlicePasses);
  nlohmann::ordered_json keys = nlohmann::ordered_json::parse(event.keys);
  keys["passes"] = slice.step.relax->passes;
  slice.keys = keys.dump();
  SceneStep step;
  step.place = event.place;
  step.relax = slice.step.relax;
  nlohmann::ordered_json settings;
  for (const Field& field : fields(*slice.step.relax)) {
    settings[field.name()] = nlohmann::ordered_json::parse(field.json());
  }
  run(step, nlohmann::ordered_json({{"relax", settings}}).dump(), progress);
  const RelaxReport& done = m_session->records().back().relaxed;
  m_pending = done.end == RelaxEnd::passes ? passes - slice.step.relax->passes : 0;
  m_relaxation = event;
  record(std::move(slice));
}

void LiveSession::relax_on(Progress* progress) {
  if (m_pending > 0) relax(*m_relaxation, std::exchange(m_pending, 0), progress);
}

void LiveSession::record(LiveEvent event) {
  m_carried_out.push_back(std::move(event));
}

void LiveSession::change_view(const LiveEvent& event) {
  nlohmann::ordered_json keys = nlohmann::ordered_json::parse(m_view_keys);
  if (event.kind == EventKind::look) {
    keys.erase("preset");
    keys.erase("transfer");
  }
  keys.update(nlohmann::ordered_json::parse(event.keys));
  const std::string text = toml_document(nlohmann::ordered_json({{"view", keys}}).dump());
  TomlTable root = TomlTable::parse(text, event.place);
  TomlTable table = *root.table("view");
  SceneView view = read_view(table, 0);
  view.size = m_view.size;
  m_view = std::move(view);
  m_view_keys = keys.dump();
}

std::string LiveSession::journal() const {
  nlohmann::ordered_json json = nlohmann::ordered_json::parse(m_head);
  json["view"].push_back(nlohmann::ordered_json::parse(m_first_view_keys));
  for (const LiveEvent& event : m_carried_out) json["event"].push_back(keys_of_event(event));
  return toml_document(json.dump());
}

std::string LiveSession::batch_scene() const {
  nlohmann::ordered_json json = nlohmann::ordered_json::parse(m_head);
  for (const DoneStep& done : m_done)
    json["step"].push_back(nlohmann::ordered_json::parse(done.keys));
  nlohmann::ordered_json view = nlohmann::ordered_json::parse(m_view_keys);
  view["size"] = m_view.size;
  json["view"].push_back(view);
  json["output"] = {{"state", "live.vdb"}};
  return toml_document(json.dump());
}

}  // namespace supple::tools
