#include "volumes/base/memory.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <new>
#include <optional>
#include <string>

#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <sys/resource.h>
#include <unistd.h>

namespace supple {

namespace {

/// Reads a line "Name: 123 kB" of a file, in millions of bytes; 0 where there is none.
double line_mb(const char* file, const std::string& name) {
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    if (line.rfind(name, 0) == 0) return std::stod(line.substr(name.size())) * 1024 / 1e6;
  }
  return 0;
}

double status_mb(const std::string& name) {
  return line_mb("/proc/self/status", name);
}

/// Memory that the process's control group leaves, in millions of bytes; none without a limit.
std::optional<double> left_in_group_mb() {
  double limit = 0, taken = 0;
  const std::string folder = "/sys/fs/cgroup/";
  if (!(std::ifstream(folder + "memory.max") >> limit)) return std::nullopt;  // also "max"
  std::ifstream(folder + "memory.current") >> taken;
  return (limit - taken) / 1e6;
}

}  // namespace

double rss_mb() {
  return status_mb("VmRSS:");
}

double peak_rss_mb() {
  // getrusage() would count what the parent held when it started this program.
  return status_mb("VmHWM:");
}

void restart_peak_rss() {
  std::ofstream("/proc/self/clear_refs") << 5;
}

double peak_rss_of_children_mb() {
  rusage usage{};
  ::getrusage(RUSAGE_CHILDREN, &usage);
  return double(usage.ru_maxrss) * 1024e-6;
}

double memory_left_mb() {
  double left = line_mb("/proc/meminfo", "MemAvailable:");
  // Without /proc, such as in a bare chroot: what nobody uses, files that are cached among it or
  // not.
  if (left == 0) left = double(::sysconf(_SC_AVPHYS_PAGES)) * double(::sysconf(_SC_PAGESIZE)) / 1e6;
  if (const std::optional<double> of_group = left_in_group_mb()) left = std::min(left, *of_group);
  rlimit addresses{};
  if (::getrlimit(RLIMIT_AS, &addresses) == 0 && addresses.rlim_cur != RLIM_INFINITY) {
    left = std::min(left, double(addresses.rlim_cur) / 1e6 - status_mb("VmSize:"));
  }
  return std::max(left, 0.0);
}

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
