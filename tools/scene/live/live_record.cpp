// What a live session writes down: a journal of its events, as they happen and as a whole, and a
// scene of the steps that have not been taken back.
#include "tools/scene/live/live_record.h"

#include <filesystem>

#include <nlohmann/json.hpp>

#include "volumes/base/json.h"

namespace supple::tools {

namespace {

std::string absolute(const std::string& path) {
  return std::filesystem::absolute(path).lexically_normal().string();
}

/// The tables of the file that say what is opened.
nlohmann::ordered_json head_of(const nlohmann::ordered_json& file, const Scene& scene) {
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
  if (event.looks) json["looks"] = true;
  if (event.restore) json["restore"] = true;
  if (event.handle > 0) json["handle"] = event.handle;
  if (event.anchor > 0) json["anchor"] = event.anchor;
  if (event.cut > 0) json["cut"] = event.cut;
  if (event.no_relax) json["no_relax"] = true;
  if (event.kind == EventKind::limits) {
    json["limits"] = std::vector<std::string>{"box", "ball", "tighten"}[std::size_t(event.limits)];
  }
  json.update(nlohmann::ordered_json::parse(event.keys));
  return json;
}

void make_absolute(nlohmann::ordered_json& value, const std::string& key,
                   const Table::Inputs& inputs) {
  if (value.is_object()) {
    for (auto& [name, entry] : value.items()) make_absolute(entry, name, inputs);
  } else if (value.is_array()) {
    for (nlohmann::ordered_json& entry : value) make_absolute(entry, key, inputs);
  } else if (value.is_string()) {
    const auto found = inputs.find({key, value.get<std::string>()});
    if (found != inputs.end()) value = found->second;
  }
}

}  // namespace

nlohmann::ordered_json with_absolute_paths(const std::string& json, const Table& read) {
  nlohmann::ordered_json file = nlohmann::ordered_json::parse(json);
  make_absolute(file, "", read.inputs());
  return file;
}

void LiveSession::read_head(const Table& root) {
  m_admits = root.admits();
  m_head = head_of(with_absolute_paths(json_text(root.value()), root), m_scene).dump();
}

void LiveSession::record(const LiveEvent& event, bool replaces_last) {
  if (replaces_last) m_carried_out.pop_back();
  m_carried_out.push_back(keys_of_event(event).dump());
  m_last_recorded = event.kind;
  if (m_recorder) m_recorder(m_carried_out.back(), replaces_last);
}

std::string LiveSession::journal() const {
  nlohmann::ordered_json json = nlohmann::ordered_json::parse(m_head);
  json["view"].push_back(nlohmann::ordered_json::parse(m_first_view_keys));
  for (const std::string& event : m_carried_out) {
    json["event"].push_back(nlohmann::ordered_json::parse(event));
  }
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
