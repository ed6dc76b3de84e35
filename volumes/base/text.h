// Numbers, voxels and counts as messages show them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "volumes/base/vec.h"

namespace supple {

/// Writes "1 cell", "2 cells".
std::string with_count(std::int64_t count, const std::string& what);

/// The name with the fewest edits (Levenshtein) to `name`, at most three and fewer than it has
/// characters; empty where none is that near.
std::string nearest_name(const std::string& name, const std::vector<std::string>& names);

/// The shortest decimal number that reads back to the same bits.
std::string exact_text(double value);

/// Writes "1,2,3".
std::string to_text(const Vec3i& v);
/// Writes a vector with six significant digits.
std::string to_text(const Vec3d& v);

}  // namespace supple
