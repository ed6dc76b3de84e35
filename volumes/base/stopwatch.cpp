#include "volumes/base/stopwatch.h"

#include <ctime>

namespace supple {

namespace {

double process_cpu_ms() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return double(now.tv_sec) * 1e3 + double(now.tv_nsec) * 1e-6;
}

}  // namespace

double ms_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

Stopwatch::Stopwatch(std::chrono::steady_clock::time_point started)
    : m_start(started), m_cpu_ms(process_cpu_ms()) {}

double Stopwatch::cpu_ms() const {
  return process_cpu_ms() - m_cpu_ms;
}

}  // namespace supple
