#include "lib/mesh/tets/stuffing.h"

#include <cmath>
#include <limits>

#include "lib/mesh/tets/mask_distance.h"
#include "lib/mesh/tets/stencil.h"
#include "volumes/base/parallel.h"

namespace supple {

namespace {

/// Vertices of one kind next to each other along x.
struct LatticeRow {
  std::int64_t first;  // id
  LatticePlace place;  // of the first
  int count;
};

/// A place on an edge, as part of it from its owner on.
struct EdgeCut {
  std::int64_t owner;
  int edge;
  double part;
};

/// A vertex that has moved to a cut.
struct MovedVertex {
  std::int64_t vertex;
  Vec3d half_edges;
};

class Stuffing {
 public:
  Stuffing(const MaskDistance& distance, const BccLattice& lattice);

  SolidMesh run(StuffReport* report, Progress* progress);

 private:
  void find_signs();
  void find_cuts();
  void warp();
  void number_nodes(SolidMesh& mesh);
  void emit(SolidMesh& mesh) const;

  double value_at(const Vec3d& half_edges) const {
    return m_distance.at(m_lattice.index_at(half_edges));
  }
  double cut_part(const Vec3d& from, const Vec3d& step, double at_start, double at_end) const;
  void find_cuts_of(const LatticeRow& row, std::vector<EdgeCut>& cuts) const;
  bool warp_vertex(std::int64_t vertex, MovedVertex& to) const;
  /// Whether the edge is cut between two vertices that are where they were.
  bool is_cut(const EdgeCut& cut) const {
    return m_signs[std::size_t(cut.owner)] * m_signs[std::size_t(other_end(cut))] < 0;
  }
  std::int64_t other_end(const EdgeCut& cut) const {
    return cut.owner + m_offsets[std::size_t(cut.edge)];
  }
  Vec3d place_of(const EdgeCut& cut) const {
    return Vec3d(m_lattice.place(cut.owner)) + Vec3d(edge_step(cut.edge)) * cut.part;
  }
  std::int64_t cut_between(const LatticePlace& p, const LatticePlace& q) const;
  template <class Visit>
  void for_each_edge(std::int64_t vertex, const Visit& visit) const;
  bool is_used(std::int64_t vertex) const;
  void emit_row(const LatticeRow& row, std::vector<std::array<std::int32_t, 4>>& tets) const;

  const MaskDistance& m_distance;
  const BccLattice& m_lattice;
  std::array<std::int64_t, kOwnedEdges> m_offsets{};  // of id, from the owner to the other end
  std::vector<LatticeRow> m_rows;
  std::vector<std::int8_t> m_signs;
  std::vector<std::uint16_t> m_cut_edges;  // per vertex: bits of owned edges
  std::vector<std::int32_t> m_first_cut;   // per vertex: index of the first of these
  std::vector<EdgeCut> m_cuts;             // ascending by owner, then edge
  std::vector<MovedVertex> m_warps;        // ascending by vertex
  std::vector<std::int32_t> m_vertex_nodes, m_cut_nodes;
};

Stuffing::Stuffing(const MaskDistance& distance, const BccLattice& lattice)
    : m_distance(distance), m_lattice(lattice) {
  const std::int64_t per_kind = lattice.vertex_count() / 2;
  for (int edge = 0; edge < kOwnedEdges; ++edge) {
    const Vec3i step = edge_step(edge);
    std::int64_t& offset = m_offsets[std::size_t(edge)];
    for (int a = 0; a < 3; ++a) offset += step[a] > 0 ? lattice.stride(a) : 0;
    if (edge >= kLongEdges) offset -= per_kind;
  }
  const Vec3i& cubes = lattice.cubes();
  for (int odd = 0; odd < 2; ++odd) {
    for (int k = 0; k + odd <= cubes.z; ++k) {
      for (int j = 0; j + odd <= cubes.y; ++j) {
        const LatticePlace place(odd, 2 * j + odd, 2 * k + odd);
        m_rows.push_back({lattice.id(place), place, cubes.x + 1 - odd});
      }
    }
  }
}

void Stuffing::find_signs() {
  m_signs.assign(std::size_t(m_lattice.vertex_count()), 1);
  parallel_for(m_rows.size(), Grain{8}, [&](std::size_t r) {
    const LatticeRow& row = m_rows[r];
    for (int i = 0; i < row.count; ++i) {
      const double value = value_at(Vec3d(row.place + Vec3i(2 * i, 0, 0)));
      m_signs[std::size_t(row.first + i)] = std::int8_t((value > 0) - (value < 0));
    }
  });
}

/// A zero of the function on an edge whose ends differ in sign: the false position method as
/// Illinois has it, and bisection where that is slow.
double Stuffing::cut_part(const Vec3d& from, const Vec3d& step, double at_start,
                          double at_end) const {
  double a = 0, b = 1, fa = at_start, fb = at_end;
  const double small = 1e-6 * m_lattice.spacing_mm();
  for (int n = 0; n < 20; ++n) {
    const double middle = n % 4 == 3 ? (a + b) / 2 : a + (b - a) * (fa / (fa - fb));
    const double value = value_at(from + step * middle);
    if (std::abs(value) <= small) return middle;
    if ((value < 0) == (fa < 0)) {
      a = middle, fa = value, fb /= 2;
    } else {
      b = middle, fb = value, fa /= 2;
    }
  }
  return (a + b) / 2;
}

void Stuffing::find_cuts_of(const LatticeRow& row, std::vector<EdgeCut>& cuts) const {
  const int edges = (row.place.x & 1) != 0 ? kOwnedEdges : kLongEdges;
  for (int i = 0; i < row.count; ++i) {
    const LatticePlace place = row.place + Vec3i(2 * i, 0, 0);
    const std::int64_t vertex = row.first + i;
    for (int edge = 0; edge < edges; ++edge) {
      EdgeCut cut{vertex, edge, 0};
      const Vec3i step = edge_step(edge);
      if (edge < kLongEdges && !m_lattice.contains(place + step)) continue;
      if (!is_cut(cut)) continue;
      const Vec3d from(place);
      cut.part = cut_part(from, Vec3d(step), value_at(from), value_at(Vec3d(place + step)));
      cuts.push_back(cut);
    }
  }
}

void Stuffing::find_cuts() {
  std::vector<std::vector<EdgeCut>> of_row(m_rows.size());
  parallel_for(m_rows.size(), Grain{8}, [&](std::size_t r) { find_cuts_of(m_rows[r], of_row[r]); });
  for (const auto& cuts : of_row) m_cuts.insert(m_cuts.end(), cuts.begin(), cuts.end());
  m_cut_edges.assign(m_signs.size(), 0);
  m_first_cut.assign(m_signs.size(), -1);
  for (std::size_t n = 0; n < m_cuts.size(); ++n) {
    const std::size_t owner = std::size_t(m_cuts[n].owner);
    if (m_cut_edges[owner] == 0) m_first_cut[owner] = std::int32_t(n);
    m_cut_edges[owner] = std::uint16_t(m_cut_edges[owner] | 1U << m_cuts[n].edge);
  }
}

/// Calls visit(cut, is_owner) for the edges of a vertex that were cut.
template <class Visit>
void Stuffing::for_each_edge(std::int64_t vertex, const Visit& visit) const {
  const bool is_centre = vertex >= m_lattice.vertex_count() / 2;
  const auto visit_owned = [&](std::int64_t owner, int edge) {
    if (owner < 0 || owner >= m_lattice.vertex_count()) return;
    const unsigned bits = m_cut_edges[std::size_t(owner)];
    if ((bits >> edge & 1U) == 0) return;
    const int before = __builtin_popcount(bits & ((1U << edge) - 1));
    visit(std::size_t(m_first_cut[std::size_t(owner)]) + std::size_t(before), owner == vertex);
  };
  for (int edge = 0; edge < (is_centre ? kOwnedEdges : kLongEdges); ++edge) {
    visit_owned(vertex, edge);
  }
  for (int edge = 0; edge < (is_centre ? kLongEdges : kOwnedEdges); ++edge) {
    visit_owned(vertex - m_offsets[std::size_t(edge)], edge);
  }
}

/// The nearest cut that is too near; false where there is none.
bool Stuffing::warp_vertex(std::int64_t vertex, MovedVertex& to) const {
  double nearest = std::numeric_limits<double>::infinity();
  for_each_edge(vertex, [&](std::size_t n, bool is_owner) {
    const EdgeCut& cut = m_cuts[n];
    if (!is_cut(cut)) return;
    const bool is_long = cut.edge < kLongEdges;
    const double part = is_owner ? cut.part : 1 - cut.part;
    const double distance = part * (is_long ? 1 : std::sqrt(0.75));
    if (part >= (is_long ? kWarpLong : kWarpShort) || distance >= nearest) return;
    nearest = distance;
    to = {vertex, place_of(cut)};
  });
  return std::isfinite(nearest);
}

void Stuffing::warp() {
  std::vector<std::int64_t> ends;
  for (const EdgeCut& cut : m_cuts) {
    ends.push_back(cut.owner);
    ends.push_back(other_end(cut));
  }
  std::sort(ends.begin(), ends.end());
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  // One after the other: a vertex that has moved takes the cuts of its edges away.
  for (const std::int64_t vertex : ends) {
    MovedVertex to{};
    if (!warp_vertex(vertex, to)) continue;
    m_warps.push_back(to);
    m_signs[std::size_t(vertex)] = 0;
  }
}

/// Whether a vertex that is not outside belongs to a tetrahedron of the mesh.
bool Stuffing::is_used(std::int64_t vertex) const {
  if (m_signs[std::size_t(vertex)] != 0) return m_signs[std::size_t(vertex)] < 0;
  const bool is_centre = vertex >= m_lattice.vertex_count() / 2;
  const auto is_inside = [&](std::int64_t other) {
    return other >= 0 && other < m_lattice.vertex_count() && m_signs[std::size_t(other)] < 0;
  };
  for (int edge = 0; edge < kOwnedEdges; ++edge) {
    const std::int64_t offset = m_offsets[std::size_t(edge)];
    if (edge < kLongEdges && (is_inside(vertex + offset) || is_inside(vertex - offset)))
      return true;
    if (edge >= kLongEdges && is_inside(is_centre ? vertex + offset : vertex - offset)) return true;
  }
  return false;
}

void Stuffing::number_nodes(SolidMesh& mesh) {
  m_vertex_nodes.assign(m_signs.size(), -1);
  auto warp = m_warps.begin();
  const std::int64_t most = std::numeric_limits<std::int32_t>::max();
  const auto add = [&](const Vec3d& half_edges) {
    if (std::int64_t(mesh.nodes_lps_mm.size()) >= most) {
      throw InputError({"", "spacing",
                        number_text(m_lattice.spacing_mm()) + " mm, more than " +
                            std::to_string(most) + " nodes",
                        "a larger one"});
    }
    mesh.nodes_lps_mm.push_back(m_lattice.lps_at(half_edges));
    return std::int32_t(mesh.nodes_lps_mm.size() - 1);
  };
  for (const LatticeRow& row : m_rows) {
    for (int i = 0; i < row.count; ++i) {
      const std::int64_t vertex = row.first + i;
      if (m_signs[std::size_t(vertex)] > 0 || !is_used(vertex)) continue;
      while (warp != m_warps.end() && warp->vertex < vertex) ++warp;
      const bool has_moved = warp != m_warps.end() && warp->vertex == vertex;
      m_vertex_nodes[std::size_t(vertex)] =
          add(has_moved ? warp->half_edges : Vec3d(row.place + Vec3i(2 * i, 0, 0)));
    }
  }
  m_cut_nodes.assign(m_cuts.size(), -1);
  for (std::size_t n = 0; n < m_cuts.size(); ++n) {
    if (is_cut(m_cuts[n])) m_cut_nodes[n] = add(place_of(m_cuts[n]));
  }
}

/// The index of the cut on the edge between two vertices.
std::int64_t Stuffing::cut_between(const LatticePlace& p, const LatticePlace& q) const {
  const bool p_owns = ((p.x ^ q.x) & 1) != 0 ? (p.x & 1) != 0 : voxel_less(p, q);
  const Vec3i step = p_owns ? q - p : p - q;
  int edge = step.x == 2 ? 0 : step.y == 2 ? 1 : 2;
  if ((step.x & 1) != 0) {
    edge = kLongEdges + (step.x > 0 ? 1 : 0) + (step.y > 0 ? 2 : 0) + (step.z > 0 ? 4 : 0);
  }
  const std::size_t owner = std::size_t(m_lattice.id(p_owns ? p : q));
  const unsigned before = m_cut_edges[owner] & ((1U << edge) - 1);
  return m_first_cut[owner] + __builtin_popcount(before);
}

/// The tetrahedra between the centres of a row and the next ones along all three axes, around each
/// of the faces between their cubes.
void Stuffing::emit_row(const LatticeRow& row,
                        std::vector<std::array<std::int32_t, 4>>& tets) const {
  LatticeTet tet;
  const auto set = [&](int n, const LatticePlace& place) {
    const std::size_t id = std::size_t(m_lattice.id(place));
    tet.places[std::size_t(n)] = place;
    tet.signs[std::size_t(n)] = m_signs[id];
    tet.nodes[std::size_t(n)] = m_vertex_nodes[id];
  };
  const auto cut = [&](int p, int q) {
    return m_cut_nodes[std::size_t(
        cut_between(tet.places[std::size_t(p)], tet.places[std::size_t(q)]))];
  };
  const auto add = [&](std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t d) {
    tets.push_back({a, b, c, d});
  };
  for (int i = 0; i < row.count; ++i) {
    const LatticePlace centre = row.place + Vec3i(2 * i, 0, 0);
    for (int axis = 0; axis < 3; ++axis) {
      LatticePlace next = centre;
      next[axis] += 2;
      if (!m_lattice.contains(next)) continue;
      const auto corner = [&](int turn) {
        LatticePlace place = centre;
        place[axis] += 1;
        place[(axis + 1) % 3] += turn == 0 || turn == 3 ? 1 : -1;
        place[(axis + 2) % 3] += turn < 2 ? 1 : -1;
        return place;
      };
      set(0, centre);
      set(1, next);
      for (int turn = 0; turn < 4; ++turn) {
        set(2, corner(turn));
        set(3, corner((turn + 1) % 4));
        stuff(tet, cut, add);
      }
    }
  }
}

void Stuffing::emit(SolidMesh& mesh) const {
  std::vector<std::vector<std::array<std::int32_t, 4>>> of_row(m_rows.size());
  parallel_for(m_rows.size(), Grain{4}, [&](std::size_t r) {
    if ((m_rows[r].place.x & 1) != 0) emit_row(m_rows[r], of_row[r]);
  });
  for (auto& tets : of_row) {
    mesh.tets.insert(mesh.tets.end(), tets.begin(), tets.end());
    tets = {};
  }
}

SolidMesh Stuffing::run(StuffReport* report, Progress* progress) {
  stage(progress, "meshing");
  find_signs();
  poll(progress);
  find_cuts();
  poll(progress);
  warp();
  SolidMesh mesh;
  number_nodes(mesh);
  poll(progress);
  emit(mesh);
  if (report != nullptr) {
    *report = {m_lattice.vertex_count(), std::int64_t(m_warps.size()), std::int64_t(m_cuts.size())};
  }
  return mesh;
}

}  // namespace

SolidMesh stuff_surface(const MaskDistance& distance, const BccLattice& lattice,
                        StuffReport* report, Progress* progress) {
  return Stuffing(distance, lattice).run(report, progress);
}

}  // namespace supple
