// Records of a live session: a journal of its events, as they happen and as a whole, and a scene of
// the steps that have not been taken back.
#include <filesystem>

#include "tools/scene/file/scene.h"
#include "tools/scene/live/live_session.h"

namespace supple::tools {

namespace {

std::string absolute(const std::string& path) {
  return std::filesystem::absolute(path).lexically_normal().string();
}

/// The tables of the file that say what is opened.
Value head_of(const Value& file, const Scene& scene) {
  Value head = Value::table();
  head["volume"] = file["volume"];
  head["volume"]["path"] = absolute(scene.volume_path);
  if (file.contains("labels")) head["labels"] = {{"path", absolute(scene.labels_path)}};
  if (file.contains("material")) {
    head["material"] = file["material"];
    if (!scene.material_path.empty()) head["material"]["table"] = absolute(scene.material_path);
  }
  return head;
}

Value keys_of_event(const LiveEvent& event) {
  Value json = {{"kind", name_of(event.kind)}, {"at", event.at_ms}};
  if (event.merged > 0) json["merged"] = event.merged;
  if (event.kind == EventKind::drag) json["to"] = event.to;
  if (event.all) json["all"] = true;
  if (event.looks) json["looks"] = true;
  if (event.restore) json["restore"] = true;
  if (event.handle > 0) json["handle"] = event.handle;
  if (event.anchor > 0) json["anchor"] = event.anchor;
  if (event.cut > 0) json["cut"] = event.cut;
  if (event.no_relax) json["no_relax"] = true;
  if (event.kind == EventKind::limits) {
    json["limits"] = std::vector<std::string>{"box", "ball", "tighten"}[std::size_t(event.limits)];
  }
  json.update(keys_of(event));
  return json;
}

}  // namespace

void LiveSession::read_head(const Table& root) {
  m_admits = root.admits();
  m_head = head_of(root.written(), m_scene);
}

void LiveSession::record(const LiveEvent& event, bool replaces_last) {
  if (replaces_last) m_carried_out.pop_back();
  m_carried_out.push_back(keys_of_event(event));
  m_last_recorded = event.kind;
  if (m_recorder) m_recorder(m_carried_out.back(), replaces_last);
}

Value LiveSession::journal() const {
  Value journal = m_head;
  journal["view"].push_back(m_first_view_keys);
  for (const Value& event : m_carried_out) journal["event"].push_back(event);
  return journal;
}

Value LiveSession::batch_scene() const {
  Value scene = m_head;
  for (const DoneStep& done : m_done) scene["step"].push_back(done.step.keys);
  scene["view"].push_back(m_view_keys)["size"] = m_view.size;
  scene["output"] = {{"state", "live.vdb"}};
  if (m_scene.output.refers) scene["output"]["refer"] = true;
  return scene;
}

}  // namespace supple::tools
