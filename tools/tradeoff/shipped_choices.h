// Methods for scenes that have no table of `supple tradeoff`: what each did on the loads of
// docs/tradeoff.md, carried over to another size and another way of the handles.
#pragma once

#include <cstdint>
#include <vector>

#include "tools/tradeoff/method_choice.h"

namespace supple::tools {

/// By ascending time. The times are those of two cores, per voxel of the volume; the errors, 95th
/// percentiles, are parts of the way of the handle. Both are the worst of all loads.
std::vector<MethodChoice> shipped_choices(std::int64_t voxels, double way_mm);

}  // namespace supple::tools
