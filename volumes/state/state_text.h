// The parts of a state that are text: geometry and anchors as JSON with numbers that read back to
// the same bits.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "volumes/geometry/geometry.h"

namespace supple {

/// {"axes_mm": [i, j, k vectors], "dims": [3], "origin_lps_mm": [3]}
std::string geometry_to_json(const Geometry& geometry);
/// Throws InputError naming `file` when the text is no geometry.
Geometry geometry_from_json(const std::string& text, const std::string& file);

/// What stays where it is: boxes, both corners inside, then labels.
struct Anchors {
  std::vector<IndexBox> boxes;
  std::vector<std::int32_t> labels;
};
/// [[i0, j0, k0, i1, j1, k1], ..., {"label": n}, ...]
std::string anchors_to_json(const Anchors& anchors);
/// Throws InputError naming `file` when the text is no list of those.
Anchors anchors_from_json(const std::string& text, const std::string& file);

}  // namespace supple
