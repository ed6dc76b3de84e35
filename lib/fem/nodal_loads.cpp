#include "lib/fem/nodal_loads.h"

#include <algorithm>

#include "lib/fem/elastic_solid.h"

namespace supple {

LoadPath::LoadPath(const ElasticSolid& solid, const NodalLoads& loads) : m_loads(&loads) {
  for (std::size_t held = 0; held < loads.nodes_of.size(); ++held) {
    const std::vector<NodeIndex>& nodes = loads.nodes_of[held];
    const bool is_shared = held < loads.shares_of.size() && !loads.shares_of[held].empty();
    Grip grip{&nodes, is_shared ? &loads.shares_of[held] : nullptr, {}, {}, true, {}};
    for (const NodeIndex n : nodes) {
      const double* u = &loads.u_mm[3 * std::size_t(n)];
      grip.end_mm.emplace_back(u[0], u[1], u[2]);
    }
    const auto moves = [](const Vec3d& u) { return u != Vec3d(0); };
    if (std::none_of(grip.end_mm.begin(), grip.end_mm.end(), moves)) continue;
    grip.rest_mm = solid.node_positions(nodes);
    RigidFit fit;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      fit.add(grip.rest_mm[n], grip.rest_mm[n] + grip.end_mm[n]);
      grip.is_rigid = grip.is_rigid && loads.held[nodes[n]] == 7;
    }
    if (grip.is_rigid) grip.motion = fit.motion();
    m_grips.push_back(std::move(grip));
  }
}

std::size_t LoadPath::bytes() const {
  std::size_t sum = 0;
  for (const Grip& grip : m_grips) {
    sum += (grip.rest_mm.capacity() + grip.end_mm.capacity()) * sizeof(Vec3d);
  }
  return sum;
}

Vec3d LoadPath::Grip::at(double part, const RigidMotion& on_the_way, std::size_t n) const {
  const Vec3d &rest = rest_mm[n], &end = end_mm[n];
  if (part == 1 || !is_rigid) return end * part;
  // The rest beside the rigid motion grows in proportion, and turns with it.
  const Vec3d left = motion.turn.inverse()(rest + end - motion(rest));
  return on_the_way(rest) + on_the_way.turn(left * part) - rest;
}

void LoadPath::prescribe(double part, std::vector<double>& u_mm) const {
  const auto share = [&](const Grip& grip, std::size_t n) {
    return grip.shares == nullptr || part == 1 ? 1 : (*grip.shares)[n];
  };
  for (const Grip& grip : m_grips) {
    for (std::size_t n = 0; n < grip.nodes->size(); ++n) {
      double* u = &u_mm[3 * std::size_t((*grip.nodes)[n])];
      if (share(grip, n) < 1) u[0] = u[1] = u[2] = 0;
    }
  }
  // Nodes that several hold go to the mean of where each would have them on its way.
  for (const Grip& grip : m_grips) {
    const RigidMotion on_the_way = grip.motion.part(part);
    for (std::size_t n = 0; n < grip.nodes->size(); ++n) {
      const NodeIndex node = (*grip.nodes)[n];
      const Vec3d way = grip.at(part, on_the_way, n);
      const double weight = share(grip, n);
      for (int a = 0; a < 3; ++a) {
        if ((m_loads->held[node] >> a & 1) == 0) continue;
        double& u = u_mm[3 * std::size_t(node) + std::size_t(a)];
        u = weight < 1 ? u + weight * way[a] : way[a];
      }
    }
  }
}

}  // namespace supple
