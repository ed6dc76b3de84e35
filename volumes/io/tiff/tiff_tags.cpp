#include "volumes/io/tiff/tiff_tags.h"

#include <cmath>
#include <utility>

namespace supple {

namespace {

void append(std::string& text, std::uint64_t value, int bytes) {
  text.append(reinterpret_cast<const char*>(&value), std::size_t(bytes));
}

}  // namespace

void TiffDirectory::add(TiffTag tag, TiffType type, const std::vector<std::uint64_t>& values) {
  const int width = type == tiff_short ? 2 : type == tiff_long8 ? 8 : 4;
  std::string bytes;
  for (const std::uint64_t value : values) append(bytes, value, width);
  m_fields.push_back({tag, type, type == tiff_rational ? values.size() / 2 : values.size(), bytes});
}

void TiffDirectory::add(TiffTag tag, const std::string& text) {
  m_fields.push_back({tag, tiff_ascii, text.size() + 1, text + '\0'});
}

std::string TiffDirectory::bytes_at(std::uint64_t place, bool is_last) const {
  const std::size_t inline_bytes = m_is_big ? 8 : 4;
  const std::size_t size = m_is_big ? 8 + 20 * m_fields.size() + 8 : 2 + 12 * m_fields.size() + 4;
  std::string text, values;
  append(text, m_fields.size(), m_is_big ? 8 : 2);
  for (const Field& field : m_fields) {
    append(text, field.tag, 2);
    append(text, field.type, 2);
    append(text, field.count, int(inline_bytes));
    if (field.bytes.size() <= inline_bytes) {
      text += field.bytes + std::string(inline_bytes - field.bytes.size(), '\0');
      continue;
    }
    append(text, place + size + values.size(), int(inline_bytes));
    values += field.bytes;
    values.resize((values.size() + 7) / 8 * 8, '\0');
  }
  std::size_t end = size + values.size();
  end = (end + 7) / 8 * 8;
  append(text, is_last ? 0 : place + end, int(inline_bytes));
  text += values;
  text.resize(end, '\0');
  return text;
}

std::vector<std::uint64_t> tiff_resolution(double spacing_mm) {
  constexpr double kMax = 4294967295.0;
  double p = 1, p_before = 0, q = 0, q_before = 1, rest = spacing_mm;
  for (int n = 0; n < 40; ++n) {
    const double whole = std::floor(rest);
    const double p_next = whole * p + p_before, q_next = whole * q + q_before;
    if (p_next > kMax || q_next > kMax) break;
    p_before = std::exchange(p, p_next);
    q_before = std::exchange(q, q_next);
    if (std::abs(p / q - spacing_mm) <= 1e-15 * spacing_mm || rest == whole) break;
    rest = 1 / (rest - whole);
  }
  if (q == 0) return {1, std::uint64_t(kMax)};  // voxels of thousands of km
  if (p == 0) return {std::uint64_t(kMax), 1};
  return {std::uint64_t(q), std::uint64_t(p)};
}

}  // namespace supple
