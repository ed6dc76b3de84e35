#include "tools/scene/chart/template.h"

#include <cstdio>
#include <stdexcept>

namespace supple::tools {

std::string html_text(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      case '\'':
        safe += "&#39;";
        break;
      default:
        safe += (c >= 0 && c < 0x20 && c != '\n') ? '?' : c;
    }
  }
  return safe;
}

namespace {

bool is_there(const Value& value) {
  if (value.is_text()) return !value.text().empty();
  if (value.is_list() || value.is_table()) return !value.empty();
  return !value.is_null() && value != false;
}

std::string text_of_value(const Value& value) {
  if (value.is_text()) return value.text();
  if (value.is_whole()) return std::to_string(value.whole());
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value.number());
  return text;
}

class TemplateFill {
 public:
  TemplateFill(std::string_view text, const Value& values) : m_text(text), m_tables{&values} {}

  std::string all() {
    part(0, true);
    return std::move(m_out);
  }

 private:
  const Value* find(const std::string& name) const {
    if (name == ".") return m_tables.back();
    for (auto table = m_tables.rbegin(); table != m_tables.rend(); ++table) {
      if (const Value* value = (*table)->is_table() ? (*table)->find(name) : nullptr) return value;
    }
    return nullptr;
  }

  /// Writes up to the end of the section, or of the text; returns the place behind it.
  std::size_t part(std::size_t at, bool is_shown) {
    for (;;) {
      const std::size_t open = m_text.find("{{", at);
      if (is_shown) m_out += m_text.substr(at, open - at);
      if (open == m_text.npos) return m_text.size();
      const std::size_t close = m_text.find("}}", open);
      const char kind = m_text[open + 2];
      const bool is_section = kind == '#' || kind == '^' || kind == '/';
      const std::size_t begin = open + (is_section || kind == '&' ? 3 : 2);
      const std::string name(m_text.substr(begin, close - begin));
      at = close + 2;
      const bool is_alone = (open == 0 || m_text[open - 1] == '\n') && m_text.substr(at, 1) == "\n";
      if (is_section && is_alone) ++at;
      if (kind == '/') return at;
      if (is_section) {
        at = section(name, kind == '^', at, is_shown);
      } else if (is_shown) {
        const Value* value = find(name);
        if (value == nullptr) throw std::out_of_range("template: no value '" + name + "'");
        m_out += kind == '&' ? text_of_value(*value) : html_text(text_of_value(*value));
      }
    }
  }

  std::size_t section(const std::string& name, bool is_of_absence, std::size_t at, bool is_shown) {
    const Value* value = find(name);
    const bool is_absent = value == nullptr || !is_there(*value);
    if (!is_shown || is_absent != is_of_absence) return part(at, false);
    if (is_absent) return part(at, true);
    std::size_t end = at;
    const auto one = [&](const Value& item) {
      m_tables.push_back(&item);
      end = part(at, true);
      m_tables.pop_back();
    };
    if (value->is_list()) {
      for (const Value& item : value->items()) one(item);
    } else {
      one(*value);
    }
    return end;
  }

  std::string_view m_text;
  std::vector<const Value*> m_tables;  // the innermost last
  std::string m_out;
};

}  // namespace

std::string filled(std::string_view text, const Value& values) {
  return TemplateFill(text, values).all();
}

}  // namespace supple::tools
