#include "tools/lab/bench/report/memory.h"

#include <fstream>
#include <string>

#include <malloc.h>

#include "volumes/base/memory.h"

namespace supple::tools {

namespace {

/// The value of a "Name:  123 kB" line in bytes; 0 when there is none.
std::int64_t read_kilobytes(const char* file, const std::string& name) {
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    if (line.rfind(name + ":", 0) == 0) return std::stoll(line.substr(name.size() + 1)) * 1024;
  }
  return 0;
}

}  // namespace

std::int64_t heap_bytes() {
  const struct mallinfo2 info = ::mallinfo2();
  return std::int64_t(info.uordblks + info.hblkhd);
}

std::int64_t resident_bytes() {
  return read_kilobytes("/proc/self/status", "VmRSS");
}

std::int64_t available_bytes() {
  return read_kilobytes("/proc/meminfo", "MemAvailable");
}

PeakMemory::PeakMemory() {
  return_free_memory();
  std::ofstream reset("/proc/self/clear_refs");
  m_works = bool(reset << "5" << std::flush);
  m_before = resident_bytes();
}

std::optional<std::int64_t> PeakMemory::growth() const {
  if (!m_works) return std::nullopt;
  return read_kilobytes("/proc/self/status", "VmHWM") - m_before;
}

}  // namespace supple::tools
