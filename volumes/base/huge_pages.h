// Large arrays in pages of 2 MiB where the system offers them: the first touch of 4 kB pages takes
// as long as the inversion of their contents.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <sys/mman.h>

namespace supple {

/// A hint, which may fail without harm, for the whole pages of 2 MiB of memory not yet touched.
inline void advise_huge_pages(void* memory, std::size_t bytes, int advice) {
  constexpr std::size_t kHugePage = std::size_t(1) << 21;
  const std::size_t before = -reinterpret_cast<std::uintptr_t>(memory) % kHugePage;
  if (bytes < before + kHugePage) return;
  const std::size_t whole = (bytes - before) / kHugePage * kHugePage;
  (void)::madvise(static_cast<char*>(memory) + before, whole, advice);
}

/// Asks that the pages be large.
inline void ask_for_huge_pages(void* memory, std::size_t bytes) {
  advise_huge_pages(memory, bytes, MADV_HUGEPAGE);
}

/// Asks that they be small, for an array of which little will be touched.
inline void ask_for_small_pages(void* memory, std::size_t bytes) {
  advise_huge_pages(memory, bytes, MADV_NOHUGEPAGE);
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
