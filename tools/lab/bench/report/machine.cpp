#include "tools/lab/bench/report/machine.h"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <limits>
#include <memory>
#include <thread>

#include "volumes/base/parallel.h"

namespace supple::tools {

namespace {

constexpr std::size_t kTriadElements = std::size_t(8) << 20;
constexpr int kTriadRuns = 12;

std::string cpu_name() {
  std::ifstream stream("/proc/cpuinfo");
  for (std::string line; std::getline(stream, line);) {
    if (line.rfind("model name", 0) != 0) continue;
    const std::size_t value = line.find_first_not_of(" \t", line.find(':') + 1);
    return value == std::string::npos ? "" : line.substr(value);
  }
  return "unknown";
}

const char* compiled_isa() {
#if defined(__AVX512VBMI2__)
  return "avx512 (vbmi2)";
#elif defined(__AVX512BW__)
  return "avx512";
#elif defined(__AVX2__)
  return "avx2";
#elif defined(__AVX__)
  return "avx";
#elif defined(__SSE4_2__)
  return "sse4.2";
#elif defined(__x86_64__)
  return "sse2";
#else
  return "generic";
#endif
}

/// Three arrays, initialised; the first run warms up and is not counted.
class Triad {
 public:
  double best_gb_s() {
    double best = std::numeric_limits<double>::infinity();
    run();
    for (int n = 0; n < kTriadRuns; ++n) best = std::min(best, run());
    return 24.0 * kTriadElements / best * 1e-9;
  }

 private:
  double run() {
    const auto begin = std::chrono::steady_clock::now();
    parallel_shares(kTriadElements, [a = m_a.get(), b = m_b.get(), c = m_c.get()](std::size_t first,
                                                                                  std::size_t end) {
      for (std::size_t n = first; n < end; ++n) a[n] = b[n] + 3.0 * c[n];
    });
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }

  static std::unique_ptr<double[]> filled() {
    std::unique_ptr<double[]> values(new double[kTriadElements]);
    std::fill_n(values.get(), kTriadElements, 1.0);
    return values;
  }
  std::unique_ptr<double[]> m_a = filled(), m_b = filled(), m_c = filled();
};

}  // namespace

MachineFacts measure_machine() {
  MachineFacts facts;
  facts.cpu = cpu_name();
  facts.cores = int(std::thread::hardware_concurrency());
  facts.isa = compiled_isa();
  Triad triad;
  facts.triad_gb_s = triad.best_gb_s();
  const ThreadLimit one(1);
  facts.triad_one_thread_gb_s = triad.best_gb_s();
  return facts;
}

}  // namespace supple::tools
