#include "tools/console/own_process.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <malloc.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include "volumes/base/huge_pages.h"

namespace supple::tools {

std::string own_program() {
  return std::filesystem::read_symlink("/proc/self/exe").string();
}

namespace {

/// Of a line "Name:  123 kB", in millions of bytes; 0 where there is none.
double status_mb(const std::string& name) {
  std::ifstream stream("/proc/self/status");
  for (std::string line; std::getline(stream, line);) {
    if (line.rfind(name, 0) == 0) return std::stod(line.substr(name.size())) * 1024 / 1e6;
  }
  return 0;
}

const double kLoadingSeconds = processor_seconds();

}  // namespace

double rss_mb() {
  return status_mb("VmRSS:");
}

double peak_rss_mb() {
  // getrusage() would count what the parent held when it started this program.
  return status_mb("VmHWM:");
}

double peak_rss_of_children_mb() {
  rusage usage{};
  ::getrusage(RUSAGE_CHILDREN, &usage);
  return double(usage.ru_maxrss) * 1024e-6;
}

void keep_heap_in_large_pages() {
#ifdef __GLIBC__
  rlimit addresses{};
  if (::getrlimit(RLIMIT_AS, &addresses) != 0 || addresses.rlim_cur != RLIM_INFINITY) return;
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
#endif
}

void return_free_memory() {
  ::malloc_trim(0);
  keep_heap_in_large_pages();
}

double processor_seconds() {
  timespec time{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

double loading_seconds() {
  return kLoadingSeconds;
}

}  // namespace supple::tools
