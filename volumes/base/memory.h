// Memory: how much the process holds and may still take, enough of it before libraries run that
// crash where a small allocation fails, and the heap in pages of 2 MiB: the first touch of 4 kB
// pages takes as long as the inversion of their contents. Large arrays are so by themselves
// (large_arrays.cpp).
#pragma once

#include <cstddef>
#include <cstdint>

#include <sys/mman.h>

namespace supple {

/// The resident size of the process, in millions of bytes.
double rss_mb();

/// The largest resident size of the process so far, in millions of bytes. That of the program which
/// started it does not count.
double peak_rss_mb();

/// Lets peak_rss_mb() begin anew, at the present size, where the system allows it.
void restart_peak_rss();

/// The largest resident size of the programs which it has run, up to the present.
double peak_rss_of_children_mb();

/// The memory that the process may still take, in millions of bytes: what is free on the machine,
/// in its control group and under `ulimit -v`.
double memory_left_mb();

/// Throws std::bad_alloc where the process may not map `bytes` more. c-blosc does not look whether
/// it got memory, and OpenVDB's destructors allocate.
void require_memory(std::int64_t bytes);

/// Puts small allocations into pages of 2 MiB from now on, where the system has them, up to 256 MiB
/// of it: the first touch of small pages else takes a third of a run. Not under a limit of
/// addresses, which the heap would use up ahead of its need: threads share one heap then, since
/// each takes 64 MiB or more for its own, and whether that leaves enough is a matter of luck. For
/// programs, not for libraries within them.
void keep_heap_in_large_pages();

/// Pages of memory that is free go back to the system; those that follow are large where a program
/// has kept them so. What lives long, between large arrays that do not, else keeps more and more.
void return_free_memory();

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

}  // namespace supple
