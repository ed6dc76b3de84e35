#include "volumes/field/dense/warp_vectors.h"

#include <algorithm>
#include <cstring>

namespace supple {

WarpVectors::WarpVectors(std::size_t count)
    : m_count(count), m_runs((count + kBrickVoxels - 1) / kBrickVoxels) {}

WarpVectors::WarpVectors(const std::vector<Vec3f>& all) : WarpVectors(all.size()) {
  put(0, all.data(), all.size());
}

std::vector<Vec3f> WarpVectors::all() const {
  std::vector<Vec3f> vectors(m_count);
  for (std::size_t n = 0; n < m_count; ++n) vectors[n] = m_runs.at(n);
  return vectors;
}

void WarpVectors::put(std::size_t first, const Vec3f* vectors, std::size_t count) {
  for (std::size_t done = 0; done < count;) {
    const std::size_t run = (first + done) / kBrickVoxels, at = (first + done) % kBrickVoxels;
    const std::size_t part = std::min(count - done, std::size_t(kBrickVoxels) - at);
    const Vec3f* const from = vectors + done;
    const bool is_still = std::memcmp(from, kZeroBrickOf<Vec3f>, part * sizeof(Vec3f)) == 0;
    if (!is_still || m_runs.brick(run) != nullptr) std::copy_n(from, part, m_runs.touch(run) + at);
    done += part;
  }
}

}  // namespace supple
