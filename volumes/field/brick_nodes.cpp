#include "volumes/field/brick_nodes.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "volumes/base/huge_pages.h"
#include "volumes/grid/padded_rows.h"
#include "volumes/grid/voxel_sets.h"

namespace supple {

namespace {

constexpr float kMaxVectorVoxels = 1 << 20;
constexpr int kRowFloats = 3 * kBrickDim;

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

/// Smallest and largest values of rows of eight vectors, component by component.
class RowRange {
 public:
  RowRange() {
    m_lo.fill(HUGE_VALF);
    m_hi.fill(-HUGE_VALF);
  }
  /// False, and nothing has happened, when a value is not a place on the lattice.
  bool add(const float* row) {
    bool is_good = true;
    for (int n = 0; n < kRowFloats; ++n) is_good &= std::abs(row[n]) < kMaxVectorVoxels / 3;
    if (!is_good) return false;
    for (int n = 0; n < kRowFloats; ++n) {
      m_lo[n] = row[n] < m_lo[n] ? row[n] : m_lo[n];
      m_hi[n] = row[n] > m_hi[n] ? row[n] : m_hi[n];
    }
    return true;
  }
  void add(const Vec3f& v) {
    for (int a = 0; a < 3; ++a) {
      m_lo[a] = std::min(m_lo[a], v[a]);
      m_hi[a] = std::max(m_hi[a], v[a]);
    }
  }
  Vec3f lo() const {
    return fold(m_lo, [](float a, float b) { return std::min(a, b); });
  }
  Vec3f hi() const {
    return fold(m_hi, [](float a, float b) { return std::max(a, b); });
  }

 private:
  using Row = std::array<float, kRowFloats>;
  template <class Choose>
  static Vec3f fold(const Row& row, Choose choose) {
    Vec3f result(row[0], row[1], row[2]);
    for (int n = 3; n < kRowFloats; ++n) result[n % 3] = choose(result[n % 3], row[n]);
    return result;
  }

  Row m_lo, m_hi;
};

/// Whether none of the brick's own vectors and its upper neighbours' is stored.
bool are_at_rest(const ViewsAround& around) {
  for (int n = 0; n < 27; ++n) {
    const Vec3i step = surrounding_step(n);
    if (std::min({step.x, step.y, step.z}) < 0) continue;
    if (around[n].vectors != kZeroBrickOf<Vec3f>) return false;
  }
  return true;
}

bool is_place(const Vec3f& v) {
  return std::abs(v.x) + std::abs(v.y) + std::abs(v.z) < kMaxVectorVoxels;
}

/// All nodes of a brick whose own and whose neighbours' voxels are given; false when one of them is
/// not a place on the lattice.
bool gather_inside(const ViewsAround& around, float* out, RowRange& range) {
  for (int x = 0; x < BrickNodes::kDim; ++x) {
    for (int y = 0; y < BrickNodes::kDim; ++y, out += 3 * BrickNodes::kDim) {
      const SurroundingVoxel start = surrounding_voxel({x, y, 0});
      const Vec3f* row = &around[start.brick].vectors[start.offset];
      const Vec3f& last = around[start.brick + 1].vectors[start.offset];
      if (!range.add(&row->x) || !is_place(last)) return false;
      range.add(last);
      std::memcpy(out, &row->x, sizeof(float) * kRowFloats);
      std::memcpy(out + kRowFloats, &last.x, sizeof last);
    }
  }
  return true;
}

void gather_beside_void(const ViewsAround& around, const BrickTopology& occupied, bool extrapolated,
                        const Vec3i& origin, float* out, RowRange& range, bool& is_void) {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  constexpr unsigned kAll = (1u << BrickNodes::kDim) - 1, kOwn = (1u << kBrickDim) - 1;
  const PaddedRows<2> valid([&](int n) { return around[n].mask; });
  for (int x = 0; x < BrickNodes::kDim; ++x) {
    for (int y = 0; y < BrickNodes::kDim; ++y, out += 3 * BrickNodes::kDim) {
      const SurroundingVoxel start = surrounding_voxel({x, y, 0});
      const unsigned given = valid.row(x, y) & kAll;
      unsigned known = extrapolated && given != kAll ? valid.dilated_row(x, y) : given;
      std::fill(out, out + 3 * BrickNodes::kDim, kNone);
      unsigned rest = known;  // still to be gathered
      if ((given & kOwn) == kOwn && range.add(&around[start.brick].vectors[start.offset].x)) {
        std::memcpy(out, &around[start.brick].vectors[start.offset].x, sizeof(float) * kRowFloats);
        rest &= ~kOwn;
      }
      for (; rest != 0; rest &= rest - 1) {
        const int z = __builtin_ctz(rest);
        const Vec3f v =
            given >> z & 1
                ? around[start.brick + (z >> 3)].vectors[start.offset + (z & 7)]
                : extrapolate<false>(valid, {x, y, z}, [&](int n) { return around[n].vectors; });
        if (is_place(v)) {
          range.add(v);
          std::memcpy(out + 3 * z, &v.x, sizeof v);
        } else {
          known &= ~(1u << z);
        }
      }
      if (known != kAll && is_void) {
        is_void = (occupied_row(occupied, origin, x, y) & ~known) == 0;
      }
    }
  }
}

}  // namespace

void gather_nodes(const VectorBrickFinder& field, const BrickTopology& occupied, bool extrapolated,
                  const Vec3i& origin, float* out, BrickNodes& nodes) {
  ViewsAround around;
  bool is_inside = true;  // all nodes are given
  for (int n = 0; n < 27; ++n) {
    const Vec3i step = surrounding_step(n);
    const bool is_upper = std::min({step.x, step.y, step.z}) >= 0;
    if (!is_upper && !extrapolated) continue;
    around[n] = field(origin + step * kBrickDim);
    if (is_upper) is_inside = is_inside && around[n].mask != nullptr && is_full(*around[n].mask);
  }
  nodes.is_void = true;
  if (is_inside && are_at_rest(around)) {
    nodes.lo = nodes.hi = Vec3f(0);
    nodes.is_zero = true;
    return;
  }
  RowRange range;
  if (!is_inside || !gather_inside(around, out, range)) {
    range = RowRange();
    gather_beside_void(around, occupied, extrapolated, origin, out, range, nodes.is_void);
  }
  nodes.lo = range.lo();
  nodes.hi = range.hi();
  const Vec3f none(0, 0, 0);
  nodes.is_zero = nodes.empty() || (nodes.lo == none && nodes.hi == none);
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
  std::vector<float> larger = reserve_in_huge_pages<float>(count);
  larger.insert(larger.end(), m_floats.begin(), m_floats.end());
  m_floats.swap(larger);
}

NodeDerivatives derivatives_of(const Float4 (&c)[8], float x, float y, float z) {
  const Float4 y0 = mix(c[0], c[1], z), y1 = mix(c[2], c[3], z);
  const Float4 y2 = mix(c[4], c[5], z), y3 = mix(c[6], c[7], z);
  const Float4 x0 = mix(y0, y1, y), x1 = mix(y2, y3, y);
  return {mix(x0, x1, x), x1 - x0, mix(y1 - y0, y3 - y2, x),
          mix(mix(c[1] - c[0], c[3] - c[2], y), mix(c[5] - c[4], c[7] - c[6], y), x)};
}

}  // namespace supple
