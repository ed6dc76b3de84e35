#include "lib/contact/cut_lips.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace supple {

namespace {

/// Neighbouring links of a sheet are crossed at heights that differ by no more, in voxels.
constexpr double kSteepest = 1.6;
/// The axis of a sheet has at least this part of the cut links nearby that any axis has.
constexpr double kDominant = 0.7;
/// Points further before the other lip than this are not kept from it, in voxels.
constexpr double kNear = 3;
constexpr double kDeep = 2;
/// Lips that slid along each other stay this far apart, so that no place belongs to both.
constexpr double kApart = 1.0 / 64, kSlid = 1.0 / 16;

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
LipSheets::Cell CutLips::rim_cell(int lip, int beside, int above, double u, double v) {
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
  LipSheets& sheets = m_sheets[std::size_t(axis)];
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
  // Joins lips of one layer, where layers lie near each other: each is nearest to the other.
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

LipFacings& CutLips::facings(int axis) {
  std::optional<LipFacings>& facings = m_facings[std::size_t(axis)];
  if (!facings) facings.emplace(m_body, m_cuts, m_sheets[std::size_t(axis)], axis);
  return *facings;
}

LipsBefore CutLips::points_before() {
  LipsBefore before;
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t count = m_sheets[std::size_t(axis)].lips.size();
    auto& sides = before.of[std::size_t(axis)];
    sides.fill({std::vector<char>(count, 0), std::vector<float>(count, LipsBefore::kBeside)});
    facings(axis).for_each([&](int side, std::size_t n, const LipFacings::Facing& facing) {
      LipsBefore::Side& of = sides[std::size_t(side)];
      if (facing.gap > -1) of.is_before[n] = 1;
      of.least_gap[n] = std::min(of.least_gap[n], float(facing.gap));
    });
  }
  return before;
}

CutLips::Contacts CutLips::contacts(int axis, const LipsBefore& before, double part) {
  Contacts contacts;
  const LipSheets& sheets = m_sheets[std::size_t(axis)];
  facings(axis).for_each([&](int side, std::size_t n, const LipFacings::Facing& facing) {
    if (facing.gap > kNear) return;
    const LipsBefore::Side& then = before.of[std::size_t(axis)][std::size_t(side)];
    const bool was_before = then.is_before[n] != 0, was_deep = then.least_gap[n] < -kLipOverlap;
    if (facing.gap < -kDeep && !was_before) return;
    const double room = facing.slid > kSlid ? kApart : 0;
    const double wanted = m_body.beyond ? std::min(room, double(then.least_gap[n])) : room;
    if (facing.gap < wanted - kApart / 2) {
      ++contacts.overlapping;
      const bool is_deep = facing.gap < -kLipOverlap;
      contacts.too_deep += is_deep;
      contacts.deepened += is_deep && !(was_deep && facing.gap > then.least_gap[n] - kApart / 2);
      contacts.deepest_voxels = std::max(contacts.deepest_voxels, wanted - facing.gap);
    }
    const double way = wanted - facing.gap;
    const auto closer = std::int64_t(std::ceil((way > 0 ? part * way : way) * kFixedOne));
    for (std::size_t k = 0; k < 4; ++k) {
      if (facing.weights[k] < 1e-6) continue;
      const Cell& cell = sheets.cells[facing.cell];
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
