// The rows of one step: the fields that it needs, and the model that moves the body.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "tools/plan/plan_ledger.h"
#include "tools/scene/run_step.h"
#include "volumes/grid/labels.h"
#include "volumes/grid/voxel_sets.h"

namespace supple::tools {

namespace {

constexpr double kFractionBytes = 2, kFlowBytes = 4;   // kept, the second where tissue flows
constexpr double kRelaxBytes = 18, kVolumeBytes = 25;  // per element that moves (docs/models)
// Of bodies that no cache holds, in that of the small one of a calibration: of relaxation, where
// cells keep their volume, and of finite elements.
constexpr double kBeyondCaches = 1.6, kVolumeBeyondCaches = 2.6, kFemBeyondCaches = 2;
constexpr double kRelaxStartNs = 80;  // per element of the body
// Passes that take a relaxation one brick further; a budget ends it while it still spreads.
constexpr double kPassesOfRing = 4, kPassesOfRingInBudget = 6;
/// A joint is parted on both sides, and its bricks fall into more pieces than those of a cut: of
/// the bricks that move, at least this part.
constexpr double kJointSides = 2, kJointPart = 0.25;
/// Voxels from a cut link in which bricks are split (cut_inversion.cpp).
constexpr int kSplitRings = 3;
constexpr double kPieceNs = 700;  // to find rigid pieces, per element
/// Per element: of the springs with their cells, and of their matrix beside them; of both in one
/// slice.
constexpr double kSpringBytes = 670, kSpringMatrixBytes = 410, kSpringBytesInSlice = 456;
constexpr double kSpringsOfElement = 8.7, kSpringsInSlice = 4;
/// In steps of the calibration, per spring: to set it up, a step to a minimum, and a step of time;
/// how many times as long that takes where shapes press.
constexpr double kSpringStart = 0.35, kDownWork = 0.2, kMotionWork = 1.35, kContactWork = 5;
constexpr double kMinimumSteps = 40;      // that a minimum of springs takes, of those that it may
constexpr double kFemBytes = 58;          // per unknown
constexpr double kFiniteBytes = 70;       // more, at finite strain
constexpr double kModeBytes = 16;         // more, of every mode
constexpr double kLanczosBytes = 8;       // more, of every vector that modes are found from
constexpr double kMotionBytes = 200;      // more, with mass, damping and what moves
constexpr double kNodesOfElement = 1.12;  // of a head; of one slice twice as many
/// Of an equilibrium, for every decade of the residual: usually, and beside rigid pieces or tissue
/// that many times as stiff.
constexpr double kIterations = 5, kHardIterations = 13, kLargeContrast = 1000;
/// Of elements that are twice as large, in those of voxels.
constexpr double kCoarsePart = 0.25;
constexpr double kNewtonSystems = 5;
/// Of the iterations of an equilibrium, those of a step of time; equilibria of a mode.
constexpr double kMotionPart = 0.13, kModeSystems = 1.1;

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

/// With the bricks around.
void grow(std::vector<std::uint8_t>& bricks, const BrickTopology& elements) {
  const std::vector<std::uint8_t> before = bricks;
  for (std::size_t b = 0; b < before.size(); ++b) {
    for (int face = 0; before[b] == 0 && face < 6; ++face) {
      const std::int32_t beside = elements.neighbour(b, face);
      if (beside >= 0 && before[std::size_t(beside)] != 0) bricks[b] = 1;
    }
  }
}

/// Of the stiffest tissue to the softest that the material may make.
double contrast_of(const MaterialTable& material) {
  double least = std::numeric_limits<double>::infinity(), most = 0;
  const auto take = [&](const LimitTable& table) {
    if (!table.stiffness) return;
    for (const auto& [density, kpa] : table.stiffness->keys) {
      least = std::min(least, kpa);
      most = std::max(most, kpa);
    }
  };
  take(material);
  for (const auto& [label, table] : material.labels) take(table);
  return most > 0 ? most / least : 1;
}

/// One step while its rows are made.
class StepPlan {
 public:
  StepPlan(const SceneStep& step, int number, int links, const Session& session, const State& state,
           const UnitCosts& costs, PlanLedger& ledger)
      : m_stage("step " + std::to_string(number)),
        m_links(links),
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
  double grow(MovedBricks& moved, int coordinate) const;
  void cuts(MovedBricks& moved);
  void pieces();
  MovedBricks drag(const MovedBricks& before);
  void relax(MovedBricks& moved);
  void springs();
  double fixed() const;
  void finite_elements();

  std::string m_stage;
  int m_links;
  const Session& m_session;
  const State& m_state;
  const UnitCosts& m_costs;
  PlanLedger& m_ledger;
  StepRequest m_request;
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
    const double work = m_links == 26 ? 5 : m_links == 18 ? 3 : 1;  // of that with 6 links
    add("coordinate " + axis_name(c) + " of " + bricks_text(bricks) + ", " +
            count_text(count, "elements"),
        "Enhanced ChainMail: a handle moves along it", std::max(0.0, bricks - known) * kBrickBytes4,
        bricks * kBrickBytes4, count * work * m_costs.ecm_element);
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

/// As the step will make them, in a copy of the body.
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
  const double work = m_links == 26 ? 4 : m_links == 18 ? 2.5 : 1;  // of those of 6
  const double ns = conserves ? kVolumeBeyondCaches * count / 3 * m_costs.volume_element
                              : kBeyondCaches * count * m_costs.relax_element * work;
  const double bytes = bricks * kBrickVoxels * (conserves ? kVolumeBytes : kRelaxBytes);
  add("stiffness and up to " + count_text(passes, "passes"),
      m_request.relax ? "the step asks for relaxation" : "the material relaxes what is dragged",
      bricks * kBrickVoxels * (is_plastic ? kFractionBytes + kFlowBytes : kFractionBytes), bytes,
      ns * passes + elements() * kRelaxStartNs);
}

void StepPlan::springs() {
  const SpringStep& springs = *m_request.springs;
  const double most = springs.is_motion() ? springs.motion_steps() : springs.most_steps;
  const double steps = springs.is_motion() ? most : std::min(most, kMinimumSteps);
  const bool is_slice = m_session.geometry().dims().z == 1;
  const double count = elements() * (is_slice ? kSpringsInSlice : kSpringsOfElement);
  const bool has_matrix =
      springs.motion.minimise || springs.motion.method == SpringMethod::implicit;
  const double bytes = is_slice     ? kSpringBytesInSlice
                       : has_matrix ? kSpringBytes + kSpringMatrixBytes
                                    : kSpringBytes;
  const double work =
      springs.is_motion() ? kMotionWork * (springs.contacts.empty() ? 1 : kContactWork) : kDownWork;
  add(count_text(count, "springs") + (springs.is_motion() ? ", " : ", some ") +
          count_text(steps, "steps"),
      "the step moves the body by springs", 0, elements() * bytes,
      count * (kSpringStart + steps * work) * m_costs.spring);
}

/// Elements of the fixed boxes.
double StepPlan::fixed() const {
  double count = 0;
  for (const IndexBox& box : m_request.fix) {
    count += double(elements_of(m_session.body(), Region(box), "fix").size());
  }
  return count;
}

void StepPlan::finite_elements() {
  const bool is_slice = m_session.geometry().dims().z == 1;
  const double parts = std::pow(8, m_request.fem->halvings);
  const double all = 3 * elements() * parts * (is_slice ? 2.1 : kNodesOfElement);
  const double unknowns = all * std::max(0.0, 1 - fixed() / elements());
  const FemParams& params = m_request.fem->params;
  const bool is_finite = params.strain == StrainTheory::finite;
  const std::optional<MotionStep>& motion = m_request.fem->motion;
  const double systems = m_request.fem->modes ? m_request.fem->modes->count * kModeSystems
                         : is_finite          ? kNewtonSystems
                         : motion             ? motion->steps() * kMotionPart
                                              : 1;
  const bool is_hard = !m_request.rigid.empty() || !m_session.body().rigid.empty() ||
                       contrast_of(m_session.material()) >= kLargeContrast;
  const double decades = std::max(1.0, -std::log10(params.tolerance));
  const double iterations = systems * decades * (is_hard ? kHardIterations : kIterations) *
                            std::pow(kCoarsePart, params.doublings);
  double more = 0;
  if (const std::optional<ModeStep>& modes = m_request.fem->modes) {
    more = kModeBytes * modes->count + kLanczosBytes * std::max(20, 2 * modes->count + 1);
  } else if (motion) {
    more = kMotionBytes;
  } else if (is_finite) {
    more = kFiniteBytes;
  }
  add(count_text(unknowns, "unknowns") + ", some " + count_text(iterations, "iterations"),
      "the step moves the body by finite elements", 0, all * (kFemBytes + more),
      fem_work(unknowns, iterations) * kFemBeyondCaches * m_costs.fem_unknown);
}

MovedBricks StepPlan::plan(const MovedBricks& before) {
  MovedBricks moved = before;
  cuts(moved);
  pieces();
  if (m_request.springs || m_request.fem) {
    move_all(moved, m_request.fem ? "finite elements move every node" : "springs move every node");
    if (m_request.fem) {
      finite_elements();
    } else {
      springs();
    }
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

MovedBricks plan_step(const SceneStep& step, int number, int links, const Session& session,
                      const State& state, const MovedBricks& before, const UnitCosts& costs,
                      PlanLedger& ledger) {
  return StepPlan(step, number, links, session, state, costs, ledger).plan(before);
}

}  // namespace supple::tools
