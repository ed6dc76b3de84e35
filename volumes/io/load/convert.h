// From one dense file to another, slice by slice: stored values pass through as they are wherever
// the output can hold them. Cost: one slice of memory, and the formats' own.
#pragma once

#include <string>
#include <vector>

#include "volumes/base/progress.h"
#include "volumes/io/format/dense_writer.h"

namespace supple {

/// Values of the output, by type and scaling.
struct ConvertPlan {
  ValueType type = ValueType::float32;
  double slope = 1;  // recorded in the output
  double intercept = 0;
  bool applies_scaling = false;  // values are slope * stored + intercept of the input
};

/// Stored values stay where the input has no slope and intercept or the output records them
/// (keeps_scaling). Otherwise scaled values are written: in the narrowest integer type of the same
/// width or wider that holds `minimum` to `maximum` when stored values, slope and intercept are
/// integers, else as float32, or float64 for inputs that a float does not hold.
ConvertPlan plan_conversion(const VolumeHeader& input, const std::string& output, double minimum,
                            double maximum);

/// Copies scalars or vectors. `input` is read from its first slice on. Returns the writer's
/// warnings. Throws as open_volume and create_dense; Cancelled.
std::vector<std::string> convert(VolumeFile& input, const ConvertPlan& plan,
                                 const std::string& output, const WriteOptions& options = {},
                                 Progress* progress = nullptr);

}  // namespace supple
