#include "tests/lib/mesh_fixtures.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include <gtest/gtest.h>

#include "tests/lib/test_bodies.h"

namespace supple::test {

namespace {

Wide units_below_mm(Real mm) {
  const Real units = std::floor(mm * 65536 + Real(1e-7));
  return units >= Real(1 << 30) ? kNoPath : Wide(units);
}

}  // namespace

TriangleMesh icosphere(int level, double radius_mm) {
  const double g = (1 + std::sqrt(5.0)) / 2;
  TriangleMesh mesh;
  mesh.vertices_lps_mm = {{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                          {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                          {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
  mesh.triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                    {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                    {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                    {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (int n = 0; n < level; ++n) {
    std::map<std::array<int, 2>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [found, is_new] =
          middles.insert({{std::min(a, b), std::max(a, b)}, int(mesh.vertices_lps_mm.size())});
      if (is_new) {
        mesh.vertices_lps_mm.push_back((mesh.vertices_lps_mm[a] + mesh.vertices_lps_mm[b]) / 2.0);
      }
      return found->second;
    };
    std::vector<std::array<int, 3>> finer;
    for (const auto& t : mesh.triangles) {
      const int ab = middle(t[0], t[1]), bc = middle(t[1], t[2]), ca = middle(t[2], t[0]);
      finer.insert(finer.end(), {{t[0], ab, ca}, {t[1], bc, ab}, {t[2], ca, bc}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
    for (Vec3d& p : mesh.vertices_lps_mm) p.normalize();
  }
  for (Vec3d& p : mesh.vertices_lps_mm) p = p.normalized() * radius_mm;
  return mesh;
}

MeshBody chain_body(int nodes, const Vec3d& step_mm) {
  std::vector<Vec3d> points;
  std::vector<LinkNodes> links;
  for (int n = 0; n < nodes; ++n) {
    points.push_back(step_mm * double(n));
    if (n > 0) links.push_back({n - 1, n});
  }
  return make_network(points, links);
}

MeshBody random_network(std::mt19937& random, int max_nodes) {
  const int nodes = 1 + int(random() % unsigned(max_nodes));
  std::vector<Vec3d> points;
  for (int n = 0; n < nodes; ++n) {
    Vec3d p(pick(random, -20, 20), pick(random, -20, 20), pick(random, -20, 20));
    if (n > 0 && random() % 4 == 0) {
      p = points[random() % std::size_t(n)];
      if (random() % 4 != 0) p[int(random() % 3)] += pick(random, -9, 9);
    }
    points.push_back(p);
  }
  std::vector<LinkNodes> links;
  if (nodes > 1) {
    const std::size_t wanted = 1 + random() % std::size_t(3 * nodes);
    while (links.size() < wanted) {
      const int a = int(random() % unsigned(nodes)), b = int(random() % unsigned(nodes));
      if (a != b) links.push_back({a, b});
    }
  }
  return make_network(points, links);
}

std::vector<MeshLimits> random_limits(std::mt19937& random, std::size_t links) {
  std::vector<MeshLimits> limits;
  for (std::size_t n = 0; n < links; ++n) {
    MeshLimits one{pick(random, 1, 1.6), pick(random, 0.4, 1), pick(random, 0, 0.5)};
    if (random() % 8 == 0) one = {1, 1, 0};
    if (random() % 8 == 0) one.shear = 0;
    if (random() % 20 == 0) one.max_length = 1e7;
    limits.push_back(one);
  }
  return limits;
}

MeshBruteForce::MeshBruteForce(const MeshBody& body, const std::vector<MeshLimits>& limits)
    : m_nodes(body.node_count()) {
  for (auto& coordinate : q) coordinate.assign(m_nodes, 0);
  for (std::size_t n = 0; n < body.links.size(); ++n) {
    const auto [a, b] = body.links[n];
    const MeshLimits& limit = limits[n];
    Link link{a, b, {}, {}};
    Real squared = 0;
    std::array<Real, 3> r;
    for (int c = 0; c < 3; ++c) {
      r[c] = Real(body.rest_mm[b][c]) - body.rest_mm[a][c];
      squared += r[c] * r[c];
    }
    const Real length = std::sqrt(squared);
    for (int c = 0; c < 3; ++c) {
      const Real e = length == 0 ? 0 : r[c] / length;
      const Real sideways = Real(limit.shear) * std::sqrt(std::max(Real(0), 1 - e * e)) * length;
      const Wide grow =
          units_below_mm((Real(limit.max_length) - 1) * std::abs(e) * length + sideways);
      const Wide shrink =
          units_below_mm((1 - Real(limit.min_length)) * std::abs(e) * length + sideways);
      link.longer[c] = e < 0 ? shrink : grow;
      link.shorter[c] = e < 0 ? grow : shrink;
    }
    m_links.push_back(link);
  }
}

std::vector<Wide> MeshBruteForce::distances(int c, int source, bool from) const {
  std::vector<Wide> distance(m_nodes, kNoPath);
  distance[source] = 0;
  bool changed = true;
  const auto lower_to = [&](int node, Wide value) {
    if (value >= distance[node]) return;
    distance[node] = value;
    changed = true;
  };
  const auto visit = [&](const Link& link) {
    // T_a - T_b <= shorter and T_b - T_a <= longer.
    lower_to(link.b, distance[link.a] + (from ? link.shorter : link.longer)[c]);
    lower_to(link.a, distance[link.b] + (from ? link.longer : link.shorter)[c]);
  };
  while (changed) {
    changed = false;
    for (auto link = m_links.begin(); link != m_links.end(); ++link) visit(*link);
    for (auto link = m_links.rbegin(); link != m_links.rend(); ++link) visit(*link);
  }
  return distance;
}

std::vector<MeshBruteForce::Limit> MeshBruteForce::limits(int c, bool lower,
                                                          const std::vector<Grab>& grabs,
                                                          const std::vector<int>& anchors) const {
  std::vector<Limit> list;
  for (const int node : anchors) list.push_back({node, 0, false});
  for (const Grab& grab : grabs) {
    if (grab.push && (lower ? grab.by[c] <= 0 : grab.by[c] >= 0)) continue;
    for (const int node : grab.nodes) list.push_back({node, grab.by[c], true});
  }
  return list;
}

void MeshBruteForce::compare(int c, const std::vector<Limit>& lower,
                             const std::vector<Limit>& upper, Outcome& outcome) const {
  for (const Limit& a : lower) {
    const std::vector<Wide> distance = distances(c, a.node, true);
    for (const Limit& b : upper) {
      const Wide spread = a.by - b.by;
      const Wide room = distance[b.node] - (q[c][a.node] - q[c][b.node]);
      if (spread <= room) continue;
      if (a.is_handle && b.is_handle) {
        outcome.conflict = true;
        outcome.conflict_axis = c;
        outcome.missing = std::max(outcome.missing, spread - room);
      } else if (room * outcome.denominator < outcome.numerator * spread) {
        const Wide divisor = std::gcd(room, spread);
        outcome.numerator = room / divisor;
        outcome.denominator = spread / divisor;
      }
    }
  }
}

MeshBruteForce::Outcome MeshBruteForce::drag(const std::vector<Grab>& grabs,
                                             const std::vector<int>& anchors) {
  Outcome outcome;
  for (int c = 0; c < 3 && !outcome.conflict; ++c) {
    compare(c, limits(c, true, grabs, anchors), limits(c, false, grabs, anchors), outcome);
  }
  if (outcome.conflict) return outcome;
  for (int c = 0; c < 3; ++c) {
    std::vector<Wide> least(m_nodes, -4 * kNoPath), greatest(m_nodes, 4 * kNoPath);
    for (const bool lower : {true, false}) {
      for (const Limit& bound : limits(c, lower, grabs, anchors)) {
        const Wide target = q[c][bound.node] + part_of(bound.by, outcome);
        const std::vector<Wide> distance = distances(c, bound.node, lower);
        for (std::size_t j = 0; j < m_nodes; ++j) {
          if (distance[j] >= kNoPath) continue;
          if (lower) least[j] = std::max(least[j], target - distance[j]);
          if (!lower) greatest[j] = std::min(greatest[j], target + distance[j]);
        }
      }
    }
    for (std::size_t j = 0; j < m_nodes; ++j) q[c][j] = std::clamp(q[c][j], least[j], greatest[j]);
  }
  return outcome;
}

Wide MeshBruteForce::project() {
  Wide largest = 0;
  for (int c = 0; c < 3; ++c) {
    std::vector<Wide> above = q[c], below = q[c];
    for (std::size_t i = 0; i < m_nodes; ++i) {
      const std::vector<Wide> from = distances(c, int(i), true), to = distances(c, int(i), false);
      for (std::size_t j = 0; j < m_nodes; ++j) {
        if (from[j] < kNoPath) above[j] = std::max(above[j], q[c][i] - from[j]);
        if (to[j] < kNoPath) below[j] = std::min(below[j], q[c][i] + to[j]);
      }
    }
    for (std::size_t j = 0; j < m_nodes; ++j) {
      const Wide middle = Wide(std::floor(double(above[j] + below[j]) / 2));
      largest = std::max(largest, std::abs(middle - q[c][j]));
      q[c][j] = middle;
    }
  }
  return largest;
}

int MeshBruteForce::broken_links() const {
  int broken = 0;
  for (const Link& link : m_links) {
    bool is_broken = false;
    for (int c = 0; c < 3; ++c) {
      const Wide rise = q[c][link.b] - q[c][link.a];
      is_broken |= rise > link.longer[c] || -rise > link.shorter[c];
    }
    broken += is_broken;
  }
  return broken;
}

void expect_equal(const MeshBody& body, const MeshBruteForce& brute) {
  for (std::size_t n = 0; n < body.node_count(); ++n) {
    for (int c = 0; c < 3; ++c) {
      const double expected = body.rest_mm[n][c] + double(brute.q[c][n]) / 65536;
      if (body.pos_mm[n][c] == expected) continue;
      ADD_FAILURE() << "node " << n << " coordinate " << c << ": " << body.pos_mm[n][c]
                    << " instead of " << expected;
      return;
    }
  }
}

}  // namespace supple::test
