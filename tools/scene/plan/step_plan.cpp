// The rows of one step: the fields that it needs, and the model that moves the body.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>

#include "lib/body/body_cost.h"
#include "lib/chainmail/ecm_cost.h"
#include "lib/relax/relax_cost.h"
#include "lib/session/cut_surface.h"
#include "lib/session/handles/handle_motion.h"
#include "lib/session/rigid_request.h"
#include "tools/scene/plan/model_plan.h"
#include "tools/scene/plan/plan_ledger.h"
#include "volumes/field/inversion/inversion_cost.h"
#include "volumes/grid/labels.h"
#include "volumes/grid/voxel_sets.h"

namespace supple::tools {

namespace {

/// A joint is parted on both sides, and its bricks fall into more pieces than those of a cut: of
/// the bricks that move, at least this part.
constexpr double kJointSides = 2, kJointPart = 0.25;

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

/// Adds the bricks around.
void grow(std::vector<std::uint8_t>& bricks, const BrickTopology& elements) {
  const std::vector<std::uint8_t> before = bricks;
  for (std::size_t b = 0; b < before.size(); ++b) {
    for (int face = 0; before[b] == 0 && face < 6; ++face) {
      const std::int32_t beside = elements.neighbour(b, face);
      if (beside >= 0 && before[std::size_t(beside)] != 0) bricks[b] = 1;
    }
  }
}

/// A step of the plan while its rows are made.
class StepPlan {
 public:
  StepPlan(const Step& step, int number, int links, const Session& session, const State& state,
           const UnitCosts& costs, PlanLedger& ledger)
      : m_stage("step " + std::to_string(number)),
        m_links(links),
        m_session(session),
        m_state(state),
        m_costs(costs),
        m_ledger(ledger),
        m_request(on_grid(step, session.geometry())) {}

  MovedBricks plan(const MovedBricks& before);

 private:
  double elements() const { return double(m_session.body().elements.active_count()); }
  void add(const std::string& what, const std::string& why, double held_bytes, double brief_bytes,
           double ns) {
    m_ledger.add({m_stage, what, why, held_bytes / kMegabyte, brief_bytes / kMegabyte, ns * 1e-9});
  }
  void move_all(MovedBricks& moved, const std::string& why);
  double grow(MovedBricks& moved, int coordinate) const;
  void cuts(MovedBricks& moved);
  void pieces();
  MovedBricks drag(const MovedBricks& before);
  void relax(MovedBricks& moved);

  std::string m_stage;
  int m_links;
  const Session& m_session;
  const State& m_state;
  const UnitCosts& m_costs;
  PlanLedger& m_ledger;
  Step m_request;
  double m_beside_joints = 0;  // bricks, once the pieces are planned
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
        bricks * kBrickBytes4, count * ecm_looks(m_links) * m_costs[kEcmElementCost]);
  }
  return moved;
}

/// The coordinate moves in the bricks around, too; its elements.
double StepPlan::grow(MovedBricks& moved, int coordinate) const {
  const BrickTopology& elements = m_session.body().elements;
  auto& bricks = moved.bricks[std::size_t(coordinate)];
  bricks.resize(elements.brick_count(), 0);
  tools::grow(bricks, elements);
  double count = 0;
  for (std::size_t b = 0; b < bricks.size(); ++b) {
    if (bricks[b] != 0) count += mask_count(elements.mask(b));
  }
  return moved.elements[std::size_t(coordinate)] = count;
}

/// Bricks in which tissue is parted, and so is inverted piece by piece.
double bricks_beside(const LinkCuts& cuts, const BrickTopology& elements) {
  std::vector<Vec3i> low;
  for (std::size_t b = 0; b < cuts.brick_end(); ++b) {
    const LinkCuts::BrickCuts* const of_brick = cuts.brick(b);
    for (int axis = 0; of_brick != nullptr && axis < 3; ++axis) {
      for_each_active((*of_brick)[std::size_t(axis)],
                      [&](int offset) { low.push_back(elements.origin(b) + brick_local(offset)); });
    }
  }
  return double(dilate(topology_of(low), kSplitRings).brick_count());
}

/// Makes the cuts of the step in a copy of the body.
void StepPlan::cuts(MovedBricks& moved) {
  if (m_request.cuts.empty()) return;
  Body body = m_session.body();
  body.cuts = m_session.cuts();  // none inside of rigid pieces
  const auto start = std::chrono::steady_clock::now();
  const std::int64_t links = apply_cuts(body, m_state.labels, m_request.cuts, nullptr);
  const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - start;
  add(count_text(double(links), "cut links"), "the step cuts", 0, 0, took.count());
  moved.split += bricks_beside(body.cuts, body.elements);
}

/// Joints as the step will part them, in a copy of the body.
void StepPlan::pieces() {
  if (m_request.rigid.empty()) return;
  if (m_request.rigid.joint_mm > 0) {
    Body body = m_session.body();
    LinkCuts cuts = m_session.cuts();
    make_pieces(body, cuts, m_request.rigid, m_state.density, m_state.labels, nullptr);
    m_beside_joints = kJointSides * bricks_beside(cuts, body.elements);
  }
  add("rigid pieces among " + count_text(elements(), "elements"), "the step makes them", 0, 0,
      elements() * kPieceNs);
}

void StepPlan::relax(MovedBricks& moved) {
  const bool is_default = !m_request.relax && !m_request.no_relax && !m_request.drags.empty() &&
                          m_request.limits != Limits::ball && m_session.material().relaxes;
  if (!m_request.relax && !is_default) {
    m_ledger.leave_out(m_stage + ": stiffness, relaxation",
                       m_request.no_relax ? "no_relax = true" : "the step asks for none");
    return;
  }
  const RelaxParams params = m_request.relax
                                 ? *m_request.relax
                                 : tissue_relaxation(m_session.material().relaxes_by_poisson);
  const bool conserves = params.conserves_volume();
  double passes = params.passes, count = 0, bricks = 0;
  const double passes_of_ring = params.budget_million > 0 ? kPassesOfRingInBudget : kPassesOfRing;
  for (int ring = 1; ring <= 64; ++ring) {
    count = bricks = 0;
    for (int c = 0; c < 3; ++c) {
      if (!moved.moves(c) && !conserves) continue;
      count += grow(moved, c);
      bricks += double(moved.count(c));
    }
    if (params.budget_million > 0 && count > 0) {
      passes = std::min(double(params.passes), params.budget_million * 1e6 / count);
    }
    if (ring >= 1 + passes / passes_of_ring) break;
  }
  const bool is_plastic = m_session.material().yield_strain.has_value();
  const double ns =
      pass_ns(count, conserves, m_links, m_costs[kRelaxElementCost], m_costs[kVolumeElementCost]);
  const double bytes = bricks * kBrickVoxels * (conserves ? kVolumeBytes : kRelaxBytes);
  add("stiffness and up to " + count_text(passes, "passes"),
      m_request.relax ? "the step asks for relaxation" : "the material relaxes what is dragged",
      bricks * kBrickVoxels * (is_plastic ? kFractionBytes + kFlowBytes : kFractionBytes), bytes,
      ns * passes + elements() * kRelaxStartNs);
}

MovedBricks StepPlan::plan(const MovedBricks& before) {
  MovedBricks moved = before;
  cuts(moved);
  pieces();
  if (const auto model = plan_model(m_request, m_session.body(), m_costs)) {
    const std::string& title = model_of(m_request).title;
    move_all(moved, title + " move every node");
    add(model->what, "the step moves the body by " + title, 0, model->bytes, model->seconds * 1e9);
  } else {
    moved.add(drag(before));
    relax(moved);
  }
  if (m_beside_joints > 0) {
    moved.split += std::max(m_beside_joints, kJointPart * double(moved.count()));
  }
  return moved;
}

}  // namespace

MovedBricks plan_step(const Step& step, int number, int links, const Session& session,
                      const State& state, const MovedBricks& before, const UnitCosts& costs,
                      PlanLedger& ledger) {
  return StepPlan(step, number, links, session, state, costs, ledger).plan(before);
}

}  // namespace supple::tools
