#include "volumes/base/memory_limit.h"

#include <algorithm>
#include <fstream>
#include <new>

#include <sys/mman.h>
#include <unistd.h>

namespace supple {

namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kIsSanitized = true;  // these end the process where memory is refused
#elif defined(__has_feature)
constexpr bool kIsSanitized = __has_feature(address_sanitizer) || __has_feature(thread_sanitizer);
#else
constexpr bool kIsSanitized = false;
#endif

/// Bytes that the process has mapped; 0 when that is not known.
std::int64_t mapped_bytes() {
  std::int64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * ::sysconf(_SC_PAGESIZE);
}

}  // namespace

MemoryLimit::MemoryLimit(std::int64_t bytes) {
  if (kIsSanitized) return;
  const std::int64_t mapped = mapped_bytes();
  if (mapped == 0 || ::getrlimit(RLIMIT_AS, &m_before) != 0) return;
  rlimit limit = m_before;
  limit.rlim_cur = std::min<rlim_t>(m_before.rlim_cur, rlim_t(mapped + bytes));
  m_is_set = ::setrlimit(RLIMIT_AS, &limit) == 0;
}

MemoryLimit::~MemoryLimit() {
  if (m_is_set) ::setrlimit(RLIMIT_AS, &m_before);
}

std::int64_t parser_memory(std::int64_t file_bytes) {
  constexpr std::int64_t kLeast = std::int64_t(1) << 30;
  constexpr std::int64_t kMost = std::int64_t(1) << 46;
  return kLeast + std::min(kMost, file_bytes * 256);
}

void require_memory(std::int64_t bytes) {
  void* const pages = ::mmap(nullptr, std::size_t(bytes), PROT_NONE,
                             MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (pages == MAP_FAILED) {
    // As operator new does: the handler may give back what it keeps for the unwinding.
    if (const std::new_handler handler = std::get_new_handler()) handler();
    throw std::bad_alloc();
  }
  ::munmap(pages, std::size_t(bytes));
}

}  // namespace supple
