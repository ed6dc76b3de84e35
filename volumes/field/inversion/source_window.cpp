#include "volumes/field/inversion/source_window.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "volumes/base/simd.h"
#include "volumes/field/brick_nodes.h"

namespace supple {

namespace {

constexpr double kMaxVoxels = 32768;
constexpr float kInvalid = std::numeric_limits<float>::quiet_NaN();

using Int4 = Pack<std::int32_t, 4>;

inline Float4 to_four(const Vec3f& v) {
  const Float4 four = {v.x, v.y, v.z, 0};
  return four;
}
inline Float4 mix(const Float4& a, const Float4& b, float t) {
  return a + (b - a) * t;
}

}  // namespace

/// Places the window around the voxels that trilinear samples at the sources read. The shift is the
/// whole voxel nearest to the first node's displacement.
bool SourceWindow::place(const BrickMask& nodes, const Vec3f* offsets) {
  bool is_first = true;
  Float4 lo = Float4{} + 3e38f, hi = Float4{} - 3e38f;
  for_each_active(nodes, [&](int n) {
    const Vec3f& o = offsets[n];
    if (is_first) m_shift = {std::round(o.x), std::round(o.y), std::round(o.z)};
    is_first = false;
    const Float4 pos = to_four(o - m_shift) + to_four(Vec3f(brick_local(n)));
    lo = pos < lo ? pos : lo;
    hi = pos > hi ? pos : hi;
  });
  double count = 1;
  for (int a = 0; a < 3; ++a) count *= std::floor(hi[a]) + 2 - std::floor(lo[a]);
  if (!(count <= kMaxVoxels)) return false;
  for (int a = 0; a < 3; ++a) {
    m_lo[a] = int(std::floor(lo[a]));
    m_dims[a] = int(std::floor(hi[a])) + 2 - m_lo[a];
  }
  m_entries.resize(std::size_t(m_dims.x) * m_dims.y * m_dims.z);
  return true;
}

bool SourceWindow::measure(const VectorBricks& u, const FoldedCells& folded, const Vec3i& origin,
                           const BrickMask& nodes, const Vec3f* offsets,
                           std::array<float, kBrickVoxels>& residuals) {
  if (!place(nodes, offsets)) return false;
  const Vec3i first = origin + Vec3i(m_shift) + m_lo, last = first + m_dims - Vec3i(1);
  for (int x = first.x & ~7; x <= last.x; x += kBrickDim) {
    for (int y = first.y & ~7; y <= last.y; y += kBrickDim) {
      for (int z = first.z & ~7; z <= last.z; z += kBrickDim) {
        copy_brick(u, folded, {x, y, z}, first);
      }
    }
  }
  for_each_active(nodes, [&](int n) { residuals[n] = residual(n, offsets[n]); });
  return true;
}

/// The part of one brick that lies in the window.
void SourceWindow::copy_brick(const VectorBricks& u, const FoldedCells& folded, const Vec3i& origin,
                              const Vec3i& window) {
  const std::int32_t b = u.topology.find(origin);
  const Vec3f* const vectors = u.vectors.brick_or_zero(std::size_t(b));
  const BrickMask* const folds_of_brick = folded.of(b);
  const Float4 shift = to_four(m_shift);
  Vec3i first, end;
  for (int a = 0; a < 3; ++a) {
    first[a] = std::max(0, window[a] - origin[a]);
    end[a] = std::min(kBrickDim, window[a] + m_dims[a] - origin[a]);
  }
  for (int x = first.x; x < end.x; ++x) {
    for (int y = first.y; y < end.y; ++y) {
      const Vec3i at = origin + Vec3i(x, y, first.z) - window;
      Entry* out = &m_entries[(std::size_t(at.x) * m_dims.y + at.y) * m_dims.z + at.z];
      const unsigned valid = b < 0 ? 0 : unsigned(u.topology.mask(b)[x] >> (8 * y)) & 0xff;
      const unsigned folds =
          folds_of_brick == nullptr ? 0 : unsigned((*folds_of_brick)[x] >> (8 * y)) & 0xff;
      const Vec3f* row = vectors + 64 * x + 8 * y;
      const bool is_last = x + y == 2 * (kBrickDim - 1);
      if (valid == 0xff && folds == 0 && !is_last) {
        // Four floats are read, the last of which belongs to the next voxel and is dropped.
        for (int z = first.z; z < end.z; ++z, ++out) {
          Float4 v;
          std::memcpy(&v, &row[z].x, sizeof v);
          v = __builtin_shufflevector(v + shift, Float4{}, 0, 1, 2, 4);
          std::memcpy(&out->u.x, &v, sizeof v);
        }
        continue;
      }
      for (int z = first.z; z < end.z; ++z, ++out) {
        if ((valid >> z) & 1) {
          *out = {row[z] + m_shift, float((folds >> z) & 1)};
        } else {
          *out = {Vec3f(kInvalid), 0};
        }
      }
    }
  }
}

inline float SourceWindow::residual(int node, const Vec3f& offset) const {
  // Relative to the window, of which no coordinate is negative.
  const Float4 o = to_four(offset - m_shift);
  const Float4 pos = o + to_four(Vec3f(brick_local(node) - m_lo));
  const Int4 cell = __builtin_convertvector(pos, Int4);
  const Float4 t = pos - __builtin_convertvector(cell, Float4);
  const std::size_t stride_y = m_dims.z, stride_x = stride_y * m_dims.y;
  const Entry* entry = &m_entries[cell[0] * stride_x + cell[1] * stride_y + cell[2]];
  if (entry->is_folded > 0) return kFolded;
  const auto corner = [&](std::size_t step) {
    Float4 v;
    std::memcpy(&v, &entry[step].u.x, sizeof v);
    return v;
  };
  const auto column = [&](std::size_t step) { return mix(corner(step), corner(step + 1), t[2]); };
  const Float4 low = mix(column(0), column(stride_y), t[1]);
  const Float4 high = mix(column(stride_x), column(stride_x + stride_y), t[1]);
  const Float4 rest = mix(low, high, t[0]) + o;
  const float squared = rest[0] * rest[0] + rest[1] * rest[1] + rest[2] * rest[2];
  return std::isnan(squared) ? kUnknown : std::sqrt(squared);
}

}  // namespace supple
