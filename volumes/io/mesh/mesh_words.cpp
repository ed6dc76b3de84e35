#include <charconv>
#include <cmath>

#include "volumes/base/error.h"
#include "volumes/io/bytes/text_header.h"
#include "volumes/io/mesh/mesh_formats.h"

namespace supple {

namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v';
}

}  // namespace

std::string_view MeshWords::next_on_line() {
  while (m_position < m_text.size() && is_blank(m_text[m_position])) ++m_position;
  const std::size_t first = m_position;
  while (m_position < m_text.size() && !is_blank(m_text[m_position]) &&
         m_text[m_position] != '\n') {
    ++m_position;
  }
  return m_text.substr(first, m_position - first);
}

std::string_view MeshWords::next() {
  while (true) {
    const std::string_view word = next_on_line();
    if (!word.empty() || m_position >= m_text.size()) return word;
    skip_line();
  }
}

void MeshWords::skip_line() {
  const std::size_t newline = m_text.find('\n', m_position);
  m_position = newline == std::string_view::npos ? m_text.size() : newline + 1;
  ++m_line;
}

void MeshWords::expect(std::string_view word) {
  const std::string_view found = next();
  if (lower_case(std::string(found)) != word) fail(found, std::string(word));
}

double MeshWords::number(std::string_view word) const {
  std::string_view digits = word;
  if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
  double value = 0;
  const char* end = digits.data() + digits.size();
  const auto [stop, error] = std::from_chars(digits.data(), end, value);
  if (error != std::errc() || stop != end) fail(word, "a number");
  return value;
}

Vec3d MeshWords::vector() {
  Vec3d v;
  for (int a = 0; a < 3; ++a) v[a] = number();
  return v;
}

Vec3d MeshWords::vector(VectorSlot& slots) {
  Vec3d v;
  for (int a = 0; a < 3; ++a) {
    const std::string_view word = next();
    v[a] = number(word);
    slots[std::size_t(a)] = slot_of(word);
  }
  return v;
}

std::int64_t MeshWords::count(std::string_view word) const {
  const double value = number(word);
  if (!(value >= 0 && value < 2147483647) || value != std::floor(value)) {
    fail(word, "a count from 0 to 2147483646");
  }
  return std::int64_t(value);
}

void MeshWords::fail(std::string_view found, const std::string& expected) const {
  throw InputError({m_path, "line " + std::to_string(m_line),
                    found.empty() ? "nothing" : printable(std::string(found)), expected});
}

void add_polygon(const std::vector<int>& polygon, TriangleMesh& mesh) {
  for (std::size_t n = 2; n < polygon.size(); ++n) {
    mesh.triangles.push_back({polygon[0], polygon[n - 1], polygon[n]});
  }
}

void add_polyline(const std::vector<int>& polyline, MeshLines& lines) {
  for (std::size_t n = 1; n < polyline.size(); ++n) {
    lines.push_back({polyline[n - 1], polyline[n]});
  }
}

}  // namespace supple
