// Large arrays in pages of 2 MiB, as numpy has them: operator new with the system told so. Voxels
// and unknowns are read in an order that small pages make the processor look up anew at every turn.
//
// Memory is that of malloc(), which operator delete of libstdc++ and libc++ frees. A shared library
// keeps these to itself (cmake/SuppleInstall.cmake), and sanitizers bring their own.
#include <cstdlib>
#include <new>

#include "volumes/base/memory.h"

#if defined(__has_feature)
#define SUPPLE_HAS_FEATURE(name) __has_feature(name)
#else
#define SUPPLE_HAS_FEATURE(name) 0
#endif

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && \
    !SUPPLE_HAS_FEATURE(address_sanitizer) && !SUPPLE_HAS_FEATURE(thread_sanitizer)

namespace {

constexpr std::size_t kLargeBytes = std::size_t(4) << 20;

/// Returns what `allocate` gives, as operator new has to: a new_handler may find more.
template <class Allocate>
void* large_pages_of(std::size_t bytes, Allocate&& allocate) {
  for (;;) {
    if (void* const memory = allocate()) {
      if (bytes >= kLargeBytes) supple::ask_for_huge_pages(memory, bytes);
      return memory;
    }
    const std::new_handler handler = std::get_new_handler();
    if (handler == nullptr) throw std::bad_alloc();
    handler();
  }
}

}  // namespace

void* operator new(std::size_t bytes) {
  return large_pages_of(bytes, [&] { return std::malloc(bytes > 0 ? bytes : 1); });
}

void* operator new(std::size_t bytes, std::align_val_t align) {
  const auto edge = std::size_t(align);
  const std::size_t whole = (bytes + edge - 1) / edge * edge;
  if (whole < bytes) throw std::bad_alloc();
  return large_pages_of(bytes, [&] { return std::aligned_alloc(edge, whole > 0 ? whole : edge); });
}

#endif
