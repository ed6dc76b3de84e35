#include "volumes/base/label_names.h"

#include <algorithm>
#include <charconv>

namespace supple {

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
