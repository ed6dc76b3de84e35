// A dense volume in memory that reads like a file, for brute force to compare with.
#pragma once

#include <cstring>
#include <limits>
#include <random>
#include <vector>

#include "volumes/io/format/volume_file.h"

namespace supple::test {

inline constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// A dense volume in memory, i fastest, that reads like a file.
class DenseFile : public VolumeFile {
 public:
  DenseFile(const Vec3i& dims, std::vector<float> values) : m_values(std::move(values)) {
    m_header.path = "memory";
    m_header.format = "raw";
    m_header.type = ValueType::float32;
    m_header.geometry = Geometry().with_dims(dims);
  }
  void read_slice(void* out) override {
    const Vec3i& dims = m_header.geometry.dims();
    const std::size_t count = std::size_t(dims.x) * dims.y;
    std::memcpy(out, m_values.data() + count * m_next++, count * sizeof(float));
  }
  std::size_t index(const Vec3i& p) const {
    const Vec3i& dims = m_header.geometry.dims();
    return (std::size_t(p.z) * dims.y + p.y) * dims.x + p.x;
  }
  float value(const Vec3i& p) const { return m_values[index(p)]; }
  bool inside(const Vec3i& p) const {
    const Vec3i& dims = m_header.geometry.dims();
    return p.x >= 0 && p.y >= 0 && p.z >= 0 && p.x < dims.x && p.y < dims.y && p.z < dims.z;
  }
  template <class Visit>
  void for_each(Visit&& visit) const {
    const Vec3i& dims = m_header.geometry.dims();
    for (int k = 0; k < dims.z; ++k) {
      for (int j = 0; j < dims.y; ++j) {
        for (int i = 0; i < dims.x; ++i) visit(Vec3i(i, j, k));
      }
    }
  }
  void rewind() { m_next = 0; }

 private:
  std::vector<float> m_values;
  int m_next = 0;
};

/// Blobs of tissue in constant air, some noise, some NaN.
inline DenseFile random_file(unsigned seed, int max_dim) {
  std::mt19937 random(seed);
  const auto below = [&](int n) { return int(random() % unsigned(n)); };
  const Vec3i dims(1 + below(max_dim), 1 + below(max_dim), 1 + below(max_dim));
  const float air = float(below(3) - 5);
  std::vector<float> values(std::size_t(dims.x) * dims.y * dims.z, air);
  for (int blob = below(5); blob >= 0; --blob) {
    const Vec3d center(below(dims.x), below(dims.y), below(dims.z));
    const double radius = 1 + below(6);
    const float density = float(below(100));
    std::size_t n = 0;
    for (int k = 0; k < dims.z; ++k) {
      for (int j = 0; j < dims.y; ++j) {
        for (int i = 0; i < dims.x; ++i, ++n) {
          if ((Vec3d(i, j, k) - center).length() < radius) values[n] = density + float(below(4));
        }
      }
    }
  }
  for (int n = below(6); n > 0; --n) values[random() % values.size()] = kNaN;
  return DenseFile(dims, std::move(values));
}

}  // namespace supple::test
