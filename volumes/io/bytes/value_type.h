// Element types of files, and stored values of any type as numbers.
#pragma once

#include <cstddef>
#include <string>

namespace supple {

/// Element types of files; names as numpy's.
enum class ValueType { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };
const char* numpy_name(ValueType type);
/// False when `name` is none of numpy's names in ValueType.
bool find_numpy_type(const std::string& name, ValueType& type);
int bytes_of(ValueType type);

/// values[n] = slope * stored[n] + intercept; `stored` need not be aligned.
using ScaleValues = void (*)(const char* stored, std::size_t count, double slope, double intercept,
                             double* values);
ScaleValues scale_values_of(ValueType type);

/// Stores values the other way: rounded (halves away from zero) and clamped for integer types,
/// where NaN becomes 0; `out` need not be aligned.
void store_values(ValueType type, const float* values, std::size_t count, char* out);
void store_values(ValueType type, const double* values, std::size_t count, char* out);

}  // namespace supple
