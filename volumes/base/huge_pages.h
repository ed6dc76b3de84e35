// Large arrays in pages of 2 MiB where the system offers them: the first touch of 4 kB pages takes
// as long as the inversion of their contents.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <sys/mman.h>

namespace supple {

/// Asks that the pages of memory not yet touched be large. Nothing changes where the system does
/// not know them.
inline void ask_for_huge_pages(void* memory, std::size_t bytes) {
#ifdef MADV_HUGEPAGE
  constexpr std::size_t kHugePage = std::size_t(1) << 21;
  const std::size_t before = -reinterpret_cast<std::uintptr_t>(memory) % kHugePage;
  if (bytes < before + kHugePage) return;
  const std::size_t whole = (bytes - before) / kHugePage * kHugePage;
  // A hint: it may fail without harm.
  (void)::madvise(static_cast<char*>(memory) + before, whole, MADV_HUGEPAGE);
#else
  (void)memory, (void)bytes;
#endif
}

/// An empty vector with room for `count` elements, in large pages.
template <class T>
std::vector<T> reserve_in_huge_pages(std::size_t count) {
  std::vector<T> vector;
  vector.reserve(count);
  ask_for_huge_pages(vector.data(), count * sizeof(T));
  return vector;
}

}  // namespace supple
