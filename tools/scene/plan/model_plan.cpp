#include "tools/scene/plan/model_plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include "tools/scene/plan/plan_ledger.h"

namespace supple::tools {

namespace {

/// Bytes per element: of the springs with their cells, and of their matrix beside them; of both in
/// one slice.
constexpr double kSpringBytes = 670, kSpringMatrixBytes = 410, kSpringBytesInSlice = 456;
constexpr double kSpringsOfElement = 8.7, kSpringsInSlice = 4;
/// Times per spring in steps of the calibration: setup, a step to a minimum, and a step of time;
/// the last is the factor where shapes press.
constexpr double kSpringStart = 0.35, kDownWork = 0.2, kMotionWork = 1.35, kContactWork = 5;
constexpr double kMinimumSteps = 40;  // that a minimum of springs takes, of those that it may
/// Time of bodies that no cache holds, relative to the small one of a calibration.
constexpr double kFemBeyondCaches = 1.6;
constexpr double kFemBytes = 58;      // per unknown
constexpr double kFiniteBytes = 70;   // more, at finite strain
constexpr double kModeBytes = 16;     // more, of every mode
constexpr double kLanczosBytes = 8;   // more, of every vector that modes are found from
constexpr double kMotionBytes = 200;  // more, with mass, damping and what moves
/// Iterations of an equilibrium for the first decade of the residual: usually, and beside rigid
/// pieces or tissue that many times as stiff. Later decades take more.
constexpr double kIterations = 3, kHardIterations = 10, kLargeContrast = 1000;
constexpr double kDecadesPower = 1.15;
/// Time of elements that are twice as large, relative to voxels; and the iterations of voxels that
/// a setup of larger ones saves, whose voxels are not smoothed.
constexpr double kCoarsePart = 0.25, kCoarseSetup = 2;
constexpr double kNewtonSystems = 5;
/// Iterations of a step of time, relative to an equilibrium; equilibria of a mode.
constexpr double kMotionPart = 0.13, kModeSystems = 1.1;

/// Ratio of the stiffest tissue to the softest that the material may make.
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

double element_count(const Session& session) {
  return double(session.body().elements.active_count());
}

/// Elements of the fixed boxes, and of rigid pieces that these hold as wholes.
SlotSet fixed_elements(const Step& request, const Session& session) {
  const Body& body = session.body();
  SlotSet fixed;
  for (const ChosenPart& part : request.fix) {
    if (const IndexBox* box = part.box()) fixed.add(elements_of(body, Region(*box), "fix"));
  }
  SlotSet all = fixed;
  for (const RigidPiece& piece : body.rigid.list) {
    Slot slot;
    if (piece.elements->first_common(fixed, slot)) all.add(*piece.elements);
  }
  return all;
}

/// Corners of elements, and those of them that no fixed element has.
struct NodeCount {
  double all = 0, free = 0;
};

/// A corner between bricks counts in each of them, by the part of it that is the brick's.
NodeCount count_nodes(const BrickTopology& elements, const SlotSet& fixed) {
  constexpr int kEdge = 9;
  NodeCount count;
  for (std::size_t b = 0; b < elements.brick_count(); ++b) {
    const BrickMask* const held = fixed.find(b);
    std::array<std::uint8_t, kEdge * kEdge * kEdge>
        corners{};  // 1: of an element; 2: of a held one
    for_each_active(elements.mask(b), [&](int offset) {
      const Vec3i voxel = brick_local(offset);
      const std::uint8_t bits = held != nullptr && mask_test(*held, offset) ? 3 : 1;
      for (int n = 0; n < 8; ++n) {
        const int i = voxel.x + (n >> 2), j = voxel.y + (n >> 1 & 1), k = voxel.z + (n & 1);
        corners[std::size_t((i * kEdge + j) * kEdge + k)] |= bits;
      }
    });
    for (std::size_t n = 0; n < corners.size(); ++n) {
      if (corners[n] == 0) continue;
      double part = 1;
      for (const std::size_t at : {n / (kEdge * kEdge), n / kEdge % kEdge, n % kEdge}) {
        if (at == 0 || at == kEdge - 1) part /= 2;
      }
      count.all += part;
      if (corners[n] == 1) count.free += part;
    }
  }
  return count;
}

ModelPlan plan_springs(const SpringStep& springs, const Session& session, const UnitCosts& costs) {
  const double elements = element_count(session);
  const double most = springs.is_motion() ? springs.motion_steps() : springs.most_steps;
  const double steps = springs.is_motion() ? most : std::min(most, kMinimumSteps);
  const bool is_slice = session.geometry().dims().z == 1;
  const double count = elements * (is_slice ? kSpringsInSlice : kSpringsOfElement);
  const bool has_matrix =
      springs.motion.minimise || springs.motion.method == SpringMethod::implicit;
  const double bytes = is_slice     ? kSpringBytesInSlice
                       : has_matrix ? kSpringBytes + kSpringMatrixBytes
                                    : kSpringBytes;
  const double work =
      springs.is_motion() ? kMotionWork * (springs.contacts.empty() ? 1 : kContactWork) : kDownWork;
  return {count_text(count, "springs") + (springs.is_motion() ? ", " : ", some ") +
              count_text(steps, "steps"),
          "the step moves the body by springs", elements * bytes,
          count * (kSpringStart + steps * work) * costs.spring * 1e-9};
}

ModelPlan plan_finite_elements(const Step& request, const Session& session,
                               const UnitCosts& costs) {
  const FemStep& fem = *request.fem;
  const double parts = std::pow(8, fem.halvings);
  const NodeCount nodes = count_nodes(session.body().elements, fixed_elements(request, session));
  const double all = 3 * nodes.all * parts, unknowns = 3 * nodes.free * parts;
  const FemParams& params = fem.params;
  const bool is_finite = params.strain == StrainTheory::finite;
  const double systems = fem.modes    ? fem.modes->count * kModeSystems
                         : is_finite  ? kNewtonSystems
                         : fem.motion ? fem.motion->steps() * kMotionPart
                                      : 1;
  const bool is_hard = !request.rigid.empty() || !session.body().rigid.empty() ||
                       contrast_of(session.material()) >= kLargeContrast;
  const double decades = std::max(1.0, -std::log10(params.tolerance));
  const double iterations = systems * std::pow(decades, kDecadesPower) *
                            (is_hard ? kHardIterations : kIterations) *
                            std::pow(kCoarsePart, params.doublings);
  double more = 0;
  if (fem.modes) {
    more = kModeBytes * fem.modes->count + kLanczosBytes * std::max(20, 2 * fem.modes->count + 1);
  } else if (fem.motion) {
    more = kMotionBytes;
  } else if (is_finite) {
    more = kFiniteBytes;
  }
  return {count_text(unknowns, "unknowns") + ", some " + count_text(iterations, "iterations"),
          "the step moves the body by finite elements", all * (kFemBytes + more),
          fem_work(unknowns, iterations - (params.doublings > 0 ? kCoarseSetup : 0)) *
              kFemBeyondCaches * costs.fem_unknown * 1e-9};
}

std::string two_digits(double value) {
  char text[32];
  std::snprintf(text, sizeof text, value < 10 ? "%.2g" : "%.0f", value);
  return text;
}

}  // namespace

ModelPlan plan_model(const Step& request, const Session& session, const UnitCosts& costs) {
  return request.springs ? plan_springs(*request.springs, session, costs)
                         : plan_finite_elements(request, session, costs);
}

std::string price_text(const ModelPlan& plan, const Step& request, const Session& session) {
  return std::string(request.springs ? "springs" : "finite elements") + " on " +
         count_text(element_count(session), "elements") + ": some " + two_digits(plan.seconds) +
         " s and " + two_digits(plan.bytes * 1e-9) + " GB for each " +
         (request.springs ? "drag" : "release of a drag");
}

}  // namespace supple::tools
