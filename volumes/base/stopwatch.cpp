#include "volumes/base/stopwatch.h"

#include <ctime>

namespace supple {

namespace {

const double kLoadingSeconds = processor_seconds();

}  // namespace

double processor_seconds() {
  timespec now{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

double loading_seconds() {
  return kLoadingSeconds;
}

double ms_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

Stopwatch::Stopwatch(std::chrono::steady_clock::time_point started)
    : m_start(started), m_cpu_ms(1e3 * processor_seconds()) {}

double Stopwatch::cpu_ms() const {
  return 1e3 * processor_seconds() - m_cpu_ms;
}

}  // namespace supple
