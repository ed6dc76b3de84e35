#include "volumes/state/anchor_text.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "volumes/base/error.h"

namespace supple {

namespace {

constexpr std::size_t kMaxFoundText = 80;

nlohmann::json parse_list_or_object(const std::string& text, const std::string& file,
                                    const char* field) {
  nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
  if (json.is_discarded()) {
    throw InputError({file, field, text.substr(0, kMaxFoundText), "JSON"});
  }
  return json;
}

int to_int(const nlohmann::json& json) {
  const auto value = json.is_number_integer() ? json.get<std::int64_t>() : std::int64_t(1) << 40;
  if (value != std::int64_t(int(value))) throw std::out_of_range("no 32-bit integer");
  return int(value);
}

}  // namespace

std::string anchors_to_json(const Anchors& anchors) {
  nlohmann::json json = nlohmann::json::array();
  for (const IndexBox& box : anchors.boxes) {
    json.push_back({box.lo.x, box.lo.y, box.lo.z, box.hi.x, box.hi.y, box.hi.z});
  }
  for (const std::int32_t label : anchors.labels) json.push_back({{"label", label}});
  for (const std::string& selection : anchors.selections) {
    json.push_back({{"select", nlohmann::json::parse(selection)}});
  }
  return json.dump();
}

Anchors anchors_from_json(const std::string& text, const std::string& file) {
  const nlohmann::json json = parse_list_or_object(text, file, "anchors");
  try {
    if (!json.is_array()) throw std::out_of_range("no list");
    Anchors anchors;
    for (const nlohmann::json& item : json) {
      if (item.contains("select")) {
        anchors.selections.push_back(item.at("select").dump());
        continue;
      }
      if (item.is_object()) {
        anchors.labels.push_back(to_int(item.at("label")));
        continue;
      }
      if (item.size() != 6) throw std::out_of_range("no box");
      anchors.boxes.push_back({{to_int(item.at(0)), to_int(item.at(1)), to_int(item.at(2))},
                               {to_int(item.at(3)), to_int(item.at(4)), to_int(item.at(5))}});
    }
    return anchors;
  } catch (const std::exception&) {
    throw InputError({file, "anchors", text.substr(0, kMaxFoundText),
                      "a list of boxes of six integers, of labels and selections"});
  }
}

std::string pieces_to_json(const std::vector<std::string>& pieces) {
  nlohmann::json json = nlohmann::json::array();
  for (const std::string& piece : pieces) json.push_back(nlohmann::json::parse(piece));
  return json.dump();
}

std::vector<std::string> pieces_from_json(const std::string& text, const std::string& file) {
  const nlohmann::json json = parse_list_or_object(text, file, "pieces");
  const bool is_list = json.is_array() && std::all_of(json.begin(), json.end(),
                                                      [](const auto& x) { return x.is_object(); });
  if (!is_list) {
    throw InputError({file, "pieces", text.substr(0, kMaxFoundText), "a list of objects"});
  }
  std::vector<std::string> pieces;
  for (const nlohmann::json& piece : json) pieces.push_back(piece.dump());
  return pieces;
}

}  // namespace supple
