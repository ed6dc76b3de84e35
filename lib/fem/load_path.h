// How loads grow from nothing to the whole, for problems that are solved in steps: forces in
// proportion; what is held goes along its rigid motion, so that a turn stays one on the way.
#pragma once

#include <vector>

#include "lib/body/rigid_pieces.h"
#include "lib/fem/fem_loads.h"
#include "lib/fem/hex_mesh.h"

namespace supple {

class LoadPath {
 public:
  /// Keeps the prescribed displacements of `loads`, and `loads` itself for the rest: it must
  /// outlive this.
  LoadPath(const HexMesh& voxels, const NodalLoads& loads);

  /// Writes the prescribed displacements at a part 0 ... 1 of the loads, and nothing else.
  void prescribe(double part, std::vector<double>& u_mm) const;

 private:
  struct Grip {
    const std::vector<NodeIndex>* nodes;
    bool is_rigid;       // all three components are held
    RigidMotion motion;  // nearest to the displacements
  };
  const NodalLoads* m_loads;
  std::vector<double> m_end_mm;
  std::vector<Vec3d> m_positions;
  std::vector<Grip> m_grips;
};

}  // namespace supple
