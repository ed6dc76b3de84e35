#include "lib/mesh/tets/lattice_tets.h"

#include <limits>
#include <unordered_map>
#include <unordered_set>

#include "volumes/base/parallel.h"
#include "volumes/grid/voxel_sets.h"

namespace supple {

namespace {

/// Cubes by their centres, from which their size follows: it is an odd number of half edges.
using Cubes = std::unordered_set<Vec3i, VoxelHash>;

template <class Visit>
void for_each_around(int radius, const Visit& visit) {
  for (int k = -radius; k <= radius; ++k) {
    for (int j = -radius; j <= radius; ++j) {
      for (int i = -radius; i <= radius; ++i) visit(Vec3i(i, j, k));
    }
  }
}

/// The centre of the cube of twice the size that holds a cube.
Vec3i parent_of(const Vec3i& centre, int half) {
  Vec3i parent;
  for (int a = 0; a < 3; ++a) parent[a] = (centre[a] / (4 * half)) * 4 * half + 2 * half;
  return parent;
}

/// Calls visit(corner) for the corners of a cube, with steps of `half` from its centre.
template <class Visit>
void for_each_cube_corner(const Vec3i& centre, int half, const Visit& visit) {
  for (int n = 0; n < 8; ++n) {
    visit(centre + Vec3i((n & 1) != 0 ? half : -half, (n & 2) != 0 ? half : -half,
                         (n & 4) != 0 ? half : -half));
  }
}

/// A number per cube of one size, i fastest; 0 beyond.
struct CubeGrid {
  Vec3i dims{0, 0, 0};
  std::vector<std::int32_t> values;

  explicit CubeGrid(const Vec3i& cubes)
      : dims(cubes), values(std::size_t(cubes.x) * std::size_t(cubes.y) * std::size_t(cubes.z)) {}
  std::size_t number(const Vec3i& at) const {
    return (std::size_t(at.z) * std::size_t(dims.y) + std::size_t(at.y)) * std::size_t(dims.x) +
           std::size_t(at.x);
  }
  std::int32_t operator()(const Vec3i& at) const {
    for (int a = 0; a < 3; ++a) {
      if (at[a] < 0 || at[a] >= dims[a]) return 0;
    }
    return values[number(at)];
  }
  template <class Visit>
  void for_each(const Visit& visit) const {
    Vec3i at;
    for (at.z = 0; at.z < dims.z; ++at.z) {
      for (at.y = 0; at.y < dims.y; ++at.y) {
        for (at.x = 0; at.x < dims.x; ++at.x) visit(at);
      }
    }
  }
};

class CubeTree {
 public:
  CubeTree(const LabelField& field, const BccLattice& lattice, const LatticeGrading& grading)
      : m_field(field), m_lattice(lattice), m_grading(grading), m_unit(1 << grading.finer) {
    m_mesh.per_half = m_unit;
    m_mesh.is_uniform = grading.coarser == 0 && grading.finer == 0;
  }

  LatticeTets run() {
    split_fine();
    find_uniform();
    merge();
    for (const Vec3i& leaf : m_leaves) m_is_leaf.insert(leaf);
    add_vertices();
    for (const Vec3i& leaf : m_leaves) add_tets(leaf);
    return std::move(m_mesh);
  }

 private:
  /// Half of a cube's edge.
  static int half_of(const Vec3i& centre) { return centre.x & -centre.x; }
  Vec3i centre_at(const Vec3i& cube, int half) const { return cube * (2 * half) + Vec3i(half); }

  bool has_fine_voxel(const Vec3i& centre, int half) const;
  void split_fine();
  void find_uniform();
  void merge();
  void add_vertices();
  std::int32_t vertex(const Vec3i& place);
  void add_tets(const Vec3i& leaf);
  void add_tet(const Vec3i& a, const Vec3i& b, const Vec3i& c, const Vec3i& d);

  const LabelField& m_field;
  const BccLattice& m_lattice;
  const LatticeGrading& m_grading;
  int m_unit;                    // half of the lattice's edge
  std::vector<Cubes> m_split;    // cubes that are split, of the lattice's size, of half, …
  CubeGrid m_uniform{Vec3i(0)};  // label where a cube has one alone, else 0; -1: all outside
  std::vector<Vec3i> m_leaves;
  Cubes m_is_leaf;
  std::unordered_map<Vec3i, std::int32_t, VoxelHash> m_vertices;
  LatticeTets m_mesh;
};

/// True if the box of a cube in the volume's grid, and a voxel around it, has one.
bool CubeTree::has_fine_voxel(const Vec3i& centre, int half) const {
  Vec3d low(1e300), high(-1e300);
  for_each_cube_corner(centre, half, [&](const Vec3i& corner) {
    const Vec3d index = m_lattice.index_at(Vec3d(corner) / double(m_unit));
    for (int a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], index[a]);
      high[a] = std::max(high[a], index[a]);
    }
  });
  const VoxelMask& fine = *m_grading.fine;
  Vec3i lo, hi;
  for (int a = 0; a < 3; ++a) {
    lo[a] = std::max(int(std::ceil(low[a] - 1)), fine.box.lo[a]);
    hi[a] = std::min(int(std::floor(high[a] + 1)), fine.box.hi[a]);
  }
  for (int k = lo.z; k <= hi.z; ++k) {
    for (int j = lo.y; j <= hi.y; ++j) {
      for (int i = lo.x; i <= hi.x; ++i) {
        if (fine.holds({i, j, k})) return true;
      }
    }
  }
  return false;
}

void CubeTree::split_fine() {
  m_split.resize(std::size_t(m_grading.finer));
  if (m_grading.finer == 0) return;
  CubeGrid(m_lattice.cubes()).for_each([&](const Vec3i& at) {
    const Vec3i centre = centre_at(at, m_unit);
    if (has_fine_voxel(centre, m_unit)) m_split[0].insert(centre);
  });
  for (std::size_t s = 1; s < m_split.size(); ++s) {
    const int half = m_unit >> s;
    for (const Vec3i& whole : m_split[s - 1]) {
      for_each_cube_corner(whole, half, [&](const Vec3i& child) {
        if (has_fine_voxel(child, half)) m_split[s].insert(child);
      });
    }
  }
  // Cubes around a split one are of its size at most.
  for (std::size_t s = m_split.size() - 1; s > 0; --s) {
    const int half = m_unit >> s;
    for (const Vec3i& centre : m_split[s]) {
      for_each_around(1, [&](const Vec3i& step) {
        const Vec3i near = centre + step * (2 * half);
        for (int a = 0; a < 3; ++a) {
          if (near[a] < 0 || near[a] > 2 * m_unit * m_lattice.cubes()[a]) return;
        }
        m_split[s - 1].insert(parent_of(near, half));
      });
    }
  }
}

void CubeTree::find_uniform() {
  m_uniform = CubeGrid(m_lattice.cubes());
  std::vector<std::int32_t> labels(std::size_t(m_lattice.vertex_count()));
  parallel_for(m_lattice.vertex_count(), Grain{4096}, [&](std::int64_t id) {
    const Vec3d index = m_lattice.index_at(Vec3d(m_lattice.place(id)));
    labels[std::size_t(id)] = m_field.is_surely_outside(index) ? -1 : m_field.at(index);
  });
  m_uniform.for_each([&](const Vec3i& at) {
    const Vec3i centre = centre_at(at, 1);
    std::int32_t label = labels[std::size_t(m_lattice.id(centre))];
    const auto join = [&](std::int32_t other) { label = other == label ? label : 0; };
    for_each_cube_corner(
        centre, 1, [&](const Vec3i& corner) { join(labels[std::size_t(m_lattice.id(corner))]); });
    for (int a = 0; a < 3; ++a) {
      for (const int way : {-2, 2}) {
        Vec3i next = centre;
        next[a] += way;
        if (m_lattice.contains(next)) join(labels[std::size_t(m_lattice.id(next))]);
      }
    }
    if (m_grading.finer > 0) {
      for_each_around(1, [&](const Vec3i& step) {
        if (m_split[0].count(centre_at(at + step, m_unit)) > 0) label = 0;
      });
    }
    m_uniform.values[m_uniform.number(at)] = label;
  });
}

/// Joins cubes of one label inside, as long as all around them have that label, too.
void CubeTree::merge() {
  CubeGrid joined = m_uniform;
  for (std::int32_t& label : joined.values) label = std::max(label, 0);
  const auto keep = [&](const CubeGrid& grid, const CubeGrid& parents, int half) {
    grid.for_each([&](const Vec3i& at) {
      const bool is_lowest = half == m_unit;
      if (is_lowest ? m_uniform(at) < 0 : grid(at) == 0) return;
      const Vec3i centre = centre_at(at, half);
      if (is_lowest && m_grading.finer > 0 && m_split[0].count(centre) > 0) return;
      if (parents(at / 2) == 0) m_leaves.push_back(centre);
    });
  };
  int half = m_unit;
  for (int level = 0; level < m_grading.coarser; ++level, half *= 2) {
    CubeGrid parents(joined.dims / 2);
    parents.for_each([&](const Vec3i& at) {
      const std::int32_t label = joined(at * 2);
      bool is_one = label != 0;
      for (int n = 0; n < 64 && is_one; ++n) {
        is_one = joined(at * 2 + Vec3i(n % 4 - 1, n / 4 % 4 - 1, n / 16 - 1)) == label;
      }
      parents.values[parents.number(at)] = is_one ? label : 0;
    });
    keep(joined, parents, half);
    joined = std::move(parents);
  }
  keep(joined, CubeGrid(Vec3i(0)), half);
  for (std::size_t s = 0; s < m_split.size(); ++s) {
    std::vector<Vec3i> split(m_split[s].begin(), m_split[s].end());
    std::sort(split.begin(), split.end(), voxel_less);
    for (const Vec3i& whole : split) {
      for_each_cube_corner(whole, m_unit >> (s + 1), [&](const Vec3i& child) {
        const bool is_split = s + 1 < m_split.size() && m_split[s + 1].count(child) > 0;
        if (!is_split) m_leaves.push_back(child);
      });
    }
  }
}

std::int32_t CubeTree::vertex(const Vec3i& place) {
  const auto [found, is_new] = m_vertices.try_emplace(place, std::int32_t(m_mesh.places.size()));
  if (is_new) m_mesh.places.push_back(place);
  return found->second;
}

void CubeTree::add_vertices() {
  m_vertices.reserve(3 * m_leaves.size());
  for (const Vec3i& leaf : m_leaves) {
    vertex(leaf);
    for_each_cube_corner(leaf, half_of(leaf), [&](const Vec3i& corner) { vertex(corner); });
  }
}

void CubeTree::add_tet(const Vec3i& a, const Vec3i& b, const Vec3i& c, const Vec3i& d) {
  const Vec3d from(a);
  const bool is_positive = (Vec3d(b) - from).cross(Vec3d(c) - from).dot(Vec3d(d) - from) > 0;
  m_mesh.tets.push_back(
      {vertex(is_positive ? a : b), vertex(is_positive ? b : a), vertex(c), vertex(d)});
}

void CubeTree::add_tets(const Vec3i& leaf) {
  const int half = half_of(leaf);
  for (int side = 0; side < 6; ++side) {
    const int axis = side / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
    Vec3i next = leaf, face = leaf;
    next[axis] += (side & 1) != 0 ? 2 * half : -2 * half;
    face[axis] += (side & 1) != 0 ? half : -half;
    std::array<Vec3i, 4> ring{face, face, face, face};
    for (std::size_t n = 0; n < 4; ++n) {
      ring[n][u] += n == 0 || n == 3 ? half : -half;
      ring[n][v] += n < 2 ? half : -half;
    }
    if (m_is_leaf.count(next) > 0) {
      if ((side & 1) == 0) continue;  // comes from the other cube
      for (std::size_t n = 0; n < 4; ++n) {
        const Vec3i &a = ring[n], &b = ring[(n + 1) % 4], middle = (a + b) / 2;
        if (m_mesh.is_uniform || m_vertices.count(middle) == 0) {
          add_tet(leaf, next, a, b);
        } else {
          add_tet(leaf, next, a, middle);
          add_tet(leaf, next, middle, b);
        }
      }
      continue;
    }
    if (m_mesh.is_uniform) continue;
    const Vec3i larger = parent_of(next, half);
    if (m_is_leaf.count(larger) == 0) continue;
    // The diagonal of the small face ends at the middle of the large one.
    Vec3i middle = larger;
    middle[axis] = face[axis];
    std::size_t n = 0;
    while (ring[n] != middle) ++n;
    const Vec3i &m = ring[n], &across = ring[(n + 2) % 4];
    for (const std::size_t other : {(n + 1) % 4, (n + 3) % 4}) {
      add_tet(leaf, m, across, ring[other]);
      add_tet(larger, m, across, ring[other]);
    }
  }
}

}  // namespace

LatticeTets lattice_tets(const LabelField& field, const BccLattice& lattice,
                         const LatticeGrading& grading) {
  return CubeTree(field, lattice, grading).run();
}

}  // namespace supple
