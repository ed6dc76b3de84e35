#include "tools/viewer/page_message.h"

#include <algorithm>
#include <array>
#include <filesystem>

#include "volumes/base/json.h"

namespace supple::tools {

namespace {

/// Keys of an event whose texts name files, which begin at the first folder where they are
/// relative. Any file that is read, by whatever key, must lie within the folders all the same.
constexpr std::array<const char*, 7> kFileKeys = {"table",    "points", "fix_points", "mesh",
                                                  "transfer", "camera", "path"};

void resolve_files(Value& value, const Folders& folders) {
  for_each_text(value, "", [&](const std::string& key, std::string& text) {
    const bool is_file = std::find(kFileKeys.begin(), kFileKeys.end(), key) != kFileKeys.end();
    if (is_file) text = folders.input(text);
  });
}

bool has_control_characters(Value value) {
  bool found = false;
  for_each_text(value, "", [&](const std::string&, const std::string& text) {
    found = found || std::any_of(text.begin(), text.end(),
                                 [](char c) { return (c >= 0 && c < ' ') || c == 127; });
  });
  return found;
}

}  // namespace

const std::vector<std::string>& viewer_verbs() {
  static const std::vector<std::string> verbs = {
      "event",     "size",     "slices",  "deformed",  "curtain", "pick", "list",
      "open",      "save",     "cancel",  "go_on",     "ack",     "drop", "presets",
      "histogram", "material", "options", "materials", "begin"};
  return verbs;
}

PageMessage parse_page_message(std::string_view text, const std::vector<std::string>& verbs) {
  if (text.size() > kMostMessageBytes) throw BadMessage("a message of more than 1 MiB");
  Value json;
  try {
    json = parse_json(text, kMostMessageDepth);
  } catch (const JsonError& error) {
    throw BadMessage(error.is_too_deep ? "a message of lists within lists"
                                       : "a message that is no JSON");
  }
  if (!json.is_table()) throw BadMessage("a message that is no object");
  PageMessage message;
  for (const auto& [key, value] : json.entries()) {
    if (key == "n") {
      const std::int64_t n = value.is_whole() ? value.whole() : 0;
      if (n <= 0 || n > UINT32_MAX) throw BadMessage("a number n outside 1 to 2^32-1");
      message.n = std::uint32_t(n);
    } else if (message.verb.empty() && std::find(verbs.begin(), verbs.end(), key) != verbs.end()) {
      message.verb = key;
      message.value = value;
    } else {
      throw BadMessage("a message with two verbs or an unknown key");
    }
  }
  if (message.verb.empty()) throw BadMessage("a message without a verb");
  return message;
}

Table table_of(const PageMessage& message) {
  if (!message.value.is_table()) {
    throw InputError({message.verb, "", "no object", "an object of keys"});
  }
  if (has_control_characters(message.value)) {
    throw InputError({message.verb, "", "control characters", "texts and names without them"});
  }
  // A journal has the keys of an event in ascending order.
  return *Table(Value{{message.verb, sorted(message.value)}}).table(message.verb);
}

LiveEvent event_of(const PageMessage& message, const LabelNames& names, const Folders& folders) {
  PageMessage checked = message;
  resolve_files(checked.value, folders);
  Table table = table_of(checked);
  table.admit_inputs(
      [&folders](const std::string& path) { folders.input(std::filesystem::absolute(path)); });
  return read_event(table, names);
}

}  // namespace supple::tools
