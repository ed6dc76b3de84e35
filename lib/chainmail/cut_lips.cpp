#include "lib/chainmail/cut_lips.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <tbb/parallel_for.h>

namespace supple {

namespace {

/// Neighbouring links of a sheet are crossed at heights that differ by no more, in voxels.
constexpr double kSteepest = 1.6;
/// Of cut links of all axes nearby, the axis of a sheet has at least this part of the most.
constexpr double kDominant = 0.7;
/// Points further before the other lip than this are not kept from it, in voxels.
constexpr double kNear = 3;
constexpr double kDeep = 2;
/// Lips that slid along each other stay this far apart, so that no place belongs to both.
constexpr double kApart = 1.0 / 64, kSlid = 1.0 / 16;
/// A slope beyond this is not carried on (volumes/field/cuts/torn_cells.cpp).
constexpr double kSteepestCarried = 1;

int first_other(int axis) {
  return axis == 0 ? 1 : 0;
}
int second_other(int axis) {
  return axis == 2 ? 1 : 2;
}

/// Cut links per axis in blocks of two voxels.
class CutCounts {
 public:
  void add(const Vec3i& voxel, int axis) { ++m_counts[block_of(voxel)][std::size_t(axis)]; }
  bool is_dominant(const Vec3i& voxel, int axis) const {
    std::array<int, 3> sum{};
    for (int n = 0; n < 27; ++n) {
      const auto found =
          m_counts.find(block_of(voxel) + Vec3i(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1));
      if (found == m_counts.end()) continue;
      for (std::size_t a = 0; a < 3; ++a) sum[a] += found->second[a];
    }
    return sum[std::size_t(axis)] >= kDominant * *std::max_element(sum.begin(), sum.end());
  }

 private:
  static Vec3i block_of(const Vec3i& voxel) { return {voxel.x >> 1, voxel.y >> 1, voxel.z >> 1}; }
  std::unordered_map<Vec3i, std::array<int, 3>, VoxelHash> m_counts;
};

template <class Visit>
void for_each_cut(const Body& body, const LinkCuts& cuts, Visit&& visit) {
  const LinkCuts none;
  for (std::size_t b = 0; b < cuts.brick_end(); ++b) {
    const LinkCuts::BrickCuts* links = cuts.brick(b);
    for (int axis = 0; links != nullptr && axis < 3; ++axis) {
      for_each_active((*links)[std::size_t(axis)], [&](int offset) {
        const Slot low = Slot(b * kBrickVoxels) + Slot(offset);
        Slot high;
        if (!neighbour_slot(body.elements, none, low, axis, true, high)) return;
        const bool is_joint = body.rigid.at(low) >= 0 && body.rigid.at(high) >= 0;
        if (!is_joint) visit(axis, low, high, cuts.place(b, offset, axis));
      });
    }
  }
}

double cross(double ux, double uy, double vx, double vy) {
  return ux * vy - uy * vx;
}

/// Inside a cell with corners (0, 0), (1, 0), (0, 1), (1, 1), or on its border: the weights.
bool weights_in(const std::array<double, 8>& corners, double x, double y,
                std::array<double, 4>& weights) {
  double s = 0.5, t = 0.5;
  for (int step = 0; step < 12; ++step) {
    weights = {(1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t};
    double dx = x, dy = y;
    for (std::size_t n = 0; n < 4; ++n) {
      dx -= weights[n] * corners[2 * n];
      dy -= weights[n] * corners[2 * n + 1];
    }
    if (std::abs(dx) + std::abs(dy) < 1e-9) break;
    const double sx = (1 - t) * (corners[2] - corners[0]) + t * (corners[6] - corners[4]);
    const double sy = (1 - t) * (corners[3] - corners[1]) + t * (corners[7] - corners[5]);
    const double tx = (1 - s) * (corners[4] - corners[0]) + s * (corners[6] - corners[2]);
    const double ty = (1 - s) * (corners[5] - corners[1]) + s * (corners[7] - corners[3]);
    const double det = cross(sx, sy, tx, ty);
    if (!(std::abs(det) > 1e-6)) return false;
    s = std::clamp(s + cross(dx, dy, tx, ty) / det, -1.0, 2.0);
    t = std::clamp(t + cross(sx, sy, dx, dy) / det, -1.0, 2.0);
  }
  constexpr double kBorder = 1e-6;
  return s >= -kBorder && s <= 1 + kBorder && t >= -kBorder && t <= 1 + kBorder;
}

}  // namespace

CutLips::CutLips(const Body& body, const LinkCuts& cuts)
    : m_body(body), m_cuts(cuts), m_source{body.elements, cuts, body.rigid.number_of} {
  CutCounts counts;
  for_each_cut(body, cuts, [&](int axis, Slot low, Slot, LinkCuts::Place) {
    counts.add(voxel_of(body.elements, low), axis);
  });
  for_each_cut(body, cuts, [&](int axis, Slot low, Slot high, LinkCuts::Place place) {
    const Vec3i voxel = voxel_of(body.elements, low);
    if (!counts.is_dominant(voxel, axis)) return;
    m_sheets[std::size_t(axis)].lips.push_back(
        {{low, high}, voxel, LinkCuts::fraction_of(place), 0});
  });
  for (int axis = 0; axis < 3; ++axis) join_sheets(axis);
}

bool CutLips::empty() const {
  return m_sheets[0].cells.empty() && m_sheets[1].cells.empty() && m_sheets[2].cells.empty();
}

bool CutLips::is_current() const {
  return m_source.elements == m_body.elements && m_source.rigid == m_body.rigid.number_of &&
         m_source.cuts == m_cuts;
}

/// The quarter of a cell at a lip's end, as far as half a voxel beyond it or to the next lip.
CutLips::Cell CutLips::rim_cell(int lip, int beside, int above, double u, double v) {
  Cell cell{{lip, lip, lip, lip}, {0, 0, u, 0, 0, v, u, v}};
  if (beside >= 0) {
    cell.lips[1] = beside;
    cell.beyond[2] = cell.beyond[6] = 0;
    cell.lips[3] = beside;
  }
  if (above >= 0) {
    cell.lips[2] = above;
    cell.beyond[5] = cell.beyond[7] = 0;
    if (beside < 0) cell.lips[3] = above;
  }
  return cell;
}

/// The lip beside one, at the nearest height; -1: none.
int CutLips::neighbour(int axis, const LipMap& at, const Lip& lip, int along, int step) const {
  int best = -1;
  double least = kSteepest;
  for (const int up : {0, -1, 1, -2, 2}) {
    Vec3i voxel = lip.low;
    voxel[along] += step;
    voxel[axis] += up;
    const auto found = at.find(voxel);
    if (found == at.end()) continue;
    const Lip& other = m_sheets[std::size_t(axis)].lips[std::size_t(found->second)];
    const double apart = std::abs(up + other.place - lip.place);
    if (apart > least) continue;
    least = apart;
    best = found->second;
  }
  return best;
}

/// Numbers sheets, and finds the cells between four lips.
void CutLips::join_sheets(int axis) {
  Sheets& sheets = m_sheets[std::size_t(axis)];
  LipMap at;
  for (std::size_t n = 0; n < sheets.lips.size(); ++n) at.emplace(sheets.lips[n].low, int(n));
  std::vector<int> parent(sheets.lips.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int n) {
    while (parent[std::size_t(n)] != n) n = parent[std::size_t(n)];
    return n;
  };
  const int u = first_other(axis), v = second_other(axis);
  const auto nearest = [&](int n, int along, int step) {
    return neighbour(axis, at, sheets.lips[std::size_t(n)], along, step);
  };
  // Of layers near each other, lips of one.
  const auto next = [&](int n, int along, int step) {
    const int other = n < 0 ? -1 : nearest(n, along, step);
    return other >= 0 && nearest(other, along, -step) == n ? other : -1;
  };
  for (int n = 0; n < int(sheets.lips.size()); ++n) {
    for (const int other : {next(n, u, 1), next(n, v, 1)}) {
      if (other < 0) continue;
      parent[std::size_t(std::max(root(n), root(other)))] = std::min(root(n), root(other));
    }
    for (const int su : {-1, 1}) {
      for (const int sv : {-1, 1}) {
        const int beside = next(n, u, su), above = next(n, v, sv), far = next(beside, v, sv);
        const bool is_whole = far >= 0 && far == next(above, u, su);
        // A whole cell is found from its first corner.
        if (!is_whole) {
          sheets.cells.push_back(rim_cell(n, beside, above, 0.5 * su, 0.5 * sv));
        } else if (su > 0 && sv > 0) {
          sheets.cells.push_back({{n, beside, above, far}});
        }
      }
    }
  }
  std::unordered_map<Vec3i, int, VoxelHash> layers;
  const auto layers_of = [&](const Lip& lip) -> int& {
    return layers[{lip.sheet, lip.low[u], lip.low[v]}];
  };
  for (int n = 0; n < int(sheets.lips.size()); ++n) {
    Lip& lip = sheets.lips[std::size_t(n)];
    lip.sheet = root(n);
    ++layers_of(lip);
  }
  for (Lip& lip : sheets.lips) lip.is_layered = layers_of(lip) > 1;
}

/// Where a sheet has several layers, a lip faces what it lay on.
bool CutLips::is_of_one_layer(const Sheets& sheets, std::size_t n, const Cell& cell) {
  bool is_layered = sheets.lips[n].is_layered, is_own = false;
  for (const int corner : cell.lips) {
    is_layered = is_layered || sheets.lips[std::size_t(corner)].is_layered;
    is_own = is_own || std::size_t(corner) == n;
  }
  return is_own || !is_layered;
}

Vec3d CutLips::displacement(Slot slot) const {
  return Vec3d(m_body.q[0].at(slot), m_body.q[1].at(slot), m_body.q[2].at(slot)) / kFixedOne;
}

/// What the side of `own` has at an element of the other side, as torn cells have it.
Vec3d CutLips::carried_on(Slot beyond, Slot own) const {
  const LinkCuts none;
  const Vec3d here = displacement(own);
  Vec3d sum(0);
  int count = 0;
  for (int axis = 0; axis < 3; ++axis) {
    for (const bool positive : {false, true}) {
      Slot near, behind;
      if (!neighbour_slot(m_body.elements, none, beyond, axis, positive, near)) continue;
      if (neighbour_slot(m_body.elements, m_cuts, beyond, axis, positive, behind)) continue;
      if (!neighbour_slot(m_body.elements, m_cuts, near, axis, positive, behind)) continue;
      const Vec3d at_near = displacement(near), slope = at_near - displacement(behind);
      if (!(slope.length() < kSteepestCarried) || (at_near - here).length() > 1) continue;
      sum += at_near + slope;
      ++count;
    }
  }
  return count == 0 ? here : sum / double(count);
}

/// Where each lip ends now.
CutLips::Points CutLips::points(int axis, int side) const {
  const std::vector<Lip>& lips = m_sheets[std::size_t(axis)].lips;
  Points points(lips.size());
  tbb::parallel_for(std::size_t(0), lips.size(), [&](std::size_t n) {
    const Lip& lip = lips[n];
    const Slot own = lip.ends[std::size_t(side)];
    const Vec3d near = displacement(own);
    const Vec3d far = carried_on(lip.ends[std::size_t(1 - side)], own);
    const double part = side == 0 ? lip.place : 1 - lip.place;
    points[n] = Vec3d(lip.low) + near + (far - near) * part;
    points[n][axis] += lip.place;
  });
  return points;
}

/// The cells of one lip by where they are now, over the axes across.
class CutLips::CellFinder {
 public:
  CellFinder(const Sheets& sheets, const Points& points, int axis)
      : m_sheets(sheets), m_u(first_other(axis)), m_v(second_other(axis)) {
    m_corners.resize(sheets.cells.size());
    for (std::size_t n = 0; n < sheets.cells.size(); ++n) {
      std::array<double, 8>& corners = m_corners[n];
      for (std::size_t k = 0; k < 4; ++k) {
        const Vec3d& point = points[std::size_t(sheets.cells[n].lips[k])];
        corners[2 * k] = point[m_u] + sheets.cells[n].beyond[2 * k];
        corners[2 * k + 1] = point[m_v] + sheets.cells[n].beyond[2 * k + 1];
      }
      add(int(n));
    }
  }

  /// `visit(cell, weights)` for the cells of a sheet over which a place lies.
  template <class Visit>
  void for_each_at(int sheet, const Vec3d& point, Visit&& visit) const {
    const double x = point[m_u], y = point[m_v];
    const auto found = m_at.find({sheet, int(std::floor(x)), int(std::floor(y))});
    if (found == m_at.end()) return;
    std::array<double, 4> weights;
    for (const int n : found->second) {
      if (weights_in(m_corners[std::size_t(n)], x, y, weights)) visit(std::size_t(n), weights);
    }
  }

 private:
  void add(int n) {
    constexpr double kBorder = 1e-5;
    constexpr int kWidest = 64;  // voxels: cells torn further face nothing
    const std::array<double, 8>& c = m_corners[std::size_t(n)];
    const auto [x0, x1] = std::minmax({c[0], c[2], c[4], c[6]});
    const auto [y0, y1] = std::minmax({c[1], c[3], c[5], c[7]});
    if (x1 - x0 > kWidest || y1 - y0 > kWidest) return;
    const Cell& cell = m_sheets.cells[std::size_t(n)];
    const int sheet = m_sheets.lips[std::size_t(cell.lips[0])].sheet;
    for (int x = int(std::floor(x0 - kBorder)); x <= int(std::floor(x1 + kBorder)); ++x) {
      for (int y = int(std::floor(y0 - kBorder)); y <= int(std::floor(y1 + kBorder)); ++y) {
        m_at[{sheet, x, y}].push_back(n);
      }
    }
  }

  const Sheets& m_sheets;
  const int m_u, m_v;
  std::vector<std::array<double, 8>> m_corners;
  std::unordered_map<Vec3i, std::vector<int>, VoxelHash> m_at;
};

/// `visit(side, lip, cell, facing)` for every point of a lip over a cell of the other lip.
template <class Visit>
void CutLips::for_each_facing(int axis, Visit&& visit) const {
  const Sheets& sheets = m_sheets[std::size_t(axis)];
  if (sheets.cells.empty()) return;
  const std::array<Points, 2> at = {points(axis, 0), points(axis, 1)};
  using Faced = std::pair<std::size_t, Facing>;  // a cell
  std::vector<std::vector<Faced>> faced(sheets.lips.size());
  for (int side = 0; side < 2; ++side) {
    const Points& others = at[std::size_t(1 - side)];
    const CellFinder finder(sheets, others, axis);
    tbb::parallel_for(std::size_t(0), sheets.lips.size(), [&](std::size_t n) {
      const Lip& lip = sheets.lips[n];
      const Vec3d& point = at[std::size_t(side)][n];
      faced[n].clear();
      finder.for_each_at(lip.sheet, point, [&](std::size_t c, const std::array<double, 4>& w) {
        if (!is_of_one_layer(sheets, n, sheets.cells[c])) return;
        double height = 0;
        Vec3d from(0);
        for (std::size_t k = 0; k < 4; ++k) {
          const auto corner = std::size_t(sheets.cells[c].lips[k]);
          height += w[k] * others[corner][axis];
          from += w[k] * Vec3d(sheets.lips[corner].low);
          from[first_other(axis)] += w[k] * sheets.cells[c].beyond[2 * k];
          from[second_other(axis)] += w[k] * sheets.cells[c].beyond[2 * k + 1];
        }
        Vec3d slid = from - Vec3d(lip.low);
        slid[axis] = 0;
        const double gap = side == 0 ? height - point[axis] : point[axis] - height;
        faced[n].emplace_back(c, Facing{w, gap, slid.length()});
      });
    });
    for (std::size_t n = 0; n < faced.size(); ++n) {
      for (const auto& [c, facing] : faced[n]) visit(side, n, sheets.cells[c], facing);
    }
  }
}

CutLips::Before CutLips::points_before() const {
  Before before;
  for (int axis = 0; axis < 3; ++axis) {
    auto& sides = before[std::size_t(axis)];
    for (auto& side : sides) side.assign(m_sheets[std::size_t(axis)].lips.size(), 0);
    for_each_facing(axis, [&](int side, std::size_t n, const Cell&, const Facing& facing) {
      if (facing.gap > -1) sides[std::size_t(side)][n] = 1;
    });
  }
  return before;
}

CutLips::Contacts CutLips::contacts(int axis, const Before& before, double part) const {
  Contacts contacts;
  const Sheets& sheets = m_sheets[std::size_t(axis)];
  for_each_facing(axis, [&](int side, std::size_t n, const Cell& cell, const Facing& facing) {
    if (facing.gap > kNear) return;
    const bool was_before = before[std::size_t(axis)][std::size_t(side)][n] != 0;
    if (facing.gap < -kDeep && !was_before) return;
    const double wanted = facing.slid > kSlid ? kApart : 0;
    if (facing.gap < wanted - kApart / 2) {
      ++contacts.overlapping;
      contacts.too_deep += facing.gap < -kLipOverlap;
      contacts.deepest_voxels = std::max(contacts.deepest_voxels, wanted - facing.gap);
    }
    const double way = wanted - facing.gap;
    const auto closer = std::int64_t(std::ceil((way > 0 ? part * way : way) * kFixedOne));
    for (std::size_t k = 0; k < 4; ++k) {
      if (facing.weights[k] < 1e-6) continue;
      const Slot own = sheets.lips[n].ends[std::size_t(side)];
      const Slot other = sheets.lips[std::size_t(cell.lips[k])].ends[std::size_t(1 - side)];
      ContactLink link{side == 0 ? own : other, side == 0 ? other : own, closer};
      link.least += m_body.q[std::size_t(axis)].at(link.above);
      link.least -= m_body.q[std::size_t(axis)].at(link.below);
      contacts.links.push_back(link);
    }
  });
  return contacts;
}

}  // namespace supple
