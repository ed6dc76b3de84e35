// Labels of a segmentation at the elements of a body: BrickValues on the bricks of the elements, 1
// to kMaxLabel, 0 where there is none. Memory: 2 kB per brick that holds a label.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "volumes/base/text.h"
#include "volumes/grid/brick_values.h"

namespace supple {

/// Number of elements that each label has, 0 left out. One pass over the stored bricks.
std::map<std::int32_t, std::int64_t> label_counts(const BrickValues& labels);

/// The elements of one label. One pass over the stored bricks.
BrickTopology label_mask(const BrickTopology& elements, const BrickValues& labels,
                         std::int32_t label);

/// Throws InputError, naming `field`, unless some element has the label.
void require_label(const BrickValues& labels, std::int32_t label, const std::string& field);

}  // namespace supple
