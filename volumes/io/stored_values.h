// Stored values of any type as numbers.
#pragma once

#include <cstddef>

#include "volumes/io/volume_file.h"

namespace supple {

/// values[n] = slope * stored[n] + intercept; `stored` need not be aligned.
using ScaleValues = void (*)(const char* stored, std::size_t count, double slope, double intercept,
                             double* values);
ScaleValues scale_values_of(ValueType type);

/// The other way: rounded (halves away from zero) and clamped for integer types, where NaN becomes
/// 0; `out` need not be aligned.
void store_values(ValueType type, const float* values, std::size_t count, char* out);
void store_values(ValueType type, const double* values, std::size_t count, char* out);

}  // namespace supple
