// A geometry as JSON, with numbers that read back to the same bits.
#pragma once

#include <string>

#include "volumes/geometry/geometry.h"

namespace supple {

/// {"axes_mm": [i, j, k vectors], "dims": [3], "origin_lps_mm": [3]}
std::string geometry_to_json(const Geometry& geometry);
/// Throws InputError naming `file` when the text is no geometry.
Geometry geometry_from_json(const std::string& text, const std::string& file);

}  // namespace supple
