#include "volumes/base/own_process.h"

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <optional>
#include <system_error>

#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include "volumes/base/error.h"

namespace supple {

std::string own_program() {
  return std::filesystem::read_symlink("/proc/self/exe").string();
}

std::string program_beside(const std::string& name) {
  const auto program = std::filesystem::path(own_program()).parent_path() / name;
  return std::filesystem::exists(program) ? program.string() : "";
}

std::string require_program_beside(const std::string& name) {
  const std::string program = program_beside(name);
  if (!program.empty()) return program;
  const auto folder = std::filesystem::path(own_program()).parent_path();
  throw SystemError((folder / name).string() + ": this program is missing");
}

void become_program(const std::string& program, const std::vector<std::string>& arguments) {
  std::vector<char*> words;
  for (const std::string& argument : arguments)
    words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  ::execv(program.c_str(), words.data());
  throw SystemError(program + ": " + std::generic_category().message(errno));
}

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

double memory_left_mb() {
  double left = line_mb("/proc/meminfo", "MemAvailable:");
  if (const std::optional<double> of_group = left_in_group_mb()) left = std::min(left, *of_group);
  rlimit addresses{};
  if (::getrlimit(RLIMIT_AS, &addresses) == 0 && addresses.rlim_cur != RLIM_INFINITY) {
    left = std::min(left, double(addresses.rlim_cur) / 1e6 - status_mb("VmSize:"));
  }
  return std::max(left, 0.0);
}

double processor_seconds() {
  timespec time{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

double loading_seconds() {
  return kLoadingSeconds;
}

}  // namespace supple
