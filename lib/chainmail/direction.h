// The two ways in which an envelope moves offsets (design.md section 3).
#pragma once

namespace supple {

/// raise: up to the least envelope L; lower: down to the greatest envelope U.
enum class Direction { raise, lower };

}  // namespace supple
