// How the workloads of the ECM benchmark pull at their bodies.
#pragma once

#include "tools/lab/bench/bodies/ecm_engines.h"
#include "tools/lab/bench/bodies/ecm_plan.h"

namespace supple::tools {

struct Motion {
  std::vector<BenchDrag>
      script;  // from rest: warms up, shows memory, and must end alike for all sides
  std::vector<BenchDrag> cycle;  // the timed part
  bool from_rest = false;        // each cycle, or else goes on from where the body is
  int max_cycles = 100;          // of all sides together, for the range
};

/// A direction's name (+x, -x, +y, xy, xyz) times a number of voxels.
BenchDrag pull_of(const Vec3i& voxel, const std::string& direction, double voxels);

/// The element nearest to the middle of the body's box.
Vec3i middle_element(const Body& body);

/// The foremost element (largest j) on the cheek of a head that fills the box.
Vec3i cheek_element(const Body& body);

/// Pulls in the middle by more than the slack of any path, so that every element moves.
Motion motion_of_all(const EcmWorkload& workload, const Body& body);

/// A pull of that many voxels out of rest; with start `repeat` to and fro about the rest place.
Motion local_motion(const EcmWorkload& workload, const Vec3i& voxel, double amplitude);

/// The amplitude whose last pull moves about `wanted` elements. Leaves the body at rest.
double find_amplitude(const EcmWorkload& workload, Body& body, const Vec3i& voxel,
                      std::int64_t wanted, Progress& cancel);

}  // namespace supple::tools
