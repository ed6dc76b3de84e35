#include "volumes/io/filter/separable_volume.h"

#include <cmath>
#include <limits>
#include <utility>

#include "volumes/base/parallel.h"

namespace supple {

SeparableVolume::SeparableVolume(std::unique_ptr<VolumeFile> file,
                                 std::array<AxisWeights, 3> weights, const Geometry& geometry)
    : m_file(std::move(file)), m_weights(std::move(weights)) {
  m_header = m_file->header();
  m_header.geometry = geometry;
}

SeparableVolume::Plane SeparableVolume::filtered(const Plane& plane) const {
  const AxisWeights &along_i = m_weights[0], &along_j = m_weights[1];
  const int rows = m_file->header().geometry.dims().y;
  const std::size_t wide = std::size_t(m_file->header().geometry.dims().x);
  const std::size_t narrow = std::size_t(along_i.size());
  Plane half(narrow * std::size_t(rows)), whole(narrow * std::size_t(along_j.size()));
  parallel_for(rows, [&](int j) {
    const double* from = &plane[std::size_t(j) * wide];
    double* to = &half[std::size_t(j) * narrow];
    for (int i = 0; i < along_i.size(); ++i) {
      const double* weights = along_i.weights(i);
      const double* values = from + along_i.first(i);
      double sum = 0;
      for (int n = 0; n < along_i.count(i); ++n) sum += weights[n] * values[n];
      to[i] = sum;
    }
  });
  parallel_for(along_j.size(), [&](int j) {
    double* to = &whole[std::size_t(j) * narrow];
    for (int n = 0; n < along_j.count(j); ++n) {
      const double weight = along_j.weights(j)[n];
      const double* from = &half[std::size_t(along_j.first(j) + n) * narrow];
      for (std::size_t i = 0; i < narrow; ++i) to[i] += weight * from[i];
    }
  });
  return whole;
}

SeparableVolume::Slice SeparableVolume::next_input() {
  const VolumeHeader& input = m_file->header();
  const std::size_t count =
      std::size_t(input.geometry.dims().x) * std::size_t(input.geometry.dims().y);
  std::vector<char> stored(count * std::size_t(bytes_of(input.type)));
  m_file->read_slice(stored.data());
  Plane values(count), known;
  scale_values_of(input.type)(stored.data(), count, 1, 0, values.data());
  for (std::size_t n = 0; n < count; ++n) {
    if (std::isfinite(values[n])) continue;
    if (known.empty()) known.assign(count, 1);
    known[n] = values[n] = 0;
  }
  return {filtered(values), known.empty() ? Plane() : filtered(known)};
}

void SeparableVolume::read_slice(void* out) {
  const AxisWeights& along_k = m_weights[2];
  const int first = along_k.first(m_next), inputs = along_k.count(m_next);
  for (; m_first < first; ++m_first) {
    if (m_slices.empty()) next_input();  // nothing takes it
    if (!m_slices.empty()) m_slices.pop_front();
  }
  while (int(m_slices.size()) < inputs) m_slices.push_back(next_input());

  const std::size_t count = std::size_t(m_weights[0].size()) * std::size_t(m_weights[1].size());
  Plane sum(count), known(count);
  for (int n = 0; n < inputs; ++n) {
    const double weight = along_k.weights(m_next)[n];
    const Slice& slice = m_slices[std::size_t(n)];
    for (std::size_t v = 0; v < count; ++v) sum[v] += weight * slice.values[v];
    for (std::size_t v = 0; v < count; ++v) {
      known[v] += slice.known.empty() ? weight : weight * slice.known[v];
    }
  }
  for (std::size_t v = 0; v < count; ++v) {
    if (known[v] < 0.5) {
      sum[v] = std::numeric_limits<double>::quiet_NaN();
    } else if (known[v] < 1 - 1e-9) {
      sum[v] /= known[v];
    }
  }
  store_values(m_header.type, sum.data(), count, static_cast<char*>(out));
  ++m_next;
}

}  // namespace supple
