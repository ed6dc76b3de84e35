// Labels of a segmentation by number or by name.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace supple {

constexpr std::int32_t kMaxLabel = 65535;

/// Names of a segmentation's labels, in the order of its file. Names may come twice.
using LabelNames = std::vector<std::pair<std::int32_t, std::string>>;

/// The label that `text` means: the number that it is, 1 to kMaxLabel without leading zeros, or the
/// only one of that name; else nothing.
std::optional<std::int32_t> find_label(const LabelNames& names, const std::string& text);

/// Returns the numbers and the first names, for errors.
std::string expected_label(const LabelNames& names);

}  // namespace supple
