#define TOML_IMPLEMENTATION  // the library itself, which only this file sees
#include "volumes/base/toml.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <fstream>
#include <iterator>
#include <sstream>

#include <toml++/toml.h>

#include "volumes/base/error.h"
#include "volumes/base/files.h"
#include "volumes/base/json.h"
#include "volumes/base/text.h"

namespace supple {

namespace {

constexpr std::size_t kLongestText = 60;

template <class T>
std::string printed(const toml::value<T>& value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

Value value_of(const toml::node& node) {
  Value value;
  if (const toml::table* table = node.as_table()) {
    value = Value::Entries();
    for (const auto& [key, entry] : *table) value[std::string(key.str())] = value_of(entry);
  } else if (const toml::array* list = node.as_array()) {
    value = Value::List();
    for (const toml::node& item : *list) value.push_back(value_of(item));
  } else if (const auto* text = node.as_string()) {
    value = text->get();
  } else if (const auto* whole = node.as_integer()) {
    value = whole->get();
  } else if (const auto* number = node.as_floating_point()) {
    value = number->get();
  } else if (const auto* truth = node.as_boolean()) {
    value = truth->get();
  } else if (const auto* date = node.as_date()) {
    value = Value::Moment{printed(*date)};
  } else if (const auto* time = node.as_time()) {
    value = Value::Moment{printed(*time)};
  } else if (const auto* moment = node.as_date_time()) {
    value = Value::Moment{printed(*moment)};
  }
  value.line = int(node.source().begin.line);
  return value;
}

std::string toml_key(const std::string& key) {
  const auto is_bare = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-'; };
  const bool all = !key.empty() && std::all_of(key.begin(), key.end(), is_bare);
  return all ? key : json_string(key);
}

std::string toml_string(const std::string& text) {
  std::string quoted = json_string(text);
  if (!json_or_null(quoted).is_null()) return quoted;
  throw InputError({"", "", quoted, "text in UTF-8"});
}

/// Writes lists and tables in one line, and what is in them as `write_one` does, until that returns
/// false.
template <class WriteOne>
bool write_inline(const Value& value, std::string& line, const char* empty_table,
                  const WriteOne& write_one) {
  bool is_first = true;
  if (value.is_list()) {
    line += '[';
    for (const Value& item : value.items()) {
      if (!std::exchange(is_first, false)) line += ", ";
      if (!write_inline(item, line, empty_table, write_one)) return false;
    }
    line += ']';
    return true;
  }
  if (!value.is_table()) return write_one(value, line);
  if (value.empty()) return line += empty_table, true;
  line += "{ ";
  for (const auto& [key, entry] : value.entries()) {
    if (!std::exchange(is_first, false)) line += ", ";
    line += toml_key(key) + " = ";
    if (!write_inline(entry, line, empty_table, write_one)) return false;
  }
  line += " }";
  return true;
}

bool write_shown(const Value& value, std::string& line) {
  if (value.is_text()) {
    line += printed(toml::value<std::string>(value.text()));
  } else if (value.is_number() && !value.is_whole()) {
    line += exact_text(value.number());
  } else {
    line += value.is_moment() ? value.text() : json_text(value);
  }
  return line.size() <= kLongestText;
}

bool write_exactly(const Value& value, std::string& line) {
  line += value.is_text()     ? toml_string(value.text())
          : value.is_moment() ? value.text()
                              : json_text(value);
  return true;
}

}  // namespace

Value parse_toml(const std::string& text, const std::string& source) {
  try {
    return value_of(toml::parse(text, source));
  } catch (const toml::parse_error& error) {
    throw InputError({source + ":" + std::to_string(error.source().begin.line),
                      "not TOML: " + std::string(error.description()), "", ""});
  }
}

Value read_toml(const std::string& path) {
  require_regular_file(path);
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw_open_error(path, errno);
  const std::string text((std::istreambuf_iterator<char>(stream)),
                         std::istreambuf_iterator<char>());
  if (text.empty()) throw InputError({path, "", "an empty file", "TOML"});
  return parse_toml(text, path);
}

std::string toml_document(const Value& root) {
  std::string text;
  const auto add = [&](const std::string& head, const Value& table) {
    text += (text.empty() ? "" : "\n") + head + "\n";
    for (const auto& [key, value] : table.entries()) {
      text += toml_key(key) + " = ";
      write_inline(value, text, "{  }", write_exactly);
      text += "\n";
    }
  };
  for (const auto& [key, value] : root.entries()) {
    if (!value.is_list()) add("[" + key + "]", value);
    for (const Value& table : value.items()) add("[[" + key + "]]", table);
  }
  return text;
}

std::string shown_text(const Value& value) {
  std::string line;
  write_inline(value, line, "{}", write_shown);
  std::replace(line.begin(), line.end(), '\n', ' ');
  if (line.size() > kLongestText) line = line.substr(0, kLongestText - 3) + "...";
  return line;
}

}  // namespace supple
