#include "volumes/io/filter/separable_volume.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "volumes/base/parallel.h"
#include "volumes/grid/b_spline.h"

namespace supple {

namespace {

constexpr double kCutOff = 4;  // standard deviations
constexpr double kSplineReach = 12;

/// Place of output n along the inputs.
double place_of(int n, double step) {
  return (n + 0.5) * step - 0.5;
}

}  // namespace

void AxisWeights::add(int first, const std::vector<double>& weights) {
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  m_first.push_back(first);
  for (const double weight : weights) m_weights.push_back(weight / sum);
  m_begin.push_back(m_weights.size());
}

AxisWeights AxisWeights::gaussian(int count, double sigma) {
  const int reach = int(std::floor(kCutOff * sigma));
  AxisWeights table;
  std::vector<double> weights;
  for (int n = 0; n < count; ++n) {
    const int first = std::max(0, n - reach), last = std::min(count - 1, n + reach);
    weights.clear();
    for (int m = first; m <= last; ++m) {
      weights.push_back(std::exp(-0.5 * double(m - n) * (m - n) / (sigma * sigma)));
    }
    table.add(first, weights);
  }
  return table;
}

AxisWeights AxisWeights::linear(int from, int to, double step) {
  const double width = std::max(1.0, step);
  AxisWeights table;
  std::vector<double> weights;
  for (int n = 0; n < to; ++n) {
    const double place = std::clamp(place_of(n, step), 0.0, double(from - 1));
    const int first = std::max(0, int(std::floor(place - width)) + 1);
    const int last = std::min(from - 1, int(std::ceil(place + width)) - 1);
    weights.clear();
    for (int m = first; m <= last; ++m) weights.push_back(1 - std::abs(m - place) / width);
    table.add(first, weights);
  }
  return table;
}

AxisWeights AxisWeights::cubic(int from, int to, double step) {
  const double width = std::max(1.0, step);
  const int period = std::max(1, 2 * from - 2);
  AxisWeights table;
  std::vector<double> weights;
  for (int n = 0; n < to; ++n) {
    const double place = std::clamp(place_of(n, step), 0.0, double(from - 1));
    const int begin = int(std::ceil(place - kSplineReach * width));
    const int end = int(std::floor(place + kSplineReach * width));
    // Inputs and those that are mirrored onto them; a small volume is mirrored more than once.
    const bool is_wide = end - begin >= from - 1;
    const int low = is_wide ? 0 : std::max(0, std::min(begin, 2 * (from - 1) - end));
    const int high = is_wide ? from - 1 : std::min(from - 1, std::max(end, -begin));
    weights.assign(std::size_t(high - low + 1), 0.0);
    for (int m = begin; m <= end; ++m) {
      const int folded = ((m % period) + period) % period;
      const int input = folded < from ? folded : period - folded;
      weights[std::size_t(input - low)] += cardinal_spline((m - place) / width);
    }
    table.add(low, weights);
  }
  return table;
}

AxisWeights AxisWeights::nearest(int from, int to, double step) {
  AxisWeights table;
  for (int n = 0; n < to; ++n) {
    table.add(std::clamp(int(std::lround(place_of(n, step))), 0, from - 1), {1.0});
  }
  return table;
}

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
