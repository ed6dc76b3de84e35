// How elements turn and stretch, by the offsets of their neighbours: where a step of one voxel
// along each axis goes from them.
//
// Across parts one voxel thick no neighbour tells. There they follow, in this order,
//  - what is known of the motion by other ways (StepMotion),
//  - the affine motion that meets the offsets of all elements that are connected,
//  - the steps along the other axes: normals stay normal and keep their length, as in a thin shell
//    (Kirchhoff). A single voxel does not turn.
// All is exact, but for the rounding of offsets, where the motion is linear in space. About 1 us
// per element.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lib/chainmail/ecm.h"
#include "lib/model/voxel_corners.h"

namespace supple {

/// The way to which steps take a way.
inline Vec3d moved(const GridSteps& steps, const Vec3d& way) {
  return steps[0] * way.x + steps[1] * way.y + steps[2] * way.z;
}

/// Images of a step along each axis when some directions go to their images, all in voxels: steps
/// perpendicular to them in mm turn with them and keep their length.
GridSteps completed_steps(const Geometry& geometry, const std::vector<Vec3d>& directions,
                          const std::vector<Vec3d>& images);

/// Elements whose offsets are parts of one motion.
class FieldSteps {
 public:
  FieldSteps(const VoxelCorners& corners, std::vector<Slot> slots, std::vector<Vec3d> offsets);

  /// Steps of the n-th element, with those of `across` along axes without neighbour.
  GridSteps steps(std::size_t n, const GridSteps& across) const;
  /// The same, with steps that follow from the field itself along axes without neighbour.
  GridSteps steps(std::size_t n) const;

 private:
  bool has_neighbour(std::size_t n, std::size_t axis) const {
    return m_beside[n][2 * axis] >= 0 || m_beside[n][2 * axis + 1] >= 0;
  }
  Vec3d rest(std::size_t n) const { return Vec3d(voxel_of(m_body.elements, m_slots[n])); }
  void find_neighbours(const VoxelCorners& corners);
  void find_motions();
  void fit(const std::vector<std::size_t>& part);

  const Body& m_body;
  std::vector<Slot> m_slots;
  std::vector<Vec3d> m_offsets;
  std::vector<std::array<std::int32_t, 6>> m_beside;  // low and high per axis; empty: all go as one
  std::vector<std::int32_t> m_motion_of;              // in m_motions, or -1
  std::vector<GridSteps> m_motions;
};

}  // namespace supple
