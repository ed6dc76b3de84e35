#include "volumes/io/filter/axis_weights.h"

#include <algorithm>
#include <cmath>
#include <numeric>

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

}  // namespace supple
