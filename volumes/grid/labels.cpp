#include "volumes/grid/labels.h"

#include "volumes/base/error.h"

namespace supple {

std::map<std::int32_t, std::int64_t> label_counts(const BrickValues& labels) {
  std::map<std::int32_t, std::int64_t> counts;
  for (std::size_t b = 0; b < labels.brick_count(); ++b) {
    const std::int32_t* values = labels.brick(b);
    if (values == nullptr) continue;
    // Runs of the same label are counted at once.
    for (int offset = 0, end = 0; offset < kBrickVoxels; offset = end) {
      while (end < kBrickVoxels && values[end] == values[offset]) ++end;
      if (values[offset] != 0) counts[values[offset]] += end - offset;
    }
  }
  return counts;
}

BrickTopology label_mask(const BrickTopology& elements, const BrickValues& labels,
                         std::int32_t label) {
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  for (std::size_t b = 0; b < labels.brick_count(); ++b) {
    const std::int32_t* values = labels.brick(b);
    if (values == nullptr) continue;
    BrickMask mask{};
    for (int offset = 0; offset < kBrickVoxels; ++offset) {
      if (values[offset] == label) mask_set(mask, offset);
    }
    if (mask_count(mask) == 0) continue;
    origins.push_back(elements.origin(b));
    masks.push_back(mask);
  }
  return {std::move(origins), std::move(masks)};
}

void require_label(const BrickValues& labels, std::int32_t label, const std::string& field) {
  const auto counts = label_counts(labels);
  if (counts.count(label) != 0) return;
  std::string found = "no labels";
  if (!counts.empty()) {
    found = "labels from " + std::to_string(counts.begin()->first) + " to " +
            std::to_string(counts.rbegin()->first) + " without it";
  }
  throw InputError(
      {"", field + " label:" + std::to_string(label), found, "a label that elements have"});
}

}  // namespace supple
