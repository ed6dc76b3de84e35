#include "volumes/field/cuts/cut_body.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

#include "volumes/field/inversion/reachable_bricks.h"
#include "volumes/grid/padded_rows.h"
#include "volumes/grid/voxel_sets.h"

namespace supple {

namespace {

constexpr int kShellRings = 2;
// Tissue joins two elements beside the air where it leads from one to the other within the box
// around them and as many voxels more.
constexpr int kDetour = 2;
// Elements that no tissue joins are parted where they have moved apart by more, in voxels.
constexpr double kMovedApart = 1;

Vec3i unit(int axis) {
  Vec3i step(0);
  step[axis] = 1;
  return step;
}

/// Voxels of the 27 around one, itself left out.
template <class Visit>
void for_neighbours(const Vec3i& voxel, Visit&& visit) {
  for (int n = 0; n < 27; ++n) {
    if (n != 13) visit(voxel + Vec3i(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1));
  }
}

/// Of displacements.
struct MoveBox {
  Vec3f lo{HUGE_VALF, HUGE_VALF, HUGE_VALF}, hi{-HUGE_VALF, -HUGE_VALF, -HUGE_VALF};

  void add(const Vec3f& move) { add({move, move}); }
  void add(const MoveBox& other) {
    for (int a = 0; a < 3; ++a) {
      lo[a] = std::min(lo[a], other.lo[a]);
      hi[a] = std::max(hi[a], other.hi[a]);
    }
  }
  bool is_apart() const { return lo.x <= hi.x && (hi - lo).length() > kMovedApart; }
};

}  // namespace

CutBody::CutBody(const VectorBricks& u, const BrickTopology& elements, const LinkCuts& cuts,
                 const Vec3i& dims)
    : m_u(u), m_elements(elements), m_dims(dims) {
  std::vector<Link> links;
  for (std::size_t b = 0; b < cuts.brick_end(); ++b) {
    const LinkCuts::BrickCuts* brick = cuts.brick(b);
    for (int axis = 0; brick != nullptr && axis < 3; ++axis) {
      for_each_active((*brick)[axis], [&](int offset) {
        links.push_back({elements.origin(b) + brick_local(offset), axis});
        mark(links.back());
      });
    }
  }
  cut_shell(links);
  find_parted_cells();
}

Vec3i CutBody::in_slice(Vec3i voxel) const {
  for (int a = 0; a < 3; ++a) {
    if (m_dims[a] == 1 && std::abs(voxel[a]) == 1) voxel[a] = 0;
  }
  return voxel;
}

bool CutBody::is_voxel(const Vec3i& voxel) const {
  return m_u.topology.is_active(in_slice(voxel));
}

void CutBody::mark(const Link& link) {
  m_cut[link.low] |= std::uint8_t(1 << link.axis);
}

bool CutBody::is_cut(const Vec3i& low, int axis) const {
  const auto found = m_cut.find(in_slice(low));
  return found != m_cut.end() && (found->second >> axis & 1);
}

int CutBody::ring(const Vec3i& voxel) const {
  if (is_element(voxel)) return 0;
  for (int n = 1; n <= kShellRings; ++n) {
    for (int x = -n; x <= n; ++x) {
      for (int y = -n; y <= n; ++y) {
        for (int z = -n; z <= n; ++z) {
          if (std::max({std::abs(x), std::abs(y), std::abs(z)}) < n) continue;
          if (is_element(voxel + Vec3i(x, y, z))) return n;
        }
      }
    }
  }
  return kShellRings + 1;
}

/// The voxel itself where none is in reach.
Vec3i CutBody::nearest_element(const Vec3i& voxel) const {
  if (is_element(voxel)) return voxel;
  Vec3i nearest = voxel;
  int shortest = 3 * kShellRings * kShellRings + 1;
  for (int x = -kShellRings; x <= kShellRings; ++x) {
    for (int y = -kShellRings; y <= kShellRings; ++y) {
      for (int z = -kShellRings; z <= kShellRings; ++z) {
        const Vec3i step(x, y, z);
        if (step.dot(step) >= shortest || !is_element(voxel + step)) continue;
        shortest = step.dot(step);
        nearest = voxel + step;
      }
    }
  }
  return in_slice(nearest);
}

/// Whether elements within a box lead from one to another, over links that are cut or not.
bool CutBody::joins(const IndexBox& box, const Vec3i& from, const Vec3i& to, bool over_cuts) const {
  const Vec3i size = box.hi - box.lo + Vec3i(1);
  std::vector<bool> is_reached(std::size_t(size.x) * std::size_t(size.y) * std::size_t(size.z));
  std::vector<Vec3i> reached;
  const auto reach = [&](const Vec3i& voxel) {
    const Vec3i at = voxel - box.lo;
    auto is_known = is_reached[std::size_t((at.x * size.y + at.y) * size.z + at.z)];
    if (!is_known) reached.push_back(voxel);
    is_known = true;
  };
  reach(from);
  for (std::size_t n = 0; n < reached.size(); ++n) {
    if (reached[n] == to) return true;
    for (int face = 0; face < 6; ++face) {
      const Vec3i here = reached[n], next = here + unit(face / 2) * (face % 2 ? 1 : -1);
      if (!box.contains(next) || !is_element(next)) continue;
      if (over_cuts || !is_cut(face % 2 ? here : next, face / 2)) reach(next);
    }
  }
  return false;
}

/// Whether two elements are on different sides: parted by cuts in the smallest box around them in
/// which tissue had joined them, or apart where none does.
bool CutBody::separates(const Vec3i& a, const Vec3i& b) const {
  if (a == b || !is_element(a) || !is_element(b)) return false;
  IndexBox box{a, a};
  for (int axis = 0; axis < 3; ++axis) {
    box.lo[axis] = std::min(a[axis], b[axis]);
    box.hi[axis] = std::max(a[axis], b[axis]);
  }
  for (int margin = 0; margin <= kDetour; ++margin) {
    if (joins(box, a, b, true)) return !joins(box, a, b, false);
    box.lo -= Vec3i(1);
    box.hi += Vec3i(1);
  }
  Vec3f of_a(0), of_b(0);
  return m_u.at(a, of_a) && m_u.at(b, of_b) && (of_a - of_b).length() > kMovedApart;
}

/// Voxels of the shell that touch elements which have moved apart.
std::vector<Vec3i> CutBody::contested_voxels() const {
  const BrickTopology& voxels = m_u.topology;
  std::vector<MoveBox> moves(voxels.brick_count());
  tbb::parallel_for(std::size_t(0), moves.size(), [&](std::size_t b) {
    const std::int32_t own = m_elements.find(voxels.origin(b));
    if (own < 0) return;
    for_each_active(m_elements.mask(std::size_t(own)), [&](int offset) {
      moves[b].add(m_u.vectors[b * kBrickVoxels + std::size_t(offset)]);
    });
  });
  std::vector<std::vector<Vec3i>> found(moves.size());
  tbb::parallel_for(std::size_t(0), moves.size(), [&](std::size_t b) {
    MoveBox around;
    for (const std::int32_t n : surroundings_of(voxels, b)) {
      if (n >= 0) around.add(moves[std::size_t(n)]);
    }
    if (!around.is_apart()) return;
    for_each_active(voxels.mask(b), [&](int offset) {
      const Vec3i voxel = voxels.origin(b) + brick_local(offset);
      if (is_element(voxel)) return;
      MoveBox touching;
      for_neighbours(voxel, [&](const Vec3i& beside) {
        Vec3f move;
        if (is_element(beside) && m_u.at(in_slice(beside), move)) touching.add(move);
      });
      if (touching.is_apart()) found[b].push_back(voxel);
    });
  });
  std::vector<Vec3i> contested;
  for (const auto& part : found) contested.insert(contested.end(), part.begin(), part.end());
  return contested;
}

void CutBody::cut_shell(const std::vector<Link>& links) {
  std::vector<Vec3i> shell;
  const auto add = [&](const Vec3i& voxel) {
    if (m_u.topology.is_active(voxel) && !m_elements.is_active(voxel)) shell.push_back(voxel);
  };
  for (const Vec3i& voxel : contested_voxels()) {
    add(voxel);
    for_neighbours(voxel, add);
  }
  for (const Link& link : links) {
    for (int n = 0; n < 343; ++n) add(link.low + Vec3i(n / 49 - 3, n / 7 % 7 - 3, n % 7 - 3));
  }
  sort_unique(shell);
  std::vector<Link> added;
  for (const Vec3i& voxel : shell) {
    const Vec3i mine = nearest_element(voxel);
    for (int face = 0; face < 6; ++face) {
      const Vec3i next = voxel + unit(face / 2) * (face % 2 ? 1 : -1);
      if (m_u.topology.is_active(next) && separates(mine, nearest_element(next))) {
        added.push_back({face % 2 ? voxel : next, face / 2});
      }
    }
  }
  for (const Link& link : added) mark(link);
}

bool CutBody::connects(const Vec3i& from, const Vec3i& to) const {
  // Depth first over the corners of the box between them.
  const Vec3i step = to - from;
  const auto at = [&](int n) {
    return from + Vec3i(n & 4 ? step.x : 0, n & 2 ? step.y : 0, n & 1 ? step.z : 0);
  };
  const int last = (step.x != 0 ? 4 : 0) | (step.y != 0 ? 2 : 0) | (step.z != 0 ? 1 : 0);
  int reached = 1, open = 1;
  bool any_cut = false;
  while (open != 0) {
    const int n = __builtin_ctz(unsigned(open));
    open &= open - 1;
    const Vec3i here = at(n);
    for (int axis = 0; axis < 3; ++axis) {
      const int bit = 4 >> axis;
      if (!(last & bit)) continue;
      const Vec3i there = at(n ^ bit);
      if (!is_voxel(there)) continue;
      if (is_cut(here[axis] < there[axis] ? here : there, axis)) {
        any_cut = true;
      } else if (!(reached >> (n ^ bit) & 1)) {
        reached |= 1 << (n ^ bit);
        open |= 1 << (n ^ bit);
      }
    }
  }
  return (reached >> last & 1) || !any_cut;
}

CellSides CutBody::sides(const Vec3i& cell) const {
  CellSides sides;
  sides.of.fill(255);
  sides.count = 0;
  for (int first = 0; first < 8; ++first) {
    if (sides.of[std::size_t(first)] != 255) continue;
    const std::uint8_t side = std::uint8_t(sides.count++);
    sides.of[std::size_t(first)] = side;
    for (int open = 1 << first; open != 0;) {
      const int n = __builtin_ctz(unsigned(open));
      open &= open - 1;
      for (int axis = 0; axis < 3; ++axis) {
        const int bit = 4 >> axis, next = n ^ bit, low = n & ~bit;
        if (sides.of[std::size_t(next)] != 255) continue;
        if (is_cut(cell + Vec3i(low >> 2, low >> 1 & 1, low & 1), axis)) continue;
        sides.of[std::size_t(next)] = side;
        open |= 1 << next;
      }
    }
  }
  return sides;
}

void CutBody::find_parted_cells() {
  std::vector<Vec3i> cells;
  for (const auto& [low, bits] : m_cut) {
    for (int axis = 0; axis < 3; ++axis) {
      if (!(bits >> axis & 1)) continue;
      const Vec3i u = unit((axis + 1) % 3), v = unit((axis + 2) % 3);
      for (const Vec3i& cell : {low, low - u, low - v, low - u - v}) cells.push_back(cell);
    }
  }
  sort_unique(cells);
  for (const Vec3i& cell : cells) {
    bool complete = true;
    for (int n = 0; n < 8 && complete; ++n) {
      complete = is_voxel(cell + Vec3i(n >> 2, n >> 1 & 1, n & 1));
    }
    if (complete && sides(cell).count > 1) m_parted.push_back(cell);
  }
}

void extend_beside_cuts(VectorBricks& u, const CutBody& body) {
  // The second ring sees four voxels far.
  std::vector<Vec3i> voxels;
  for (const Vec3i& cell : body.parted_cells()) {
    for (int n = 0; n < 512; ++n) {
      const Vec3i voxel = cell + brick_local(n) - Vec3i(3);
      const int ring = u.topology.is_active(voxel) ? body.ring(voxel) : 0;
      if (ring >= 1 && ring <= kShellRings) voxels.push_back(voxel);
    }
  }
  sort_unique(voxels);
  for (int ring = 1; ring <= kShellRings; ++ring) {
    for (const Vec3i& voxel : voxels) {
      const std::int32_t b = u.topology.find(voxel);
      const int offset = brick_offset(voxel);
      if (b < 0 || !mask_test(u.topology.mask(std::size_t(b)), offset)) continue;
      if (body.ring(voxel) != ring) continue;
      Extrapolation extrapolation;
      const auto value_at = [&](const Vec3i& from, const Vec3i& to, Vec3f& value) {
        return u.at(to, value) && body.ring(to) < ring && body.connects(from, to);
      };
      for_neighbours(voxel, [&](const Vec3i& beside) {
        Vec3f near, far;
        if (!value_at(voxel, beside, near)) return;
        if (value_at(beside, 2 * beside - voxel, far)) {
          extrapolation.add_row(near, far);
        } else {
          extrapolation.add(near);
        }
      });
      if (extrapolation.empty()) continue;
      u.vectors[std::size_t(b) * kBrickVoxels + std::size_t(offset)] = extrapolation.value();
    }
  }
}

}  // namespace supple
