// As under the program's MemoryLimit (volumes/base/memory_limit.h), which address sanitizer rules
// out: what a damaged file claims beyond 1 GiB in one allocation is refused by an exception.
#include <cstdlib>
#include <new>

namespace {

constexpr std::size_t kMostBytes = std::size_t(1) << 30;

void* bounded(std::size_t bytes) {
  void* const memory = bytes > kMostBytes ? nullptr : std::malloc(bytes > 0 ? bytes : 1);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

void* operator new(std::size_t bytes) {
  return bounded(bytes);
}
void* operator new[](std::size_t bytes) {
  return bounded(bytes);
}
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
  return std::malloc(bytes);
}
void* operator new[](std::size_t bytes, const std::nothrow_t&) noexcept {
  return std::malloc(bytes);
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete[](void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
  std::free(memory);
}
