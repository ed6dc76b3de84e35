// Stored values of any type as numbers.
#pragma once

#include <cstddef>

#include "volumes/io/volume_file.h"

namespace supple {

/// values[n] = slope * stored[n] + intercept; `stored` need not be aligned.
using ScaleValues = void (*)(const char* stored, std::size_t count, double slope, double intercept,
                             double* values);
ScaleValues scale_values_of(ValueType type);

}  // namespace supple
