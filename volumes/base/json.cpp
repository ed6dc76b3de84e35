#include "volumes/base/json.h"

#include <cstdio>

#include <nlohmann/json.hpp>

namespace supple {

namespace {

/// Place up to which a text has been read. The parser reads one character beyond a number.
struct Position {
  int line = 1;
  bool is_past_break = false;
};

class PositionCounter {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  PositionCounter(const char* at, Position* position) : m_at(at), m_position(position) {}
  reference operator*() const { return *m_at; }
  PositionCounter& operator++() {
    m_position->is_past_break = *m_at++ == '\n';
    m_position->line += int(m_position->is_past_break);
    return *this;
  }
  bool operator==(const PositionCounter& other) const { return m_at == other.m_at; }
  bool operator!=(const PositionCounter& other) const { return m_at != other.m_at; }

 private:
  const char* m_at;
  Position* m_position;
};

/// Builds the tree while the text is parsed.
class TreeBuilder : public nlohmann::json_sax<nlohmann::json> {
 public:
  TreeBuilder(int deepest, const Position& position) : m_deepest(deepest), m_position(position) {}

  Value take() { return std::move(m_root); }
  bool is_too_deep() const { return m_is_too_deep; }

  bool null() override { return add({}); }
  bool boolean(bool value) override { return add(value); }
  bool number_integer(number_integer_t value) override { return add(value); }
  bool number_unsigned(number_unsigned_t value) override {
    return value <= std::uint64_t(INT64_MAX) ? add(value) : add(double(value));
  }
  bool number_float(number_float_t value, const string_t&) override { return add(value); }
  bool string(string_t& value) override { return add(std::move(value)); }
  bool binary(binary_t&) override { return false; }
  bool start_object(std::size_t) override { return open(Value::Entries()); }
  bool key(string_t& value) override { return m_key = std::move(value), true; }
  bool end_object() override { return close(); }
  bool start_array(std::size_t) override { return open(Value::List()); }
  bool end_array() override { return close(); }
  bool parse_error(std::size_t, const std::string&, const nlohmann::json::exception&) override {
    return false;
  }

 private:
  Value& place(Value value) {
    const bool is_beyond = value.is_number() && m_position.is_past_break;
    value.line = m_position.line - int(is_beyond);
    if (m_open.empty()) return m_root = std::move(value);
    Value& parent = *m_open.back();
    if (parent.is_list()) return parent.push_back(std::move(value));
    return parent[m_key] = std::move(value);
  }
  bool add(Value value) { return place(std::move(value)), true; }
  /// A pointer stays good while its value is open: only the innermost one grows.
  bool open(Value value) {
    m_is_too_deep = int(m_open.size()) > m_deepest;
    if (!m_is_too_deep) m_open.push_back(&place(std::move(value)));
    return !m_is_too_deep;
  }
  bool close() { return m_open.pop_back(), true; }

  int m_deepest;
  const Position& m_position;
  bool m_is_too_deep = false;
  Value m_root;
  std::vector<Value*> m_open;
  std::string m_key;
};

/// Bytes that are not UTF-8 become U+FFFD.
std::string quoted(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

void write_json(const Value& value, int indent, int depth, std::string& text) {
  const auto new_line = [&](int columns) {
    if (indent > 0) text += "\n" + std::string(std::size_t(columns * indent), ' ');
  };
  const auto write_each = [&](const auto& all, char first, char last, const auto& write_one) {
    text += first;
    bool is_first = true;
    for (const auto& one : all) {
      if (!std::exchange(is_first, false)) text += ',';
      new_line(depth + 1);
      write_one(one);
    }
    if (!is_first) new_line(depth);
    text += last;
  };
  if (value.is_list()) {
    write_each(value.items(), '[', ']',
               [&](const Value& item) { write_json(item, indent, depth + 1, text); });
  } else if (value.is_table()) {
    write_each(value.entries(), '{', '}', [&](const Value::Entry& entry) {
      text += quoted(entry.key) + (indent > 0 ? ": " : ":");
      write_json(entry.value, indent, depth + 1, text);
    });
  } else if (value.is_null()) {
    text += "null";
  } else if (value.is_truth()) {
    text += value.truth() ? "true" : "false";
  } else if (value.is_whole()) {
    text += std::to_string(value.whole());
  } else if (value.is_number()) {
    text += nlohmann::json(value.number()).dump();
  } else {
    text += quoted(value.text());
  }
}

}  // namespace

Value parse_json(std::string_view text, int deepest) {
  Position position;
  TreeBuilder builder(deepest, position);
  const PositionCounter first(text.data(), &position), last(text.data() + text.size(), &position);
  if (nlohmann::json::sax_parse(first, last, &builder)) return builder.take();
  throw JsonError(builder.is_too_deep() ? "lists within lists" : "not JSON", builder.is_too_deep());
}

Value json_or_null(std::string_view text) {
  try {
    return parse_json(text);
  } catch (const JsonError&) {
    return {};
  }
}

std::string json_text(const Value& value, int indent) {
  std::string text;
  write_json(value, indent, 0, text);
  return text;
}

std::string json_string(const std::string& text) {
  std::string json = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') json += '\\';
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) {
      char escape[8];
      std::snprintf(escape, sizeof escape, "\\u%04x", unsigned(c));
      json += escape;
    } else {
      json += c;
    }
  }
  return json + "\"";
}

}  // namespace supple
