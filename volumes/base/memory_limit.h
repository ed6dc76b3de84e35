// A bound on the memory of third-party parsers that allocate what a damaged file claims (OpenVDB's
// strings).
#pragma once

#include <cstdint>

#include <sys/resource.h>

namespace supple {

/// While it lives the process may map at most `bytes` more than at the start, so that allocations
/// beyond them fail: std::bad_alloc or null. For the whole process, other threads included; so only
/// around parsing. A stricter limit of the user's stays. Does nothing where /proc cannot be read,
/// and under address or thread sanitizers.
class MemoryLimit {
 public:
  explicit MemoryLimit(std::int64_t bytes);
  ~MemoryLimit();
  MemoryLimit(const MemoryLimit&) = delete;
  MemoryLimit& operator=(const MemoryLimit&) = delete;

 private:
  bool m_is_set = false;
  rlimit m_before{};
};

/// What parsing a file of that many bytes may take: 1 GiB and 256 times its size.
std::int64_t parser_memory(std::int64_t file_bytes);

/// Throws std::bad_alloc where the process may not map `bytes` more. Asked before libraries run
/// that crash where a small allocation fails: c-blosc's do not look, and OpenVDB's destructors
/// allocate.
void require_memory(std::int64_t bytes);

}  // namespace supple
