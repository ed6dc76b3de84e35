// The function by which drawings ask where tissue came from.
#pragma once

#include <functional>

#include "volumes/base/vec.h"

namespace supple {

/// The index position at which the tissue that is seen at a place was at rest; false where none is.
using RestPlaceAt = std::function<bool(const Vec3d& index, Vec3d& at_rest)>;

}  // namespace supple
