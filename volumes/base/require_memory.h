// A check of memory before libraries run that crash where a small allocation fails: c-blosc's do
// not look, and OpenVDB's destructors allocate.
#pragma once

#include <cstdint>

namespace supple {

/// Throws std::bad_alloc where the process may not map `bytes` more.
void require_memory(std::int64_t bytes);

}  // namespace supple
