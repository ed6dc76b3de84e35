#include "volumes/field/brick_nodes.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "volumes/base/simd.h"
#include "volumes/grid/padded_rows.h"
#include "volumes/grid/voxel_sets.h"

namespace supple {

namespace {

constexpr float kMaxVectorVoxels = 1 << 20;
constexpr int kRowFloats = 3 * kBrickDim;
constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

Float4 mix(const Float4& a, const Float4& b, float t) {
  return a + t * (b - a);
}

using ViewsAround = std::array<VectorBrickView, 27>;

/// Bits of row (x, y, 0 … 8), counted from `origin`, that are occupied.
unsigned occupied_row(const BrickTopology& occupied, const Vec3i& origin, int x, int y) {
  const auto row = [&](int z) -> unsigned {
    const Vec3i voxel = origin + Vec3i(x, y, z);
    const std::int32_t b = occupied.find(voxel);
    const int offset = brick_offset(voxel);
    return b < 0 ? 0 : (occupied.mask(std::size_t(b))[offset >> 6] >> (offset & 63)) & 0xff;
  };
  return row(0) | (row(kBrickDim) & 1) << kBrickDim;
}

bool is_place(const float* v) {
  return std::abs(v[0]) + std::abs(v[1]) + std::abs(v[2]) < kMaxVectorVoxels;
}

/// Smallest and largest vectors of gathered nodes, and how many components are not numbers.
class NodeRange {
 public:
  explicit NodeRange(const float* nodes) {
    // Three registers hold eight nodes, component by component.
    constexpr int kRow = 3 * kFloats8, kRows = BrickNodes::kFloats / kRow;
    Floats8 lo[3], hi[3];
    Ints8 missing{};
    for (int k = 0; k < 3; ++k) {
      lo[k] = Floats8{} + HUGE_VALF;
      hi[k] = -lo[k];
    }
    for (int row = 0; row < kRows; ++row) {
      for (int k = 0; k < 3; ++k) {
        Floats8 v;
        std::memcpy(&v, nodes + row * kRow + k * kFloats8, sizeof v);
        // Comparisons are false for what is not a number.
        lo[k] = v < lo[k] ? v : lo[k];
        hi[k] = v > hi[k] ? v : hi[k];
        missing -= v != v;
      }
    }
    for (int n = 0; n < kRow; ++n) {
      add(n % 3, lo[n / kFloats8][n % kFloats8], hi[n / kFloats8][n % kFloats8]);
    }
    for (int n = 0; n < kFloats8; ++n) m_missing += missing[n];
    for (int n = kRows * kRow; n < BrickNodes::kFloats; ++n) {
      add(n % 3, nodes[n], nodes[n]);
      m_missing += nodes[n] != nodes[n];
    }
  }

  const Vec3f& lo() const { return m_lo; }
  const Vec3f& hi() const { return m_hi; }
  int missing() const { return m_missing; }
  /// True if all vectors are surely short enough to lead somewhere.
  bool are_places() const {
    for (int a = 0; a < 3; ++a) {
      if (m_lo[a] <= -kMaxVectorVoxels / 3 || m_hi[a] >= kMaxVectorVoxels / 3) return false;
    }
    return true;
  }

 private:
  static constexpr int kFloats8 = 8;
  using Floats8 = Pack<float, kFloats8>;
  using Ints8 = Pack<std::int32_t, kFloats8>;

  void add(int a, float lo, float hi) {
    m_lo[a] = lo < m_lo[a] ? lo : m_lo[a];
    m_hi[a] = hi > m_hi[a] ? hi : m_hi[a];
  }

  Vec3f m_lo{HUGE_VALF, HUGE_VALF, HUGE_VALF}, m_hi{-HUGE_VALF, -HUGE_VALF, -HUGE_VALF};
  int m_missing = 0;
};

bool is_upper(const Vec3i& step) {
  return std::min({step.x, step.y, step.z}) >= 0;
}

/// True if all nodes of a brick are given: its own and its upper neighbours' voxels.
bool are_all_given(const ViewsAround& around) {
  for (int n = 0; n < 27; ++n) {
    if (!is_upper(surrounding_step(n))) continue;
    if (around[n].mask == nullptr || !is_full(*around[n].mask)) return false;
  }
  return true;
}

/// True if no brick that nodes come from is stored; where all are given, only upper ones count.
bool are_at_rest(const ViewsAround& around, bool all_given) {
  for (int n = 0; n < 27; ++n) {
    if (all_given && !is_upper(surrounding_step(n))) continue;
    if (around[n].mask != nullptr && around[n].vectors != kZeroBrickOf<Vec3f>) return false;
  }
  return true;
}

/// For every row along z, bits z of the nodes that are there.
using NodeRows = std::array<std::uint16_t, BrickNodes::kDim * BrickNodes::kDim>;
constexpr unsigned kWholeRow = (1u << BrickNodes::kDim) - 1;

/// All nodes of a brick in which all are given.
void gather_inside(const ViewsAround& around, float* out) {
  for (int x = 0; x < BrickNodes::kDim; ++x) {
    for (int y = 0; y < BrickNodes::kDim; ++y, out += 3 * BrickNodes::kDim) {
      const SurroundingVoxel start = surrounding_voxel({x, y, 0});
      std::memcpy(out, &around[start.brick].vectors[start.offset].x, sizeof(float) * kRowFloats);
      std::memcpy(out + kRowFloats, &around[start.brick + 1].vectors[start.offset].x,
                  sizeof(Vec3f));
    }
  }
}

/// Nodes that are given, and those beside them.
NodeRows rows_beside_void(const PaddedRows<2>& valid) {
  NodeRows rows;
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const int x = int(row) / BrickNodes::kDim, y = int(row) % BrickNodes::kDim;
    const unsigned given = valid.row(x, y) & kWholeRow;
    rows[row] = std::uint16_t(given == kWholeRow ? given : valid.dilated_row(x, y));
  }
  return rows;
}

void gather_beside_void(const ViewsAround& around, const PaddedRows<2>& valid, const NodeRows& rows,
                        float* out) {
  constexpr unsigned kOwn = (1u << kBrickDim) - 1;
  std::fill_n(out, BrickNodes::kFloats, kNone);
  for (std::size_t row = 0; row < rows.size(); ++row, out += 3 * BrickNodes::kDim) {
    const int x = int(row) / BrickNodes::kDim, y = int(row) % BrickNodes::kDim;
    const SurroundingVoxel start = surrounding_voxel({x, y, 0});
    const unsigned given = valid.row(x, y) & kWholeRow;
    unsigned rest = rows[row];  // still to be gathered
    if ((given & kOwn) == kOwn) {
      std::memcpy(out, &around[start.brick].vectors[start.offset].x, sizeof(float) * kRowFloats);
      rest &= ~kOwn;
    }
    for (; rest != 0; rest &= rest - 1) {
      const int z = __builtin_ctz(rest);
      const Vec3f v =
          given >> z & 1
              ? around[start.brick + (z >> 3)].vectors[start.offset + (z & 7)]
              : extrapolate<false>(valid, {x, y, z}, [&](int n) { return around[n].vectors; });
      std::memcpy(out + 3 * z, &v.x, sizeof v);
    }
  }
}

/// Takes out the nodes that are no place on the lattice.
void drop_far_nodes(float* out, NodeRows& rows) {
  for (std::uint16_t& row : rows) {
    for (int z = 0; z < BrickNodes::kDim; ++z, out += 3) {
      if (is_place(out)) continue;
      std::fill_n(out, 3, kNone);
      row &= std::uint16_t(~(1u << z));
    }
  }
}

int count_nodes(const NodeRows& rows) {
  int count = 0;
  for (const std::uint16_t row : rows) count += __builtin_popcount(row);
  return count;
}

/// True if all nodes that are missing lie at voxels that are not occupied.
bool lie_in_void(const NodeRows& rows, const BrickTopology& occupied, const Vec3i& origin) {
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const unsigned missing = ~unsigned(rows[row]) & kWholeRow;
    const int x = int(row) / BrickNodes::kDim, y = int(row) % BrickNodes::kDim;
    if (missing != 0 && (occupied_row(occupied, origin, x, y) & missing) != 0) return false;
  }
  return true;
}

}  // namespace

void gather_nodes(const VectorBrickFinder& field, const BrickTopology& occupied,
                  const Vec3i& origin, float* out, BrickNodes& nodes) {
  ViewsAround around;
  for (int n = 0; n < 27; ++n) around[n] = field(origin + surrounding_step(n) * kBrickDim);
  const bool all_given = are_all_given(around), at_rest = are_at_rest(around, all_given);
  nodes = {};
  NodeRows rows;
  if (all_given) {
    if (at_rest) return;
    rows.fill(kWholeRow);
    gather_inside(around, out);
  } else {
    const PaddedRows<2> valid([&](int n) { return around[n].mask; });
    rows = rows_beside_void(valid);
    nodes.is_void = lie_in_void(rows, occupied, origin);
    if (at_rest && nodes.is_void) return;
    gather_beside_void(around, valid, rows, out);
  }
  NodeRange range(out);
  if (!range.are_places() || range.missing() != BrickNodes::kFloats - 3 * count_nodes(rows)) {
    drop_far_nodes(out, rows);
    nodes.is_void = lie_in_void(rows, occupied, origin);
    range = NodeRange(out);
  }
  nodes.lo = range.lo();
  nodes.hi = range.hi();
  const Vec3f zero(0, 0, 0);
  nodes.is_zero = nodes.empty() || (nodes.lo == zero && nodes.hi == zero);
}

std::int32_t NodeSlots::take() {
  if (m_free.empty()) return m_count++;
  const std::int32_t slot = m_free.back();
  m_free.pop_back();
  return slot;
}

void NodeSlots::reserve(std::size_t more) {
  const std::size_t fresh = more > m_free.size() ? more - m_free.size() : 0;
  const std::size_t count = (std::size_t(m_count) + fresh) * m_slot_floats + 1;
  if (count <= m_floats.capacity()) return;
  m_floats.reserve(count);
}

NodeDerivatives derivatives_of(const Float4 (&c)[8], float x, float y, float z) {
  const Float4 y0 = mix(c[0], c[1], z), y1 = mix(c[2], c[3], z);
  const Float4 y2 = mix(c[4], c[5], z), y3 = mix(c[6], c[7], z);
  const Float4 x0 = mix(y0, y1, y), x1 = mix(y2, y3, y);
  return {mix(x0, x1, x), x1 - x0, mix(y1 - y0, y3 - y2, x),
          mix(mix(c[1] - c[0], c[3] - c[2], y), mix(c[5] - c[4], c[7] - c[6], y), x)};
}

}  // namespace supple
