#include "volumes/base/repeated_lines.h"

#include <algorithm>

namespace supple {

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

}  // namespace supple
