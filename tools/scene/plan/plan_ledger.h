// Rows of a plan as they come, with what the process holds after each and the most so far.
#pragma once

#include "tools/scene/plan/moved_bricks.h"
#include "tools/scene/plan/scene_plan.h"
#include "volumes/base/units.h"

namespace supple::tools {

constexpr double kBrickBytes4 = 4.0 * kBrickVoxels;    // of a number per voxel
constexpr double kBrickBytes12 = 12.0 * kBrickVoxels;  // of a vector per voxel

class PlanLedger {
 public:
  PlanLedger(ScenePlan& plan, const PlanSubject& subject);

  void add(PlanRow row);
  /// Counts memory as no longer held.
  void give_back(double mb) { m_held_mb -= mb; }
  void leave_out(const std::string& what, const std::string& why) {
    m_plan.gaps.push_back({what, why});
  }

 private:
  ScenePlan& m_plan;
  double m_held_mb;
};

/// Writes "1,234 bricks".
std::string bricks_text(double count);
/// Writes "12.3 million elements".
std::string count_text(double count, const std::string& what);

/// The rows of a step, and what it moves. `links`: per element, of the scene's material.
MovedBricks plan_step(const Step& step, int number, int links, const Session& session,
                      const State& state, const MovedBricks& before, const UnitCosts& costs,
                      PlanLedger& ledger);

}  // namespace supple::tools
