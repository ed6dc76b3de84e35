#include "tools/scene/sweep/sweep_cases.h"

#include <algorithm>
#include <cctype>
#include <cstddef>

#include "volumes/base/csv.h"
#include "volumes/base/error.h"
#include "volumes/base/files.h"
#include "volumes/base/text.h"
#include "volumes/base/toml.h"

namespace supple::tools {

namespace {

constexpr std::size_t kMostCases = 100000;

std::string trimmed(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(" \t");
  if (begin == std::string::npos) return "";
  return text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

/// Texts between commas outside of brackets and quotes.
std::vector<std::string> parted(const std::string& text) {
  std::vector<std::string> parts(1);
  int depth = 0;
  char quote = 0;
  for (std::size_t n = 0; n < text.size(); ++n) {
    const char c = text[n];
    if (quote != 0) {
      if (c == quote) quote = 0;
      if (c == '\\' && quote == '"' && n + 1 < text.size()) parts.back() += text[n++];
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '[' || c == '{') {
      ++depth;
    } else if (c == ']' || c == '}') {
      --depth;
    } else if (c == ',' && depth == 0) {
      parts.emplace_back();
      continue;
    }
    parts.back() += text[n];
  }
  return parts;
}

/// The name of a case, by which its files will be called. `others`: those before it.
std::string case_name(const std::string& field, const std::vector<std::string>& others,
                      const std::string& place) {
  constexpr std::size_t kLongest = 100;
  const std::string name = trimmed(field);
  const auto fits = [](unsigned char c) {
    return std::isalnum(c) != 0 || c >= 0x80 || c == '-' || c == '_' || c == '.';
  };
  if (name.empty() || name.front() == '.' || name.size() > kLongest ||
      !std::all_of(name.begin(), name.end(), fits)) {
    throw InputError({place, "name", "'" + name + "'",
                      "letters, digits and - _ . within, as it becomes the name of a folder"});
  }
  if (std::find(others.begin(), others.end(), name) != others.end()) {
    throw InputError({place, "name", "'" + name + "' again", "each name once"});
  }
  return name;
}

/// A value that a key has set at one of its places.
struct SetValue {
  std::size_t key;
  ScenePlace place;
  const Value* value;
};

/// True where a value is still there after a later one was set.
bool agree(const SetValue& earlier, const SetValue& later) {
  const ScenePlace &outer = earlier.place, &inner = later.place;
  if (outer.size() > inner.size()) {
    if (!std::equal(inner.begin(), inner.end(), outer.begin())) return true;
    const Value* now =
        find_at(*later.value, outer.begin() + std::ptrdiff_t(inner.size()), outer.end());
    return now != nullptr && *now == *earlier.value;
  }
  if (!std::equal(outer.begin(), outer.end(), inner.begin())) return true;
  const Value* was =
      find_at(*earlier.value, inner.begin() + std::ptrdiff_t(outer.size()), inner.end());
  return was == nullptr || *was == *later.value;  // null: a key that was not in the table
}

}  // namespace

SweptValue parse_swept(const std::string& given, const std::string& option) {
  const std::string text = trimmed(given);
  try {
    const Value root = parse_toml("v = [" + text + "]", "");
    const Value& list = root["v"];
    if (root.size() == 1 && list.size() == 1) {
      Value value = list.front();
      value.line = 0;
      return {value.is_text() ? value.text() : text, value};
    }
  } catch (const InputError&) {  // no TOML
  }
  if (!text.empty() && std::string("[{\"'").find(text.front()) == std::string::npos) {
    return {text, text};
  }
  throw UsageError(to_line({"", option, "'" + given + "'", "a value as scenes have it"}));
}

std::vector<SweptValue> parse_swept_list(const std::string& text) {
  std::vector<SweptValue> values;
  for (const std::string& part : parted(text)) values.push_back(parse_swept(part));
  return values;
}

namespace {

/// The values of a line; none for an empty field.
std::vector<std::optional<SweptValue>> row_of(const std::vector<std::string>& fields,
                                              const std::string& place) {
  std::vector<std::optional<SweptValue>> row;
  for (const std::string& field : fields) {
    row.emplace_back();
    if (trimmed(field).empty()) continue;
    try {
      row.back() = parse_swept(field);
    } catch (const UsageError&) {
      throw InputError({place, "", "'" + field + "'", "a value as scenes have it"});
    }
  }
  return row;
}

}  // namespace

void SweepCases::add_key(const std::string& text) {
  m_keys.emplace_back(text, m_option);
  for (std::size_t n = 0; n + 1 < m_keys.size(); ++n) {
    if (m_keys[n].text() != text) continue;
    throw UsageError(to_line({"", m_option, "'" + text + "' twice", "each key once"}));
  }
}

void SweepCases::multiply(const std::vector<Row>& rows) {
  if (rows.size() * m_rows.size() > kMostCases) {
    throw UsageError(
        to_line({"", "sweep", with_count(std::int64_t(rows.size() * m_rows.size()), "case"),
                 std::to_string(kMostCases) + " at the most"}));
  }
  std::vector<Row> all;
  for (const Row& before : m_rows) {
    for (const Row& row : rows) {
      all.push_back(before);
      all.back().insert(all.back().end(), row.begin(), row.end());
    }
  }
  m_rows = std::move(all);
}

/// Adds the key of KEY=REST; returns the rest.
std::string SweepCases::take_key(const std::string& text, const char* expected) {
  // A quoted key may hold the sign.
  std::size_t sign = 0;
  for (bool is_quoted = false; sign < text.size() && (is_quoted || text[sign] != '='); ++sign) {
    if (text[sign] == '"') is_quoted = !is_quoted;
  }
  if (sign == text.size()) {
    throw UsageError(to_line({"", m_option, "'" + text + "'", expected}));
  }
  add_key(trimmed(text.substr(0, sign)));
  return text.substr(sign + 1);
}

void SweepCases::vary(const std::string& text) {
  std::vector<Row> rows;
  for (SweptValue& value : parse_swept_list(take_key(text, "KEY=A,B,C"))) {
    rows.push_back({std::move(value)});
  }
  multiply(rows);
}

void SweepCases::set(const std::string& text) {
  multiply({{parse_swept(take_key(text, "KEY=VALUE"), m_option)}});
}

/// Adds the keys of a first line. Returns the place of the column of names among them, or behind
/// them where none is wanted.
std::size_t SweepCases::add_head(const std::vector<std::string>& head, bool has_names,
                                 const std::string& path) {
  std::size_t name_column = head.size();
  for (std::size_t c = 0; c < head.size(); ++c) {
    if (has_names && name_column == head.size() && trimmed(head[c]) == "name") {
      name_column = c;
      continue;
    }
    try {
      add_key(trimmed(head[c]));
    } catch (const UsageError&) {
      throw InputError({path + ":1", "", "'" + head[c] + "'", "keys of the scene, each once"});
    }
  }
  if (has_names && name_column == head.size()) {
    throw InputError({path + ":1", "", "no column 'name'", "one, beside keys of the scene"});
  }
  return name_column;
}

void SweepCases::add_file(const std::string& path, std::vector<std::string>* names) {
  std::string text = text_of_input(path);
  if (text.empty()) throw InputError({path, "", "an empty file", "keys, and a line per case"});
  if (text.rfind("\xEF\xBB\xBF", 0) == 0) text.erase(0, 3);
  std::size_t at = 0;
  const std::vector<std::string> head = take_csv_line(text, at);
  const std::size_t name_column = add_head(head, names != nullptr, path);
  std::vector<Row> rows;
  while (at < text.size()) {
    const auto ends = std::count(text.begin(), text.begin() + std::ptrdiff_t(at), '\n');
    std::vector<std::string> fields = take_csv_line(text, at);
    if (fields.size() == 1 && trimmed(fields.front()).empty()) continue;
    const std::string place = path + ":" + std::to_string(ends + 1);
    if (fields.size() != head.size()) {
      throw InputError({place, "", with_count(std::int64_t(fields.size()), "value"),
                        with_count(std::int64_t(head.size()), "key") + " as the first line has"});
    }
    if (names != nullptr) {
      names->push_back(case_name(fields[name_column], *names, place));
      fields.erase(fields.begin() + std::ptrdiff_t(name_column));
    }
    rows.push_back(row_of(fields, place));
  }
  if (rows.empty()) throw InputError({path, "", "no line below its keys", "a line per case"});
  multiply(rows);
}

std::string SweepCases::title(std::size_t n) const {
  std::string title;
  for (std::size_t k = 0; k < m_keys.size(); ++k) {
    if (!m_rows[n][k]) continue;
    title += (title.empty() ? "" : ", ") + m_keys[k].text() + " = " + m_rows[n][k]->text;
  }
  return title.empty() ? "the scene as it is" : title;
}

std::string SweepCases::short_key(std::size_t key) const {
  std::vector<std::string> keys;
  for (const SceneKey& one : m_keys) keys.push_back(one.text());
  return short_name(keys[key], keys);
}

Value SweepCases::scene_of(std::size_t n, const Value& root, const std::string& scene_file) const {
  Value scene = root;
  std::vector<SetValue> all;
  for (std::size_t k = 0; k < m_keys.size(); ++k) {
    const auto& swept = m_rows[n][k];
    if (!swept) continue;
    const std::size_t before = all.size();
    for (ScenePlace& place : m_keys[k].set(scene, scene_file, swept->value)) {
      all.push_back({k, std::move(place), &swept->value});
    }
    for (std::size_t e = 0; e < before; ++e) {
      for (std::size_t l = before; l < all.size(); ++l) {
        if (agree(all[e], all[l])) continue;
        const std::size_t other = all[e].key;
        throw UsageError(
            to_line({m_keys[other].text() + " = " + m_rows[n][other]->text + ", " +
                         m_keys[k].text() + " = " + swept->text,
                     "", "one value that replaces the other", "keys of different values"}));
      }
    }
  }
  return scene;
}

std::string short_name(const std::string& path, const std::vector<std::string>& paths) {
  for (std::size_t dot = path.rfind('.'); dot != std::string::npos && dot > 0;
       dot = path.rfind('.', dot - 1)) {
    const auto has_end = [&](const std::string& other) {
      return other != path && ends_with("." + other, path.substr(dot));
    };
    if (std::none_of(paths.begin(), paths.end(), has_end)) return path.substr(dot + 1);
  }
  return path;
}

}  // namespace supple::tools
