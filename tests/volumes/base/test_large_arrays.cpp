#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <new>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <sys/mman.h>

#include "tests/support/sanitized.h"

using namespace supple::test;

namespace {

/// The kB of large pages in the part of memory that holds this place; -1: the system does not say.
long large_pages_kb(const void* place) {
  std::ifstream maps("/proc/self/smaps");
  const auto at = reinterpret_cast<std::uintptr_t>(place);
  bool is_here = false;
  for (std::string line; std::getline(maps, line);) {
    unsigned long begin = 0, end = 0;
    long kb = 0;
    if (std::sscanf(line.c_str(), "%lx-%lx ", &begin, &end) == 2) is_here = begin <= at && at < end;
    if (is_here && std::sscanf(line.c_str(), "AnonHugePages: %ld", &kb) == 1) return kb;
  }
  return -1;
}

/// True where the system gives large pages to who asks for them, and has some left.
bool has_large_pages() {
  constexpr std::size_t kBytes = std::size_t(32) << 20;
  void* const pages =
      ::mmap(nullptr, kBytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (pages == MAP_FAILED) return false;
  (void)::madvise(pages, kBytes, MADV_HUGEPAGE);
  std::memset(pages, 1, kBytes);
  const bool has = large_pages_kb(static_cast<char*>(pages) + kBytes / 2) >= 16 << 10;
  ::munmap(pages, kBytes);
  return has;
}

}  // namespace

TEST(UnitLargeArrays, LieInLargePages) {
  LEFT_OUT_WHEN_SANITIZED();
  if (kSanitized || !has_large_pages()) GTEST_SKIP() << "no pages of 2 MiB here";
  const std::vector<double> values(std::size_t(8) << 20, 1.0);  // more than goes into the heap
  EXPECT_GE(large_pages_kb(values.data() + values.size() / 2), 32 << 10);
  struct alignas(64) Lanes {
    float of[16] = {};
  };
  const std::vector<Lanes> lanes(std::size_t(1) << 20);
  EXPECT_GE(large_pages_kb(lanes.data() + lanes.size() / 2), 32 << 10);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(lanes.data()) % 64, 0u);
}

TEST(UnitLargeArrays, MoreThanThereIsIsRefused) {
  LEFT_OUT_WHEN_SANITIZED();
  if (kSanitized) GTEST_SKIP() << "the sanitizer ends the program";
  volatile std::size_t count = std::size_t(1) << 58;
  EXPECT_THROW(std::vector<double>{}.reserve(count), std::bad_alloc);
}
