#include "tools/console/own_process.h"

#include <filesystem>
#include <fstream>

#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

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

double processor_seconds() {
  timespec time{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

double loading_seconds() {
  return kLoadingSeconds;
}

}  // namespace supple::tools
