#include "tools/scene/run/stage_times.h"

#include <algorithm>

#include "volumes/base/stopwatch.h"
#include "volumes/base/units.h"

namespace supple::tools {

void StageTimes::begin(std::string_view name) {
  end();
  m_stage = name;
  m_start = std::chrono::steady_clock::now();
}

void StageTimes::end() {
  if (m_stage.empty()) return;
  const double seconds = ms_since(m_start) * kSPerMs;
  const auto known = std::find_if(m_seconds.begin(), m_seconds.end(),
                                  [&](const auto& stage) { return stage.first == m_stage; });
  if (known == m_seconds.end()) {
    m_seconds.emplace_back(m_stage, seconds);
  } else {
    known->second += seconds;
  }
  m_stage.clear();
}

}  // namespace supple::tools
