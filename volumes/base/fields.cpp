#include "volumes/base/fields.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "volumes/base/error.h"
#include "volumes/base/text.h"

namespace supple {

namespace {

std::string list_of(std::initializer_list<double> values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "[" : ", ") + exact_text(value);
  return text + "]";
}

/// The value as JSON, which is also how scene files write it; empty where there is none.
struct JsonText {
  std::string operator()(const bool* value) const { return *value ? "true" : "false"; }
  std::string operator()(const int* value) const { return std::to_string(*value); }
  std::string operator()(const double* value) const { return exact_text(*value); }
  std::string operator()(const std::string* value) const {
    return value->empty() ? "" : json_string(*value);
  }
  std::string operator()(const Vec3d* v) const { return list_of({v->x, v->y, v->z}); }
  std::string operator()(const NumberPair* v) const { return list_of({v->first, v->second}); }
  std::string operator()(const PixelSize* v) const {
    return list_of({double((*v)[0]), double((*v)[1])});
  }
  std::string operator()(const Rgb* rgb) const { return json_string(colour_text(*rgb)); }
  std::string operator()(const std::vector<std::string>* values) const {
    std::string text;
    for (const std::string& value : *values)
      text += (text.empty() ? "[" : ", ") + json_string(value);
    return text.empty() ? "" : text + "]";
  }
  std::string operator()(const Field::Names& names) const {
    return json_string(names.names.at(std::size_t(names.get())));
  }
  template <class Value>
  std::string operator()(const std::optional<Value>* value) const {
    return *value ? (*this)(&**value) : "";
  }
};

}  // namespace

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

std::string colour_text(const Rgb& rgb) {
  char text[8];
  const auto byte = [](double share) { return unsigned(std::lround(share * 255)); };
  std::snprintf(text, sizeof text, "#%02X%02X%02X", byte(rgb[0]), byte(rgb[1]), byte(rgb[2]));
  return text;
}

std::optional<Rgb> parse_colour(const std::string& text) {
  if (text.size() != 7 || text[0] != '#') return std::nullopt;
  Rgb rgb;
  for (int c = 0; c < 3; ++c) {
    unsigned value = 0;
    const char* first = text.data() + 1 + 2 * c;
    const auto result = std::from_chars(first, first + 2, value, 16);
    if (result.ec != std::errc() || result.ptr != first + 2) return std::nullopt;
    rgb[c] = value / 255.0;
  }
  return rgb;
}

std::string listed(const std::vector<std::string>& names, const char* last) {
  std::string text;
  for (std::size_t n = 0; n < names.size(); ++n) {
    if (n > 0) text += n + 1 == names.size() ? std::string(" ") + last + " " : ", ";
    text += names[n];
  }
  return text;
}

const std::vector<std::string>& Field::names() const {
  const auto* choice = std::get_if<Names>(&m_target);
  return choice != nullptr ? choice->names : m_names;
}

std::string Field::name_for(const std::string& word) const {
  const auto found = m_synonyms.find(word);
  return found == m_synonyms.end() ? word : found->second;
}

bool Field::is_word(const std::string& text) const {
  return std::find(m_words.begin(), m_words.end(), text) != m_words.end();
}

bool Field::allows(double value) const {
  return value >= m_lo && value <= m_hi && !(m_is_open && value == m_lo);
}

namespace {

/// Whole numbers with all their digits.
std::string bound_text(double bound) {
  const bool is_whole = std::abs(bound) < 1e15 && bound == std::floor(bound);
  return is_whole ? std::to_string((long long)bound) : number_text(bound);
}

}  // namespace

std::string Field::allowed() const {
  const std::string unit = m_unit.empty() ? "" : " " + m_unit;
  if (!names().empty()) return listed(names(), "or");
  if (m_is_open) return "a positive number" + (m_unit.empty() ? "" : " of" + unit);
  if (m_lo > -std::numeric_limits<double>::infinity()) {
    if (m_hi < std::numeric_limits<double>::infinity()) {
      return bound_text(m_lo) + " to " + bound_text(m_hi) + unit;
    }
    return bound_text(m_lo) + " or more" + unit;
  }
  return m_unit;
}

std::string Field::placeholder() const {
  if (!m_placeholder.empty()) return m_placeholder;
  if (!names().empty()) {
    std::string text;
    for (const std::string& name : names()) text += (text.empty() ? "" : "|") + name;
    return text.size() <= 40 ? text : "NAME";
  }
  if (m_is_path) return "FILE";
  if (holds<Vec3d>()) return "X,Y,Z";
  if (holds<NumberPair>()) return "A,B";
  if (holds<PixelSize>()) return "W,H";
  if (holds<Rgb>()) return "#RRGGBB";
  if (holds<std::string>()) return "TEXT";
  if (holds<std::vector<std::string>>()) return "A,B,...";
  const bool is_word = !m_unit.empty() && m_unit.find_first_of(" /") == std::string::npos;
  std::string text = is_word ? m_unit : "N";
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return char(std::toupper(c)); });
  return text;
}

std::string Field::json() const {
  return std::visit(JsonText(), m_target);
}

std::string Field::text() const {
  const std::string text = json();
  const bool is_quoted = text.size() >= 2 && text.front() == '"';
  return is_quoted ? text.substr(1, text.size() - 2) : text;
}

std::string Field::default_text() const {
  if (m_otherwise) return *m_otherwise;
  return m_is_required ? "" : text();
}

std::string fields_json(const Fields& fields, const Fields& plain) {
  std::string text;
  for (std::size_t n = 0; n < fields.size(); ++n) {
    const Field& field = fields[n];
    const std::string value = field.json();
    if (!plain.empty() && value == plain[n].json()) continue;
    if (!value.empty())
      text += (text.empty() ? "" : ",") + json_string(field.record()) + ":" + value;
  }
  return "{" + text + "}";
}

}  // namespace supple
