// Branching vessels of a retina, painted into maps of how much of each texel they cover.
#pragma once

#include <cstdint>
#include <vector>

namespace supple {

/// Places of a retina, mm along its surface from the posterior pole, with x to the nasal side and y
/// upwards, on a globe of 11 mm.
struct RetinaPlan {
  static constexpr double kGlobeMm = 11;
  static constexpr double kDiscX = 4.4, kDiscY = 0.35, kDiscRadius = 0.88;
  static constexpr double kFoveaX = 0, kFoveaY = 0;
  static constexpr double kEdge = 22;  // where vessels end
};

/// Covers of texels, 0 … 1, row 0 first.
struct VesselMaps {
  int size = 0;
  double texels_per_mm = 1;
  std::vector<float> veins, arteries, reflexes;  // reflexes: light streaks along arteries
};

/// Arcades from the disc around the macula, and those of the nasal side, with their branches.
VesselMaps paint_vessels(int size, std::uint64_t seed);

}  // namespace supple
