#include "volumes/field/brick_nodes.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace supple {

namespace {

constexpr float kMaxVectorVoxels = 1 << 20;
constexpr int kRowFloats = 3 * kBrickDim;

Float4 load(const float* p) {
  Float4 v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
Float4 mix(const Float4& a, const Float4& b, float t) {
  return a + t * (b - a);
}

/// The 27 bricks around a brick, itself in the middle.
class Surroundings {
 public:
  Surroundings(const VectorBrickFinder& find, const Vec3i& origin) {
    for (int n = 0; n < 27; ++n) {
      const Vec3i step(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1);
      m_bricks[n] = find(origin + step * kBrickDim);
    }
  }

  /// Of the row (x, y, 0 … 7) in the brick, or above it where x or y is 8.
  const VectorBrickView& row(int x, int y) const { return brick({x, y, 0}); }
  /// The node at -1 … 9; null where there is none.
  const Vec3f* node(const Vec3i& local) const {
    const VectorBrickView& view = brick(local);
    const int offset = brick_offset(local);
    return view.mask != nullptr && mask_test(*view.mask, offset) ? &view.vectors[offset] : nullptr;
  }

 private:
  const VectorBrickView& brick(const Vec3i& local) const {
    return m_bricks[9 * ((local.x + 8) >> 3) + 3 * ((local.y + 8) >> 3) + ((local.z + 8) >> 3)];
  }

  std::array<VectorBrickView, 27> m_bricks;
};

/// The mean that ring_fill.cpp gives, bit for bit; false without a neighbour.
bool extrapolate(const Surroundings& around, const Vec3i& local, Vec3f& mean) {
  Vec3d sum(0);
  int count = 0;
  for (int n = 0; n < 27; ++n) {
    const Vec3f* v = around.node(local + Vec3i(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1));
    if (v == nullptr) continue;
    sum += Vec3d(v->x, v->y, v->z);
    ++count;
  }
  if (count == 0) return false;
  mean = Vec3f(sum / double(count));
  return true;
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

}  // namespace

void gather_nodes(const VectorBrickFinder& field, const BrickTopology& occupied, bool extrapolated,
                  const Vec3i& origin, BrickNodes& nodes) {
  const Surroundings around(field, origin);
  nodes.is_void = true;
  RowRange range;
  const auto gather_node = [&](const Vec3i& local, float* out) {
    Vec3f mean;
    const Vec3f* found = around.node(local);
    if (found == nullptr && extrapolated && extrapolate(around, local, mean)) found = &mean;
    if (found != nullptr &&
        std::abs(found->x) + std::abs(found->y) + std::abs(found->z) < kMaxVectorVoxels) {
      range.add(*found);
      for (int a = 0; a < 3; ++a) out[a] = (*found)[a];
    } else {
      std::fill(out, out + 3, std::numeric_limits<float>::quiet_NaN());
      nodes.is_void = nodes.is_void && !occupied.is_active(origin + local);
    }
  };
  float* out = nodes.vectors.data();
  for (int x = 0; x < BrickNodes::kDim; ++x) {
    for (int y = 0; y < BrickNodes::kDim; ++y, out += 3 * BrickNodes::kDim) {
      const VectorBrickView& view = around.row(x, y);
      const int offset = brick_offset({x, y, 0});
      int first = 0;  // node that is still to be gathered
      if (view.mask != nullptr && ((*view.mask)[offset >> 6] >> (offset & 63) & 0xff) == 0xff) {
        const float* row = &view.vectors[offset].x;
        if (range.add(row)) {
          std::memcpy(out, row, sizeof(float) * kRowFloats);
          first = kBrickDim;
        }
      }
      for (int z = first; z < BrickNodes::kDim; ++z) gather_node({x, y, z}, out + 3 * z);
    }
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

void NodeSlots::write(std::int32_t slot, const BrickNodes& nodes) {
  std::copy(nodes.vectors.begin(), nodes.vectors.end(),
            m_floats.begin() + std::ptrdiff_t(slot) * BrickNodes::kFloats);
}

NodeDerivatives derivatives_in(const NodeCell& cell) {
  constexpr int sx = BrickNodes::kStepX, sy = BrickNodes::kStepY, sz = BrickNodes::kStepZ;
  const float* n = cell.node;
  const Float4 c000 = load(n), c001 = load(n + sz);
  const Float4 c010 = load(n + sy), c011 = load(n + sy + sz);
  const Float4 c100 = load(n + sx), c101 = load(n + sx + sz);
  const Float4 c110 = load(n + sx + sy), c111 = load(n + sx + sy + sz);
  const Float4 y0 = mix(c000, c001, cell.z), y1 = mix(c010, c011, cell.z);
  const Float4 y2 = mix(c100, c101, cell.z), y3 = mix(c110, c111, cell.z);
  const Float4 x0 = mix(y0, y1, cell.y), x1 = mix(y2, y3, cell.y);
  return {
      mix(x0, x1, cell.x), x1 - x0, mix(y1 - y0, y3 - y2, cell.x),
      mix(mix(c001 - c000, c011 - c010, cell.y), mix(c101 - c100, c111 - c110, cell.y), cell.x)};
}

}  // namespace supple
