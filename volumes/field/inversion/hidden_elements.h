// Elements that an offset field does not show. Something else is read where they went, since
// offsets hold one place of several and are interpolated between nodes.
#pragma once

#include <cstdint>
#include <functional>

#include "volumes/field/offset_field.h"

namespace supple {

/// Number of elements X that are not seen at X + u(X): the place that is read there lies more than
/// a voxel from X, or none is read. `displacement`: on all elements; `offsets`: its inverse. Where
/// some of the nodes around X + u(X) hold no offset, the others count. Cost: about 10 ns per moved
/// element, 50 ns where offsets are split, 1 ns per unmoved one.
/// `wants`: the bricks in which there are offsets (invert.h); elements that went elsewhere do not
/// count. Null: all.
std::int64_t count_hidden(const Displacement& displacement, const BrickTopology& elements,
                          const OffsetField& offsets,
                          const std::function<bool(const Vec3i& origin)>& wants = {});

}  // namespace supple
