// The head phantom at every second voxel of a grid, trilinear between: large volumes in an eighth
// of the time.
#pragma once

#include <vector>

#include "volumes/base/parallel.h"
#include "volumes/phantom/phantom.h"

namespace supple::tools {

class HalfSampledHead {
 public:
  explicit HalfSampledHead(const Vec3i& size) : m_dims(size / 2 + Vec3i(1)) {
    const Phantom phantom = head_phantom(size);
    m_values.resize(std::size_t(m_dims.x) * m_dims.y * m_dims.z);
    parallel_for(m_dims.z, [&](int k) {
      for (int j = 0; j < m_dims.y; ++j) {
        for (int i = 0; i < m_dims.x; ++i) {
          m_values[index(i, j, k)] = phantom.density(2 * i, 2 * j, 2 * k);
        }
      }
    });
  }

  float operator()(const Vec3i& voxel) const {
    const Vec3i lo = voxel / 2;
    const Vec3i hi = (voxel + Vec3i(1)) / 2;
    float sum = 0;
    for (const int k : {lo.z, hi.z}) {
      for (const int j : {lo.y, hi.y}) {
        for (const int i : {lo.x, hi.x}) sum += m_values[index(i, j, k)];
      }
    }
    return sum / 8;
  }

  bool is_tissue(const Vec3i& voxel) const { return (*this)(voxel) > kLeastTissue; }

 private:
  static constexpr float kLeastTissue = -300;  // HU

  std::size_t index(int i, int j, int k) const {
    return (std::size_t(k) * m_dims.y + j) * m_dims.x + i;
  }
  Vec3i m_dims;
  std::vector<float> m_values;
};

}  // namespace supple::tools
