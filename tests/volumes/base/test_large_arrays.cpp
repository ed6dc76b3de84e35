#include <cstdint>
#include <cstdio>
#include <fstream>
#include <new>
#include <string>
#include <vector>

#include <gtest/gtest.h>

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

bool has_large_pages() {
  std::string choices;
  std::getline(std::ifstream("/sys/kernel/mm/transparent_hugepage/enabled"), choices);
  return !choices.empty() && choices.find("[never]") == std::string::npos;
}

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kIsSanitized = true;
#else
constexpr bool kIsSanitized = false;
#endif

}  // namespace

TEST(UnitLargeArrays, LieInLargePages) {
  if (kIsSanitized || !has_large_pages()) GTEST_SKIP() << "no pages of 2 MiB here";
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
  volatile std::size_t count = std::size_t(1) << 58;
  EXPECT_THROW(std::vector<double>{}.reserve(count), std::bad_alloc);
}
