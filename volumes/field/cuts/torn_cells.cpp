// What the sides of a cut cell have where their own corners end: the virtual nodes of Molino, Bao
// and Fedkiw ("A virtual node algorithm for changing mesh topology during simulation", 2004), with
// extrapolated instead of simulated places.
#include "volumes/field/cuts/torn_cells.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>

#include <tbb/parallel_for.h>

#include "volumes/grid/cell.h"
#include "volumes/grid/padded_rows.h"

namespace supple {

namespace {

// A slope beyond this, in voxels per link, folds; it is not carried on.
constexpr float kSteepest = 1;

/// A voxel as it is seen from a corner of another side.
struct TornView {
  Vec3i voxel, from;

  bool operator==(const TornView& other) const {
    return voxel == other.voxel && from == other.from;
  }
};
struct ViewHash {
  std::size_t operator()(const TornView& view) const {
    const Vec3i step = view.from - view.voxel;
    return VoxelHash()(view.voxel) * 31 + std::size_t(9 * step.x + 3 * step.y + step.z + 13);
  }
};

Vec3i corner_of(const Vec3i& cell, int n) {
  return cell + cell_corner(n);
}

/// Views of one voxel from corners of one side belong together, through all cells.
class VirtualNodes {
 public:
  VirtualNodes(const VectorBricks& u, const CutBody& body) : m_u(u), m_body(body) {}

  void add(const Vec3i& cell, const CellSides& sides) {
    for (int v = 0; v < 8; ++v) {
      std::array<int, 8> first;
      first.fill(-1);
      for (int r = 0; r < 8; ++r) {
        const std::uint8_t side = sides.of[std::size_t(r)];
        if (side == sides.of[std::size_t(v)]) continue;
        const int view = number_of({corner_of(cell, v), corner_of(cell, r)});
        int& other = first[side];
        if (other >= 0) m_parent[std::size_t(root(view))] = root(other);
        other = view;
      }
    }
  }
  void extrapolate() {
    std::vector<int> order(m_views.size());
    std::iota(order.begin(), order.end(), 0);
    for (int& view : m_parent) view = root(view);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
      return m_parent[std::size_t(a)] < m_parent[std::size_t(b)];
    });
    m_values.resize(m_views.size());
    for (auto begin = order.begin(); begin != order.end();) {
      const int node = m_parent[std::size_t(*begin)];
      const auto end = std::find_if(begin, order.end(),
                                    [&](int view) { return m_parent[std::size_t(view)] != node; });
      m_values[std::size_t(node)] = value_of(begin, end);
      begin = end;
    }
  }
  Vec3f value(const Vec3i& voxel, const Vec3i& from) const {
    return m_values[std::size_t(m_parent[std::size_t(m_numbers.at({voxel, from}))])];
  }

 private:
  int number_of(const TornView& view) {
    const auto [found, is_new] = m_numbers.emplace(view, int(m_views.size()));
    if (is_new) {
      m_parent.push_back(found->second);
      m_views.push_back(view);
    }
    return found->second;
  }
  int root(int n) const {
    while (m_parent[std::size_t(n)] != n) n = m_parent[std::size_t(n)];
    return n;
  }
  /// The mean of the nearest views, those that carry a slope before those that do not.
  template <class Iterator>
  Vec3f value_of(Iterator begin, Iterator end) const {
    Vec3d sum(0);
    int count = 0, best = 100;
    for (auto n = begin; n != end; ++n) {
      const TornView& view = m_views[std::size_t(*n)];
      const Vec3i step = view.from - view.voxel;
      Vec3f near(0), behind(0);
      m_u.at(view.from, near);
      const bool has_slope = m_u.at(view.from + step, behind) &&
                             m_body.connects(view.from, view.from + step) &&
                             (near - behind).length() < kSteepest;
      const int rank = step.dot(step) + (has_slope ? 0 : 3);
      if (rank > best) continue;
      if (rank < best) {
        best = rank;
        sum = Vec3d(0);
        count = 0;
      }
      sum += has_slope ? Vec3d(near) * 2.0 - Vec3d(behind) : Vec3d(near);
      ++count;
    }
    return Vec3f(sum / double(count));
  }

  const VectorBricks& m_u;
  const CutBody& m_body;
  std::unordered_map<TornView, int, ViewHash> m_numbers;
  std::vector<TornView> m_views;
  std::vector<int> m_parent;
  std::vector<Vec3f> m_values;
};

TornCell cell_of(const Vec3i& cell, const CellSides& sides, const VectorBricks& u,
                 const VirtualNodes& nodes) {
  TornCell torn{cell, sides, std::vector<std::array<Vec3f, 8>>(std::size_t(sides.count))};
  for (std::size_t side = 0; side < torn.u.size(); ++side) {
    const auto own = std::find(sides.of.begin(), sides.of.end(), side) - sides.of.begin();
    for (int v = 0; v < 8; ++v) {
      Vec3f& value = torn.u[side][std::size_t(v)];
      if (sides.of[std::size_t(v)] == side) {
        u.at(corner_of(cell, v), value);
      } else {
        value = nodes.value(corner_of(cell, v), corner_of(cell, int(own)));
      }
    }
  }
  return torn;
}

bool is_closed(const TornCell& torn, double closed) {
  for (const auto& side : torn.u) {
    for (std::size_t v = 0; v < 8; ++v) {
      const Vec3f apart = side[v] - torn.u[torn.sides.of[v]][v];
      if (!(apart.length() <= closed)) return false;
    }
  }
  return true;
}

/// The parted cells that begin in a brick and those that share corners with them, sorted.
std::vector<const PartedCell*> parted_around(const CutBody& body, std::size_t b) {
  const Vec3i& origin = body.cells().origin(b);
  const IndexBox box{origin - Vec3i(1), origin + Vec3i(kBrickDim)};
  std::vector<const PartedCell*> around;
  for (const std::int32_t n : surroundings_of(body.cells(), b)) {
    if (n < 0) continue;
    for (const PartedCell& parted : body.parted_in(std::size_t(n))) {
      if (box.contains(parted.cell)) around.push_back(&parted);
    }
  }
  std::sort(around.begin(), around.end(), [](const PartedCell* a, const PartedCell* b_) {
    return voxel_less(a->cell, b_->cell);
  });
  return around;
}

/// What a cell shares with others follows from those that share corners with it.
std::vector<TornCell> torn_in(const VectorBricks& u, const CutBody& body, std::size_t b,
                              double closed) {
  std::vector<TornCell> torn;
  if (body.parted_in(b).empty()) return torn;
  VirtualNodes nodes(u, body);
  for (const PartedCell* parted : parted_around(body, b)) nodes.add(parted->cell, parted->sides);
  nodes.extrapolate();
  for (const PartedCell& parted : body.parted_in(b)) {
    TornCell cell = cell_of(parted.cell, parted.sides, u, nodes);
    if (!is_closed(cell, closed)) torn.push_back(std::move(cell));
  }
  return torn;
}

}  // namespace

BrickList TornCells::follow(const VectorBricks& u, const CutBody& body, const BrickList& changed,
                            double closed) {
  const BrickList bricks = bricks_where(with_neighbours(body.cells(), changed), [&](std::size_t b) {
    return !m_cells[b].empty() || !body.parted_in(b).empty();
  });
  std::vector<std::vector<TornCell>> found(bricks.size());
  tbb::parallel_for(std::size_t(0), bricks.size(), [&](std::size_t n) {
    found[n] = torn_in(u, body, std::size_t(bricks[n]), closed);
  });
  BrickList others;
  for (std::size_t n = 0; n < bricks.size(); ++n) {
    std::vector<TornCell>& cells = m_cells[std::size_t(bricks[n])];
    if (cells == found[n]) continue;
    m_count += std::int64_t(found[n].size()) - std::int64_t(cells.size());
    cells = std::move(found[n]);
    others.push_back(bricks[n]);
  }
  return others;
}

bool TornCells::holds(const Vec3i& cell) const {
  const std::int32_t b = m_bricks.find(cell);
  if (b < 0) return false;
  const std::vector<TornCell>& cells = m_cells[std::size_t(b)];
  const auto found = std::lower_bound(
      cells.begin(), cells.end(), cell,
      [](const TornCell& torn, const Vec3i& at) { return voxel_less(torn.cell, at); });
  return found != cells.end() && found->cell == cell;
}

}  // namespace supple
