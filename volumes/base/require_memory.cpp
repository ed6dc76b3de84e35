#include "volumes/base/require_memory.h"

#include <new>

#include <sys/mman.h>

namespace supple {

void require_memory(std::int64_t bytes) {
  void* const pages = ::mmap(nullptr, std::size_t(bytes), PROT_NONE,
                             MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (pages == MAP_FAILED) {
    // Like operator new, asks the handler, which may give back what it keeps for the unwinding.
    if (const std::new_handler handler = std::get_new_handler()) handler();
    throw std::bad_alloc();
  }
  ::munmap(pages, std::size_t(bytes));
}

}  // namespace supple
