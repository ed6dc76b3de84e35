// Units of length as files name them.
#pragma once

#include <optional>
#include <string>

namespace supple {

/// Millimetres of a unit by any of its names, in any case of letters ("um", "microns", "Inch");
/// nothing for what is no length or none that scanners and microscopes use.
std::optional<double> mm_per_unit(const std::string& unit);

}  // namespace supple
