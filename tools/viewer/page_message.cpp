#include "tools/viewer/page_message.h"

#include <algorithm>
#include <array>
#include <filesystem>

#include "tools/scene/file/json.h"

namespace supple::tools {

namespace {

constexpr std::array<const char*, 16> kVerbs = {
    "event",  "size",  "slices", "deformed", "pick",      "list",     "open",    "save",
    "cancel", "go_on", "ack",    "presets",  "histogram", "material", "options", "materials"};

bool is_verb(const std::string& key) {
  return std::find(kVerbs.begin(), kVerbs.end(), key) != kVerbs.end();
}

/// Keys of an event whose texts name files, which begin at the first folder where they are
/// relative. Any file that is read, by whatever key, must lie within the folders all the same.
constexpr std::array<const char*, 7> kFileKeys = {"table",    "points", "fix_points", "mesh",
                                                  "transfer", "camera", "path"};

void resolve_files(Json& value, const std::string& key, const Folders& folders) {
  if (value.is_object()) {
    for (auto& [name, entry] : value.items()) resolve_files(entry, name, folders);
  } else if (value.is_array()) {
    for (Json& entry : value) resolve_files(entry, key, folders);
  } else if (value.is_string()) {
    const bool is_file = std::find(kFileKeys.begin(), kFileKeys.end(), key) != kFileKeys.end();
    if (is_file) value = folders.input(value.get<std::string>());
  }
}

bool has_control_characters(const Json& value) {
  if (value.is_string()) {
    const std::string& text = value.get_ref<const std::string&>();
    return std::any_of(text.begin(), text.end(),
                       [](char c) { return (c >= 0 && c < ' ') || c == 127; });
  }
  return value.is_structured() && std::any_of(value.begin(), value.end(), has_control_characters);
}

}  // namespace

PageMessage parse_page_message(std::string_view text) {
  if (text.size() > kMostMessageBytes) throw BadMessage("a message of more than 1 MiB");
  // The parser does not recurse, but who reads the value does.
  const auto limit_depth = [](int depth, Json::parse_event_t, Json&) {
    if (depth > kMostMessageDepth) throw BadMessage("a message of lists within lists");
    return true;
  };
  Json json;
  try {
    json = Json::parse(text.begin(), text.end(), limit_depth);
  } catch (const Json::exception&) {
    throw BadMessage("a message that is no JSON");
  }
  if (!json.is_object()) throw BadMessage("a message that is no object");
  PageMessage message;
  for (auto& [key, value] : json.items()) {
    if (key == "n") {
      const bool is_number = value.is_number_unsigned();
      const std::uint64_t n = is_number ? value.get<std::uint64_t>() : 0;
      if (n == 0 || n > UINT32_MAX) throw BadMessage("a number n outside 1 to 2^32-1");
      message.n = std::uint32_t(n);
    } else if (is_verb(key) && message.verb.empty()) {
      message.verb = key;
      message.value = std::move(value);
    } else {
      throw BadMessage("a message with two verbs or an unknown key");
    }
  }
  if (message.verb.empty()) throw BadMessage("a message without a verb");
  return message;
}

Table table_of(const PageMessage& message) {
  if (!message.value.is_object()) {
    throw InputError({message.verb, "", "no object", "an object of keys"});
  }
  if (has_control_characters(message.value)) {
    throw InputError({message.verb, "", "control characters", "texts and names without them"});
  }
  Table root = Table::parse(toml_document(Json{{message.verb, message.value}}.dump()), "");
  return *root.table(message.verb);
}

LiveEvent event_of(const PageMessage& message, const LabelNames& names, const Folders& folders) {
  PageMessage checked = message;
  resolve_files(checked.value, "", folders);
  Table table = table_of(checked);
  table.admit_inputs(
      [&folders](const std::string& path) { folders.input(std::filesystem::absolute(path)); });
  return read_event(table, names);
}

}  // namespace supple::tools
