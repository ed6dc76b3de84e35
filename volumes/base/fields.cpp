#include "volumes/base/fields.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "volumes/base/error.h"
#include "volumes/base/json.h"
#include "volumes/base/text.h"

namespace supple {

namespace {

/// A number that needs no point is a whole one, as in a file.
Value number_value(double number) {
  const std::string text = exact_text(number);
  std::int64_t whole = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), whole);
  const bool is_whole = read.ec == std::errc() && read.ptr == text.data() + text.size();
  return is_whole ? Value(whole) : Value(number);
}

struct ToValue {
  Value operator()(const bool* value) const { return *value; }
  Value operator()(const int* value) const { return *value; }
  Value operator()(const double* value) const { return number_value(*value); }
  Value operator()(const std::string* value) const {
    return value->empty() ? Value() : Value(*value);
  }
  Value operator()(const Vec3d* v) const {
    return Value::List{number_value(v->x), number_value(v->y), number_value(v->z)};
  }
  Value operator()(const NumberPair* v) const {
    return Value::List{number_value(v->first), number_value(v->second)};
  }
  Value operator()(const PixelSize* v) const { return *v; }
  Value operator()(const Rgb* rgb) const { return colour_text(*rgb); }
  Value operator()(const std::vector<std::string>* values) const {
    return values->empty() ? Value() : Value(*values);
  }
  Value operator()(const Field::Names& names) const {
    return names.names.at(std::size_t(names.get()));
  }
  template <class Setting>
  Value operator()(const std::optional<Setting>* value) const {
    return *value ? (*this)(&**value) : Value();
  }
};

/// Shortest numbers, and text as it is.
std::string text_of(const Value& value) {
  if (value.is_null()) return "";
  if (value.is_text()) return value.text();
  if (value.is_truth()) return value.truth() ? "true" : "false";
  if (value.is_whole()) return std::to_string(value.whole());
  if (value.is_number()) return exact_text(value.number());
  std::string list;
  for (const Value& item : value.items()) {
    list +=
        (list.empty() ? "[" : ", ") + (item.is_text() ? json_string(item.text()) : text_of(item));
  }
  return list + "]";
}

}  // namespace

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

bool Field::names_file(const std::string& text) const {
  return m_traits.is_path && std::find(m_words.begin(), m_words.end(), text) == m_words.end();
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
  const std::string unit = m_traits.unit.empty() ? "" : " " + m_traits.unit;
  if (!names().empty()) return listed(names(), "or");
  if (m_is_open) return "a positive number" + (m_traits.unit.empty() ? "" : " of" + unit);
  if (m_lo > -std::numeric_limits<double>::infinity()) {
    if (m_hi < std::numeric_limits<double>::infinity()) {
      return bound_text(m_lo) + " to " + bound_text(m_hi) + unit;
    }
    return bound_text(m_lo) + " or more" + unit;
  }
  return m_traits.unit;
}

std::string Field::placeholder() const {
  if (!m_traits.placeholder.empty()) return m_traits.placeholder;
  if (!names().empty()) {
    std::string text;
    for (const std::string& name : names()) text += (text.empty() ? "" : "|") + name;
    return text.size() <= 40 ? text : "NAME";
  }
  if (m_traits.is_path) return "FILE";
  if (holds<Vec3d>()) return "X,Y,Z";
  if (holds<NumberPair>()) return "A,B";
  if (holds<PixelSize>()) return "W,H";
  if (holds<Rgb>()) return "#RRGGBB";
  if (holds<std::string>()) return "TEXT";
  if (holds<std::vector<std::string>>()) return "A,B,...";
  const bool is_word =
      !m_traits.unit.empty() && m_traits.unit.find_first_of(" /") == std::string::npos;
  std::string text = is_word ? m_traits.unit : "N";
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return char(std::toupper(c)); });
  return text;
}

Value Field::value() const {
  return std::visit(ToValue(), m_target);
}

std::string Field::text() const {
  return text_of(value());
}

std::string Field::default_text() const {
  if (m_otherwise) return *m_otherwise;
  return m_traits.is_required ? "" : text();
}

Value fields_value(const Fields& fields, const Fields& plain) {
  Value table = Value::Entries();
  for (std::size_t n = 0; n < fields.size(); ++n) {
    const Value value = fields[n].value();
    if (value.is_null() || (!plain.empty() && value == plain[n].value())) continue;
    const FieldTraits& traits = fields[n].traits();
    table[traits.record.empty() ? traits.name : traits.record] = value;
  }
  return table;
}

}  // namespace supple
