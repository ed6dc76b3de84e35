// Numbers, voxels and counts as messages show them.
#pragma once

#include <cstdint>
#include <string>

#include "volumes/base/vec.h"

namespace supple {

/// "1 cell", "2 cells".
std::string with_count(std::int64_t count, const std::string& what);

/// "1,2,3".
std::string to_text(const Vec3i& v);
/// With six significant digits.
std::string to_text(const Vec3d& v);

}  // namespace supple
