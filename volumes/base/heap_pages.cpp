#include "volumes/base/heap_pages.h"

#include <cstddef>
#include <cstdlib>

#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <sys/resource.h>
#include <unistd.h>

#include "volumes/base/huge_pages.h"

namespace supple {

namespace {

bool g_keeps_large_pages = false;

#ifdef __GLIBC__
void ask_for_large_pages() {
  constexpr int kHeapBytes = 256 << 20, kLargestInHeap = 32 << 20;
  // Growth by so much at a time is address space until it is touched.
  ::mallopt(M_TOP_PAD, kHeapBytes);
  ::mallopt(M_TRIM_THRESHOLD, 2 * kHeapBytes);
  ::mallopt(M_MMAP_THRESHOLD, kLargestInHeap);
  const auto end_of_heap = [] { return static_cast<char*>(::sbrk(0)); };
  char* const before = end_of_heap();
  // More than a new heap has: it grows. Compilers leave out what is freed unused.
  void* volatile block = std::malloc(kLargestInHeap / 2);
  std::free(block);
  ask_for_huge_pages(before, std::size_t(end_of_heap() - before));
}
#endif

}  // namespace

void keep_heap_in_large_pages() {
#ifdef __GLIBC__
  rlimit addresses{};
  if (::getrlimit(RLIMIT_AS, &addresses) != 0 || addresses.rlim_cur != RLIM_INFINITY) {
    ::mallopt(M_ARENA_MAX, 1);
    return;
  }
  g_keeps_large_pages = true;
  ask_for_large_pages();
#endif
}

void return_free_memory() {
#ifdef __GLIBC__
  ::malloc_trim(0);
  if (g_keeps_large_pages) ask_for_large_pages();
#endif
}

}  // namespace supple
