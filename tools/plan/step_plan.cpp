// The rows of one step: the fields that it needs, and the model that moves the body.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "tools/plan/plan_ledger.h"
#include "tools/scene/run_step.h"
#include "volumes/grid/labels.h"

namespace supple::tools {

namespace {

constexpr double kRelaxBytes = 18, kVolumeBytes = 25;  // per element that moves (docs/models)
constexpr double kSpringBytes = 456, kSpringsOfElement = 12;
constexpr double kFemBytes = 103;         // per unknown
constexpr double kMotionBytes = 170;      // more, with mass, damping and what moves
constexpr double kNodesOfElement = 1.12;  // of a head; of one slice twice as many
constexpr double kLinearIterations = 60, kNewtonSystems = 12;
/// Of the iterations of an equilibrium, those of a step of time.
constexpr double kMotionPart = 0.2;

std::string axis_name(int coordinate) {
  return std::string(1, "ijk"[coordinate]);
}

/// The elements that a drag grabs and the longest way of any, per coordinate. Nothing where it
/// waits for pieces that the step makes.
std::optional<PlannedGrip> grip_of(const Drag& drag, const Session& session, const State& state) {
  const Body& body = session.body();
  if (drag.selection && drag.selection->rigid_at && body.rigid.empty()) return std::nullopt;
  SlotSet slots;
  if (drag.selection) {
    slots = elements_of(body, region_of(*drag.selection, body, state.density, "grab"), "grab");
  } else if (drag.label != 0) {
    slots = slots_in_mask(body.elements, label_mask(state.elements, state.labels, drag.label));
  } else {
    slots = elements_of(body, drag.region, "grab");
  }
  PlannedGrip grip{std::move(slots), {0, 0, 0}};
  const auto take = [&](const HandleMotion& motion, const Vec3d& by_mm) {
    Displacements ways;
    if (motion.is_shift()) {
      ways = {fixed_from_mm(by_mm, body.geometry.spacing_mm())};
    } else {
      ways = displacements_of(body, grip.elements, motion, by_mm);
    }
    for (const auto& way : ways) {
      for (std::size_t c = 0; c < 3; ++c) {
        if (std::abs(way[c]) > std::abs(grip.by_q[c])) grip.by_q[c] = way[c];
      }
    }
  };
  for (const DragPose& pose : drag.way) take(pose.motion, pose.by_mm);
  take(drag.motion, drag.by_mm);
  return grip;
}

/// With the bricks around, so many times.
void grow(std::vector<std::uint8_t>& bricks, const BrickTopology& elements, int rings) {
  for (int ring = 0; ring < rings; ++ring) {
    const std::vector<std::uint8_t> before = bricks;
    for (std::size_t b = 0; b < before.size(); ++b) {
      for (int face = 0; before[b] == 0 && face < 6; ++face) {
        const std::int32_t beside = elements.neighbour(b, face);
        if (beside >= 0 && before[std::size_t(beside)] != 0) bricks[b] = 1;
      }
    }
  }
}

/// One step while its rows are made.
class StepPlan {
 public:
  StepPlan(const SceneStep& step, int number, const Session& session, const State& state,
           const UnitCosts& costs, PlanLedger& ledger)
      : m_stage("step " + std::to_string(number)),
        m_session(session),
        m_state(state),
        m_costs(costs),
        m_ledger(ledger),
        m_request(request_of(step, session.geometry())) {}

  MovedBricks plan(const MovedBricks& before);

 private:
  double elements() const { return double(m_session.body().elements.active_count()); }
  void add(const std::string& what, const std::string& why, double held_bytes, double brief_bytes,
           double ns) {
    m_ledger.add({m_stage, what, why, held_bytes / kMegabyte, brief_bytes / kMegabyte, ns * 1e-9});
  }
  void move_all(MovedBricks& moved, const std::string& why);
  MovedBricks drag(const MovedBricks& before);
  void relax(MovedBricks& moved);
  void springs();
  void finite_elements();

  std::string m_stage;
  const Session& m_session;
  const State& m_state;
  const UnitCosts& m_costs;
  PlanLedger& m_ledger;
  StepRequest m_request;
};

void StepPlan::move_all(MovedBricks& moved, const std::string& why) {
  const BrickTopology& bricks = m_session.body().elements;
  for (int c = 0; c < 3; ++c) {
    const double fresh = double(bricks.brick_count()) - double(moved.count(c));
    moved.add_all(c, bricks);
    add("coordinate " + axis_name(c) + " of " + bricks_text(double(bricks.brick_count())), why,
        fresh * kBrickBytes4, 0, 0);
  }
}

MovedBricks StepPlan::drag(const MovedBricks& before) {
  std::vector<PlannedGrip> grips;
  for (const Drag& drag : m_request.drags) {
    if (auto grip = grip_of(drag, m_session, m_state)) grips.push_back(std::move(*grip));
  }
  if (grips.size() < m_request.drags.size()) {
    m_ledger.leave_out(m_stage + ": the reach of " +
                           std::to_string(m_request.drags.size() - grips.size()) + " handles",
                       "they grab pieces that the step makes");
  }
  const MovedBricks moved = reach_of(m_session.body(), grips);
  for (int c = 0; c < 3; ++c) {
    if (!moved.moves(c)) {
      m_ledger.leave_out(m_stage + ": coordinate " + axis_name(c), "no handle moves along it");
      continue;
    }
    const double bricks = double(moved.count(c)), known = double(before.count(c));
    const double count = moved.elements[std::size_t(c)];
    add("coordinate " + axis_name(c) + " of " + bricks_text(bricks) + ", " +
            count_text(count, "elements"),
        "Enhanced ChainMail: a handle moves along it", std::max(0.0, bricks - known) * kBrickBytes4,
        bricks * kBrickBytes4, count * m_costs.ecm_element);
  }
  return moved;
}

void StepPlan::relax(MovedBricks& moved) {
  const bool is_default = !m_request.relax && !m_request.no_relax && !m_request.drags.empty() &&
                          m_request.limits != Limits::ball && m_session.material().relaxes;
  if (!m_request.relax && !is_default) {
    m_ledger.leave_out(m_stage + ": stiffness, relaxation",
                       m_request.no_relax ? "no_relax = true" : "the step asks for none");
    return;
  }
  const RelaxParams params = m_request.relax ? *m_request.relax : tissue_relaxation();
  const bool conserves = params.bulk_modulus_kpa > 0 || params.poisson;
  double passes = params.passes, count = 0, bricks = 0;
  for (int c = 0; c < 3; ++c) {
    if (!moved.moves(c) && !conserves) continue;
    auto& of = moved.bricks[std::size_t(c)];
    of.resize(m_session.body().elements.brick_count(), 0);
    grow(of, m_session.body().elements, std::min(64, 1 + int(passes) / 4));
    double elements = 0;
    for (std::size_t b = 0; b < of.size(); ++b) {
      if (of[b] != 0) elements += mask_count(m_session.body().elements.mask(b));
    }
    moved.elements[std::size_t(c)] = elements;
    count += elements;
    bricks += double(moved.count(c));
  }
  if (params.budget_million > 0 && count > 0) {
    passes = std::min(passes, params.budget_million * 1e6 / count);
  }
  const double ns = conserves ? count / 3 * m_costs.volume_element : count * m_costs.relax_element;
  const double bytes = bricks * kBrickVoxels * (conserves ? kVolumeBytes : kRelaxBytes);
  add("stiffness and up to " + count_text(passes, "passes"),
      m_request.relax ? "the step asks for relaxation" : "the material relaxes what is dragged",
      bricks * kBrickVoxels * 2, bytes, ns * passes);
}

void StepPlan::springs() {
  const SpringStep& springs = *m_request.springs;
  const double steps = springs.is_motion() ? springs.motion_steps() : springs.most_steps;
  const double count = elements() * kSpringsOfElement;
  add(count_text(count, "springs") + ", " + count_text(steps, "steps"),
      "the step moves the body by springs", 0, elements() * kSpringBytes,
      count * steps * m_costs.spring);
}

void StepPlan::finite_elements() {
  const bool is_slice = m_session.geometry().dims().z == 1;
  const double parts = std::pow(8, m_request.fem->halvings);
  const double unknowns = 3 * elements() * parts * (is_slice ? 2.1 : kNodesOfElement);
  const bool is_finite = m_request.fem->params.strain == StrainTheory::finite;
  const std::optional<MotionStep>& motion = m_request.fem->motion;
  const double systems = is_finite ? kNewtonSystems : motion ? motion->steps() * kMotionPart : 1;
  add(count_text(unknowns, "unknowns") + ", some " +
          count_text(systems * kLinearIterations, "iterations"),
      "the step moves the body by finite elements", 0,
      unknowns * (kFemBytes + (motion ? kMotionBytes : 0)),
      unknowns * systems * kLinearIterations * m_costs.fem_unknown);
}

MovedBricks StepPlan::plan(const MovedBricks& before) {
  MovedBricks moved = before;
  if (m_request.springs || m_request.fem) {
    move_all(moved, m_request.fem ? "finite elements move every node" : "springs move every node");
    if (m_request.fem) {
      finite_elements();
    } else {
      springs();
    }
    return moved;
  }
  moved.add(drag(before));
  relax(moved);
  return moved;
}

}  // namespace

MovedBricks plan_step(const SceneStep& step, int number, const Session& session, const State& state,
                      const MovedBricks& before, const UnitCosts& costs, PlanLedger& ledger) {
  return StepPlan(step, number, session, state, costs, ledger).plan(before);
}

}  // namespace supple::tools
