#include "lib/fem/voxel/fem_cost.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace supple {

namespace {

/// Time of bodies that no cache holds, relative to the small one of a calibration.
constexpr double kBeyondCaches = 1.6;
/// Iterations of an equilibrium for the first decade of the residual: usually, and beside rigid
/// pieces or tissue that many times as stiff. Later decades take more.
constexpr double kIterations = 3, kHardIterations = 10, kLargeContrast = 1000;
constexpr double kDecadesPower = 1.15;
/// Decades of the residual after which displacements are within a twentieth of a voxel.
constexpr double kErrorDecades = 1.4;
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

}  // namespace

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
        corners[(std::size_t(i) * kEdge + std::size_t(j)) * kEdge + std::size_t(k)] |= bits;
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

FemWork fem_work(const NodeCount& nodes, const FemWish& wish, const MaterialTable& material) {
  const FemParams& params = wish.params;
  const double parts = std::pow(8, wish.halvings);
  const double all = 3 * nodes.all * parts, unknowns = 3 * nodes.free * parts;
  const bool is_finite = params.strain == StrainTheory::finite;
  const double systems = wish.modes > 0          ? wish.modes * kModeSystems
                         : is_finite             ? kNewtonSystems
                         : wish.motion_steps > 0 ? wish.motion_steps * kMotionPart
                                                 : 1;
  const bool is_hard = wish.has_rigid_pieces || contrast_of(material) >= kLargeContrast;
  const bool is_to_voxel = params.can_end_by_error() && params.accuracy == FemAccuracy::voxel;
  const double decades = !params.tolerance && (params.error_mm || is_to_voxel)
                             ? kErrorDecades
                             : std::max(1.0, -std::log10(params.residual_limit()));
  const double iterations = systems * std::pow(decades, kDecadesPower) *
                            (is_hard ? kHardIterations : kIterations) *
                            std::pow(kCoarsePart, params.doublings);
  double bytes = kFemBytes;
  if (wish.modes > 0) {
    bytes += kModeBytes * wish.modes + kLanczosBytes * std::max(20, 2 * wish.modes + 1);
  } else if (wish.motion_steps > 0) {
    bytes += kMotionBytes;
  } else if (is_finite) {
    bytes += kFiniteBytes;
  }
  const double started = params.doublings > 0 ? kCoarseSetup : 0;
  return {unknowns, iterations, all * bytes,
          fem_work(unknowns, iterations - started) * kBeyondCaches};
}

double fem_work(double unknowns, double iterations) {
  constexpr double kSetup = 5, kSmallest = 18000;
  return (unknowns + kSmallest) * (iterations + kSetup);
}

}  // namespace supple
