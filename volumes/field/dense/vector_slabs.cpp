#include "volumes/field/dense/vector_slabs.h"

#include <algorithm>
#include <limits>

#include "volumes/base/parallel.h"

namespace supple {

VectorSlabs::VectorSlabs(const VectorBricks& field, const Vec3i& first, const Vec3i& dims,
                         std::function<bool(const Vec3i& origin)> leaves_out)
    : m_field(field),
      m_first(first),
      m_dims(dims),
      m_leaves_out(std::move(leaves_out)),
      m_slab((first.z >> 3) - 1) {}

const Vec3f* VectorSlabs::slice(int k) {
  const int z = m_first.z + k;
  if ((z >> 3) != m_slab) turn(z >> 3);
  return m_slices.data() + std::size_t(z & 7) * m_dims.x * m_dims.y;
}

void VectorSlabs::turn(int slab) {
  m_slab = slab;
  m_slices.resize(std::size_t(kBrickDim) * m_dims.x * m_dims.y);
  const Vec3i last = m_first + m_dims - Vec3i(1);
  parallel_for(m_first.y >> 3, (last.y >> 3) + 1, [&](int by) {
    for (int bx = m_first.x >> 3; bx <= last.x >> 3; ++bx) {
      turn_brick(Vec3i(bx, by, slab) * kBrickDim);
    }
  });
}

void VectorSlabs::turn_brick(const Vec3i& origin) {
  const Vec3f invalid(std::numeric_limits<float>::quiet_NaN());
  const std::int32_t b = m_leaves_out(origin) ? -1 : m_field.topology.find(origin);
  const Vec3f* const vectors = m_field.vectors.brick_or_zero(std::size_t(b));
  const BrickMask mask = b < 0 ? BrickMask{} : m_field.topology.mask(std::size_t(b));
  Vec3i lo, hi;  // of the brick's voxels inside the box
  for (int a = 0; a < 2; ++a) {
    lo[a] = std::max(0, m_first[a] - origin[a]);
    hi[a] = std::min(kBrickDim, m_first[a] + m_dims[a] - origin[a]);
  }
  const Vec3i in_box = origin - m_first;
  for (int k = 0; k < kBrickDim; ++k) {
    for (int j = lo.y; j < hi.y; ++j) {
      Vec3f* const row =
          m_slices.data() + (std::size_t(k) * m_dims.y + in_box.y + j) * m_dims.x + in_box.x;
      for (int i = lo.x; i < hi.x; ++i) {
        const int offset = (i << 6) | (j << 3) | k;
        row[i] = mask_test(mask, offset) ? vectors[offset] : invalid;
      }
    }
  }
}

}  // namespace supple
