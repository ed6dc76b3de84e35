#include <filesystem>

#include "tools/scene/live/live_view.h"

namespace supple::tools {

namespace {

std::string absolute(const std::string& path) {
  return std::filesystem::absolute(path).lexically_normal().string();
}

/// The tables of the file that say what is opened.
Value head_of(const Value& file, const Scene& scene) {
  Value head = Value::Entries();
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
  if (event.turn != Vec3d(0)) json["turn"] = event.turn;
  if (event.joint_mm > 0) json["joint"] = event.joint_mm;
  if (event.all) json["all"] = true;
  if (event.looks) json["looks"] = true;
  if (event.restore) json["restore"] = true;
  if (event.handle > 0) json["handle"] = event.handle;
  if (event.anchor > 0) json["anchor"] = event.anchor;
  if (event.cut > 0) json["cut"] = event.cut;
  if (event.remove > 0) json["remove"] = event.remove;
  if (event.no_relax) json["no_relax"] = true;
  if (event.kind == EventKind::limits) {
    json["limits"] = std::vector<std::string>{"box", "ball", "tighten"}[std::size_t(event.limits)];
  }
  if (event.under_hand) json["under_hand"] = true;
  for (const HandDirection& direction : event.directions) {
    json["directions"].push_back(direction.value());
  }
  json.update(keys_of(event));
  return json;
}

}  // namespace

LiveJournal::LiveJournal(const Table& root, const Scene& scene)
    : m_head(head_of(root.written(), scene)) {}

void LiveJournal::add(const LiveEvent& event, bool replaces_last) {
  if (replaces_last) m_events.pop_back();
  m_events.push_back(keys_of_event(event));
  m_last = event.kind;
  if (m_recorder) m_recorder(m_events.back(), replaces_last);
}

Value LiveJournal::written(const LiveView& view) const {
  Value journal = m_head;
  journal["view"].push_back(view.first_keys());
  for (const Value& event : m_events) journal["event"].push_back(event);
  return journal;
}

Value LiveJournal::batch_scene(const std::vector<DoneStep>& steps, const LiveView& view,
                               bool refers) const {
  Value scene = m_head;
  for (const DoneStep& done : steps) scene["step"].push_back(done.step.keys);
  scene["view"].push_back(view.keys())["size"] = view.shown().size;
  scene["output"] = {{"state", "live.vdb"}};
  if (refers) scene["output"]["refer"] = true;
  return scene;
}

}  // namespace supple::tools
