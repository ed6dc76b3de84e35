#include "volumes/base/text.h"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <numeric>

#include "volumes/base/error.h"

namespace supple {

std::string with_count(std::int64_t count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

namespace {

/// Levenshtein distance.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t(0));
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] != b[j - 1]);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, replaced});
    }
  }
  return row[b.size()];
}

}  // namespace

std::string nearest_name(const std::string& name, const std::vector<std::string>& names) {
  std::string nearest;
  std::size_t best = std::min<std::size_t>(4, name.size());
  for (const std::string& known : names) {
    const std::size_t distance = edit_distance(name, known);
    if (distance >= best) continue;
    best = distance;
    nearest = known;
  }
  return nearest;
}

std::string exact_text(double value) {
  char digits[32];
  return {digits, std::to_chars(digits, digits + sizeof digits, value).ptr};
}

std::string base64_of(std::string_view bytes) {
  static constexpr char kDigits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned bits = 0;
    for (std::size_t n = 0; n < 3; ++n) {
      bits = bits << 8 | (i + n < bytes.size() ? std::uint8_t(bytes[i + n]) : 0u);
    }
    for (std::size_t n = 0; n < 4; ++n) {
      text += i + n <= bytes.size() ? kDigits[bits >> (18 - 6 * n) & 63] : '=';
    }
  }
  return text;
}

std::string decimal_text(double value, int places) {
  char text[350];
  std::snprintf(text, sizeof text, "%.*f", places, value);
  return text;
}

std::string to_text(const Vec3i& v, const char* between) {
  return std::to_string(v.x) + between + std::to_string(v.y) + between + std::to_string(v.z);
}

std::string to_text(const Vec3d& v, const char* between) {
  return number_text(v.x) + between + number_text(v.y) + between + number_text(v.z);
}

bool ends_with(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

namespace {

/// Replaces every run of digits, points and signs of exponents by one '#'.
std::string without_numbers(const std::string& line) {
  std::string kind;
  for (const char c : line) {
    const bool is_digit = c >= '0' && c <= '9';
    const bool goes_on = !kind.empty() && kind.back() == '#';
    if (is_digit && !goes_on) kind += '#';
    if (!is_digit && !(goes_on && c == '.')) kind += c;
  }
  return kind;
}

/// Writes "1 to 5, 7".
std::string ranges_text(std::vector<int> numbers) {
  std::sort(numbers.begin(), numbers.end());
  std::string text;
  for (std::size_t n = 0; n < numbers.size();) {
    std::size_t end = n + 1;
    while (end < numbers.size() && numbers[end] == numbers[end - 1] + 1) ++end;
    text += (text.empty() ? "" : ", ") + std::to_string(numbers[n]);
    if (end - n > 1) text += (end - n > 2 ? " to " : ", ") + std::to_string(numbers[end - 1]);
    n = end;
  }
  return text;
}

}  // namespace

std::optional<std::string> RepeatedLines::take(const std::string& line) {
  const auto [entry, is_new] = m_kind_of.try_emplace(without_numbers(line), m_kinds.size());
  if (is_new) {
    m_kinds.push_back({line, m_number, {}});
    return m_what + " " + std::to_string(m_number) + ": " + line;
  }
  Kind& kind = m_kinds[entry->second];
  const auto end = kind.repeats.end();
  if (m_number != kind.number && std::find(kind.repeats.begin(), end, m_number) == end) {
    kind.repeats.push_back(m_number);
  }
  return std::nullopt;
}

std::vector<std::string> RepeatedLines::repeats() const {
  std::vector<std::string> lines;
  for (const Kind& kind : m_kinds) {
    if (kind.repeats.empty()) continue;
    const std::string what = m_what + (kind.repeats.size() > 1 ? "s " : " ");
    lines.push_back(what + ranges_text(kind.repeats) + ": as " + m_what + " " +
                    std::to_string(kind.number) + ", perhaps with other numbers: " + kind.first);
  }
  return lines;
}

std::optional<std::int32_t> find_label(const LabelNames& names, const std::string& text) {
  std::int32_t number = 0;
  std::from_chars(text.data(), text.data() + text.size(), number);
  if (number >= 1 && number <= kMaxLabel && std::to_string(number) == text) return number;
  const auto is_meant = [&](const auto& label) { return label.second == text; };
  if (std::count_if(names.begin(), names.end(), is_meant) != 1) return std::nullopt;
  return std::find_if(names.begin(), names.end(), is_meant)->first;
}

std::string expected_label(const LabelNames& names) {
  constexpr std::size_t kListed = 5;
  std::string text = "a label, 1 to " + std::to_string(kMaxLabel);
  for (std::size_t n = 0; n < std::min(names.size(), kListed); ++n) {
    text += (n == 0 ? ", or the name of one segment: " : ", ") + names[n].second;
  }
  return names.size() > kListed ? text + ", …" : text;
}

}  // namespace supple
