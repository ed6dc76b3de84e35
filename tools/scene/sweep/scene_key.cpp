#include "tools/scene/sweep/scene_key.h"

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "volumes/base/error.h"
#include "volumes/base/text.h"
#include "volumes/base/toml.h"

namespace supple::tools {

namespace {

constexpr const char* kPathExpected =
    "a key of the scene such as step[2].fem.pressures.pressure_kpa";

bool is_bare(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-';
}

void forget_lines(Value& value) {
  value.line = 0;
  for (const Value& item : value.items()) forget_lines(const_cast<Value&>(item));
  for (const auto& [key, entry] : value.entries()) forget_lines(const_cast<Value&>(entry));
}

/// A table that only names a file becomes what is in it.
void take_file_in(Value& table, const std::string& scene_file) {
  const Value* name = table.find("table");
  if (table.size() != 1 || name == nullptr || !name->is_text()) return;
  const std::filesystem::path folder = std::filesystem::path(scene_file).parent_path();
  Value inside = read_toml((folder / name->text()).string());
  forget_lines(inside);
  table = std::move(inside);
}

/// The place of an item of a list that `name` is, or of the value itself.
ScenePlace place_of(const Value& item, const Value& child, const std::string& name,
                    ScenePlace place) {
  place.emplace_back(name, 0);
  if (&item != &child) place.emplace_back("", std::size_t(&item - child.items().data()));
  return place;
}

/// The number that a text is, or 0.
std::size_t number_of(const std::string& text) {
  const bool are_digits =
      std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
  return are_digits && !text.empty() && text.size() < 9 ? std::size_t(std::stoul(text)) : 0;
}

}  // namespace

const Value* find_at(const Value& root, ScenePlace::const_iterator begin,
                     ScenePlace::const_iterator end) {
  const Value* at = &root;
  for (; at != nullptr && begin != end; ++begin) {
    const auto& [key, index] = *begin;
    if (!key.empty()) {
      at = at->find(key);
    } else {
      at = index < at->items().size() ? &at->items()[index] : nullptr;
    }
  }
  return at;
}

SceneKey::SceneKey(const std::string& text, const std::string& option) : m_text(text) {
  const auto refuse = [&] {
    throw UsageError(to_line({"", option, "'" + text + "'", kPathExpected}));
  };
  for (std::size_t at = 0;;) {
    const std::size_t end = add_part(at);
    if (end == std::string::npos) refuse();
    if (end == m_text.size()) return;
    if (m_text[end] != '.') refuse();
    at = end + 1;
  }
}

/// Reads a part; returns the place behind it, npos where there is none.
std::size_t SceneKey::add_part(std::size_t at) {
  Part part;
  if (m_text.compare(at, 1, "\"") == 0) {
    const std::size_t end = m_text.find('"', at + 1);
    if (end == std::string::npos) return end;
    part.name = m_text.substr(at + 1, end - at - 1);
    at = end + 1;
  } else {
    while (at < m_text.size() && is_bare(m_text[at])) part.name += m_text[at++];
  }
  if (part.name.empty()) return std::string::npos;
  if (m_text.compare(at, 1, "[") == 0) {
    const std::size_t end = m_text.find(']', at);
    if (end == std::string::npos || end == at + 1) return std::string::npos;
    part.which = m_text.substr(at + 1, end - at - 1);
    at = end + 1;
  }
  m_parts.push_back(part);
  return at;
}

std::string SceneKey::name_until(std::size_t part) const {
  std::string name;
  for (std::size_t n = 0; n <= part; ++n) {
    const std::string& which = m_parts[n].which;
    name += (n > 0 ? "." : "") + m_parts[n].name + (which.empty() ? "" : "[" + which + "]");
  }
  return name;
}

/// The items of a list that a part of the path means, or the value itself.
std::vector<Value*> SceneKey::chosen(Value& child, std::size_t part,
                                     const std::string& file) const {
  const std::string& which = m_parts[part].which;
  std::vector<Value*> found;
  if (which.empty() && !child.is_list()) return {&child};
  const std::size_t number = number_of(which);
  std::vector<std::string> names;
  for (std::size_t n = 0; n < child.items().size(); ++n) {
    const Value* name = child.items()[n].find("name");
    if (name != nullptr && name->is_text()) names.push_back(name->text());
    const bool is_named = name != nullptr && *name == Value(which);
    if (which.empty() || n + 1 == number || is_named) found.push_back(&child[n]);
  }
  if (!found.empty()) return found;
  std::string expected = child.items().empty()       ? "a list"
                         : child.items().size() == 1 ? "[1], the only one"
                                                     : "1";
  if (child.items().size() > 1) expected += " to " + std::to_string(child.size());
  for (const std::string& name : names) expected += ", " + name;
  throw InputError(
      {file, name_until(part),
       child.is_list() ? with_count(std::int64_t(child.size()), "item") : shown_text(child),
       expected});
}

void SceneKey::find_ends(Value& table, const ScenePlace& place, std::size_t depth,
                         const std::string& file, std::vector<End>& ends) const {
  const Part& part = m_parts[depth];
  if (part.name != "table") take_file_in(table, file);
  if (!table.contains(part.name)) return ends.push_back({&table, depth, place});
  if (depth + 1 == m_parts.size()) return ends.push_back({&table, depth + 1, place});
  Value& child = table[part.name];
  for (Value* item : chosen(child, depth, file)) {
    if (!item->is_table()) {
      throw InputError({file, name_until(depth), shown_text(*item),
                        "a table that has " + m_parts[depth + 1].name});
    }
    find_ends(*item, place_of(*item, child, part.name, place), depth + 1, file, ends);
  }
}

ScenePlace SceneKey::put(const End& end, const std::string& file, const Value& value) const {
  Value* at = end.table;
  ScenePlace place = end.place;
  for (std::size_t n = end.depth; n < m_parts.size(); ++n) {
    if (!m_parts[n].which.empty()) {
      throw InputError({file, name_until(n), "no " + m_parts[n].name, "a list of them"});
    }
    Value& child = (*at)[m_parts[n].name];
    at = &child;
    place.emplace_back(m_parts[n].name, 0);
    const bool is_last = n + 1 == m_parts.size();
    if (is_last && value.is_text() && child.is_table() && child.contains("path")) {
      place.emplace_back("path", 0);
      child["path"] = value;
    } else {
      child = is_last ? value : Value(Value::Entries());
    }
  }
  return place;
}

std::vector<ScenePlace> SceneKey::set(Value& root, const std::string& scene_file,
                                      const Value& value) const {
  std::vector<End> ends;
  std::vector<ScenePlace> places;
  find_ends(root, {}, 0, scene_file, ends);
  std::size_t deepest = 0;
  for (const End& end : ends) deepest = std::max(deepest, end.depth);
  const std::size_t last = m_parts.size() - 1;
  for (const End& end : ends) {
    if (end.depth < deepest) continue;
    if (end.depth <= last || m_parts[last].which.empty()) {
      places.push_back(put({end.table, std::min(end.depth, last), end.place}, scene_file, value));
      continue;
    }
    Value& list = (*end.table)[m_parts[last].name];
    for (Value* item : chosen(list, last, scene_file)) {
      *item = value;
      places.push_back(place_of(*item, list, m_parts[last].name, end.place));
    }
  }
  root = sorted(std::move(root));
  return places;
}

}  // namespace supple::tools
