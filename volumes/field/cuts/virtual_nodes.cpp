// The virtual nodes of Molino, Bao and Fedkiw ("A virtual node algorithm for changing mesh topology
// during simulation", 2004), with extrapolated instead of simulated places.
#include "volumes/field/cuts/virtual_nodes.h"

#include <algorithm>
#include <numeric>
#include <unordered_map>

#include "volumes/grid/cell.h"
#include "volumes/grid/padded_rows.h"

namespace supple {

namespace {

// A slope beyond this, in voxels per link, folds; it is not carried on.
constexpr float kSteepest = 1;
// Views that carry no slope count as this much further away, in voxels squared.
constexpr int kWithoutSlope = 3;

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
class ViewGroups {
 public:
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
  /// Gives every view the number of its group, from 0.
  void finish() {
    std::vector<int> number(m_views.size(), -1);
    for (std::size_t n = 0; n < m_views.size(); ++n) {
      int& group = number[std::size_t(root(int(n)))];
      if (group < 0) group = m_count++;
      m_groups.push_back(group);
    }
  }
  int count() const { return m_count; }
  const std::vector<TornView>& views() const { return m_views; }
  int group(std::size_t view) const { return m_groups[view]; }
  int group(const Vec3i& voxel, const Vec3i& from) const {
    return m_groups[std::size_t(m_numbers.at({voxel, from}))];
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

  std::unordered_map<TornView, int, ViewHash> m_numbers;
  std::vector<TornView> m_views;
  std::vector<int> m_parent, m_groups;
  int m_count = 0;
};

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

bool is_closed(const TornCell& torn, double closed) {
  for (const auto& side : torn.u) {
    for (std::size_t v = 0; v < 8; ++v) {
      const Vec3f apart = side[v] - torn.u[torn.sides.of[v]][v];
      if (!(apart.length() <= closed)) return false;
    }
  }
  return true;
}

}  // namespace

/// Nodes that a cell shares with others follow from the cells that share corners with it.
VirtualNodes::VirtualNodes(const BrickTopology& voxels, const CutBody& body, std::size_t b) {
  const auto place_of = [&](const Vec3i& voxel) {
    return voxels.is_active(voxel) ? Place{voxels.find(voxel), brick_offset(voxel)} : Place();
  };
  ViewGroups groups;
  for (const PartedCell* parted : parted_around(body, b)) groups.add(parted->cell, parted->sides);
  groups.finish();
  for (const PartedCell& parted : body.parted_in(b)) {
    Cell cell{parted, {}, {}};
    cell.of_sides.resize(std::size_t(parted.sides.count));
    for (int v = 0; v < 8; ++v) cell.own[std::size_t(v)] = place_of(corner_of(parted.cell, v));
    for (std::size_t side = 0; side < cell.of_sides.size(); ++side) {
      const auto& of = parted.sides.of;
      const auto own = int(std::find(of.begin(), of.end(), side) - of.begin());
      for (int v = 0; v < 8; ++v) {
        cell.of_sides[side][std::size_t(v)] =
            of[std::size_t(v)] == side
                ? -1
                : groups.group(corner_of(parted.cell, v), corner_of(parted.cell, own));
      }
    }
    m_cells.push_back(std::move(cell));
  }
  std::vector<int> order(groups.views().size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int one, int other) {
    return groups.group(std::size_t(one)) < groups.group(std::size_t(other));
  });
  m_first.assign(std::size_t(groups.count()) + 1, int(order.size()));
  for (std::size_t n = order.size(); n-- > 0;) {
    m_first[std::size_t(groups.group(std::size_t(order[n])))] = int(n);
  }
  for (const int n : order) {
    const TornView& view = groups.views()[std::size_t(n)];
    const Vec3i step = view.from - view.voxel;
    const bool is_joined = body.connects(view.from, view.from + step);
    m_views.push_back(
        {place_of(view.from), is_joined ? place_of(view.from + step) : Place(), step.dot(step)});
  }
}

/// The mean of the nearest views, those that carry a slope before those that do not.
Vec3f VirtualNodes::value_of(int node, const BrickVectors& u) const {
  const auto at = [&](const Place& place) {
    return place.brick < 0 ? Vec3f(0) : u.brick_or_zero(std::size_t(place.brick))[place.offset];
  };
  Vec3d sum(0);
  int count = 0, best = 100;
  for (int n = m_first[std::size_t(node)]; n < m_first[std::size_t(node) + 1]; ++n) {
    const View& view = m_views[std::size_t(n)];
    const Vec3f near = at(view.from), behind = at(view.behind);
    const bool has_slope = view.behind.brick >= 0 && (near - behind).length() < kSteepest;
    const int rank = view.length2 + (has_slope ? 0 : kWithoutSlope);
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

std::vector<TornCell> VirtualNodes::torn(const BrickVectors& u, double closed) const {
  std::vector<TornCell> torn;
  std::vector<Vec3f> values;
  for (int node = 0; node + 1 < int(m_first.size()); ++node) values.push_back(value_of(node, u));
  for (const Cell& cell : m_cells) {
    TornCell found{cell.parted.cell, cell.parted.sides,
                   std::vector<std::array<Vec3f, 8>>(cell.of_sides.size())};
    for (std::size_t side = 0; side < found.u.size(); ++side) {
      for (std::size_t v = 0; v < 8; ++v) {
        const int node = cell.of_sides[side][v];
        const Place& own = cell.own[v];
        if (node >= 0) {
          found.u[side][v] = values[std::size_t(node)];
        } else if (own.brick >= 0) {
          found.u[side][v] = u.brick_or_zero(std::size_t(own.brick))[own.offset];
        }
      }
    }
    if (!is_closed(found, closed)) torn.push_back(std::move(found));
  }
  return torn;
}

}  // namespace supple
