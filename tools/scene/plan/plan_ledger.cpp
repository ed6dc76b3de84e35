#include "tools/scene/plan/plan_ledger.h"

#include <algorithm>
#include <cstdio>

namespace supple::tools {

PlanLedger::PlanLedger(ScenePlan& plan, const PlanSubject& subject)
    : m_plan(plan), m_held_mb(subject.held_mb) {
  plan.peak_mb = subject.peak_mb;
}

void PlanLedger::add(PlanRow row) {
  m_held_mb += row.held_mb;
  m_plan.peak_mb = std::max(m_plan.peak_mb, m_held_mb + row.brief_mb);
  m_plan.seconds += row.seconds;
  m_plan.rows.push_back(std::move(row));
}

std::string count_text(double count, const std::string& what) {
  char text[64];
  if (count >= 1e6) {
    std::snprintf(text, sizeof text, "%.1f million ", count / 1e6);
  } else {
    std::snprintf(text, sizeof text, "%.0f ", count);
  }
  std::string words = what;
  if (std::string(text) == "1 " && words.back() == 's') words.pop_back();
  return text + words;
}

std::string bricks_text(double count) {
  return count_text(count, "bricks");
}

}  // namespace supple::tools
