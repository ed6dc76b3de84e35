// Large arrays in pages of 2 MiB where the system offers them: the first touch of 4 kB pages takes
// as long as the inversion of their contents.
#pragma once

#include <cstdint>
#include <vector>

#include <sys/mman.h>

namespace supple {

/// An empty vector with room for `count` elements, whose pages are asked to be large. Nothing else
/// changes where the system does not know them.
template <class T>
std::vector<T> reserve_in_huge_pages(std::size_t count) {
  constexpr std::uintptr_t kHugePage = std::uintptr_t(1) << 21;
  std::vector<T> vector;
  vector.reserve(count);
#ifdef MADV_HUGEPAGE
  const auto begin = reinterpret_cast<std::uintptr_t>(vector.data());
  const std::uintptr_t lo = (begin + kHugePage - 1) & ~(kHugePage - 1);
  const std::uintptr_t hi = (begin + count * sizeof(T)) & ~(kHugePage - 1);
  // A hint: it may fail without harm.
  if (lo < hi) (void)::madvise(reinterpret_cast<void*>(lo), hi - lo, MADV_HUGEPAGE);
#endif
  return vector;
}

}  // namespace supple
