#include "lib/fem/load_path.h"

#include <algorithm>

namespace supple {

LoadPath::LoadPath(const HexMesh& voxels, const NodalLoads& loads)
    : m_loads(&loads), m_end_mm(loads.u_mm), m_positions(node_positions(voxels)) {
  for (const std::vector<NodeIndex>& nodes : loads.nodes_of) {
    const bool moves = std::any_of(nodes.begin(), nodes.end(), [&](NodeIndex n) {
      const double* u = &m_end_mm[3 * std::size_t(n)];
      return u[0] != 0 || u[1] != 0 || u[2] != 0;
    });
    if (!moves) continue;
    Grip grip{&nodes, true, {}};
    RigidFit fit;
    for (const NodeIndex n : nodes) {
      const double* u = &m_end_mm[3 * std::size_t(n)];
      fit.add(m_positions[n], m_positions[n] + Vec3d(u[0], u[1], u[2]));
      grip.is_rigid = grip.is_rigid && loads.held[n] == 7;
    }
    if (grip.is_rigid) grip.motion = fit.motion();
    m_grips.push_back(grip);
  }
}

void LoadPath::prescribe(double part, std::vector<double>& u_mm) const {
  for (const Grip& grip : m_grips) {
    const RigidMotion on_the_way = grip.motion.part(part);
    const Turn back = grip.motion.turn.inverse();
    for (const NodeIndex n : *grip.nodes) {
      double* u = &u_mm[3 * std::size_t(n)];
      const double* end = &m_end_mm[3 * std::size_t(n)];
      if (part == 1 || !grip.is_rigid) {
        for (int a = 0; a < 3; ++a) {
          if ((m_loads->held[n] >> a & 1) != 0) u[a] = part * end[a];
        }
        continue;
      }
      // What the rigid motion leaves over grows in proportion, and turns with it.
      const Vec3d rest = m_positions[n];
      const Vec3d left = back(rest + Vec3d(end[0], end[1], end[2]) - grip.motion(rest));
      const Vec3d way = on_the_way(rest) + on_the_way.turn(left * part) - rest;
      for (int a = 0; a < 3; ++a) u[a] = way[a];
    }
  }
}

}  // namespace supple
