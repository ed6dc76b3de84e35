#include "lib/state/anchor_text.h"

#include <algorithm>

#include "volumes/base/error.h"
#include "volumes/base/json.h"

namespace supple {

namespace {

constexpr std::size_t kMaxFoundText = 80;

/// The keys of selections and pieces ascend in a state.
Value parse_sorted(const std::string& text, const std::string& file, const std::string& field) {
  try {
    return sorted(parse_json(text));
  } catch (const JsonError&) {
    throw InputError({file, field, text.substr(0, kMaxFoundText), "JSON"});
  }
}

int to_int(const Value& value) {
  if (value.whole() != std::int64_t(int(value.whole()))) throw std::out_of_range("no 32 bits");
  return int(value.whole());
}

}  // namespace

std::string anchors_to_json(const Anchors& anchors) {
  Value list = anchors.boxes;
  for (const std::int32_t label : anchors.labels) list.push_back({{"label", label}});
  for (const Value& selection : anchors.selections) list.push_back({{"select", sorted(selection)}});
  return json_text(list);
}

Anchors anchors_from_json(const std::string& text, const std::string& file) {
  const Value list = parse_sorted(text, file, "anchors");
  try {
    if (!list.is_list()) throw std::out_of_range("no list");
    Anchors anchors;
    for (const Value& item : list.items()) {
      if (item.contains("select")) {
        anchors.selections.push_back(item.at("select"));
        continue;
      }
      if (item.is_table()) {
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

std::vector<Value> tables_from_json(const std::string& text, const std::string& field,
                                    const std::string& file) {
  const Value list = parse_sorted(text, file, field);
  const Value::List& tables = list.items();
  const auto is_table = [](const Value& item) { return item.is_table(); };
  if (!list.is_list() || !std::all_of(tables.begin(), tables.end(), is_table)) {
    throw InputError({file, field, text.substr(0, kMaxFoundText), "a list of objects"});
  }
  return tables;
}

}  // namespace supple
