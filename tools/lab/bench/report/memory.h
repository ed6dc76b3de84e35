// Memory that a solver holds and the most it took on the way, measured from outside.
#pragma once

#include <cstdint>
#include <optional>

namespace supple::tools {

/// Bytes that malloc has handed out and not taken back, large mapped blocks included; blocks count
/// in full, whether touched or not.
std::int64_t heap_bytes();

/// Resident size of this process.
std::int64_t resident_bytes();

/// Memory that the system could give this process without swapping.
std::int64_t available_bytes();

/// The largest resident size between construction and growth(), above that at construction. Linux
/// keeps it per process; absent where the process may not reset it.
class PeakMemory {
 public:
  PeakMemory();
  std::optional<std::int64_t> growth() const;

 private:
  bool m_works;
  std::int64_t m_before;
};

}  // namespace supple::tools
