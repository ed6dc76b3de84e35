#include "tools/console/filter_progress.h"

#include <cstdio>
#include <cstdlib>

#include "tools/scene/chart/template.h"

namespace supple::tools {

FilterProgress::FilterProgress() {
  const char* const kind = std::getenv("SUPPLE_PROGRESS");
  m_prints = kind != nullptr && std::string(kind) == "slicer";
}

void FilterProgress::begin(const std::string& stage) {
  if (!m_prints) return;
  end();
  m_stage = html_text(stage);
  m_told = 0;
  m_start = std::chrono::steady_clock::now();
  std::printf(
      "<filter-start>\n<filter-name>%s</filter-name>\n<filter-comment>%s</filter-comment>\n"
      "</filter-start>\n",
      m_stage.c_str(), m_stage.c_str());
  std::fflush(stdout);
}

void FilterProgress::update(double fraction) {
  constexpr double kLeastStep = 0.01;
  if (!m_prints || m_stage.empty() || fraction < m_told + kLeastStep) return;
  m_told = fraction;
  std::printf("<filter-progress>%.2f</filter-progress>\n", fraction);
  std::fflush(stdout);
}

void FilterProgress::end() {
  if (m_stage.empty()) return;
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - m_start).count();
  std::printf(
      "<filter-end>\n<filter-name>%s</filter-name>\n<filter-time>%.3f</filter-time>\n"
      "</filter-end>\n",
      m_stage.c_str(), seconds);
  std::fflush(stdout);
  m_stage.clear();
}

}  // namespace supple::tools
