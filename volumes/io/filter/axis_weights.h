// A linear filter along one axis of a grid as a table: which inputs each output takes, and with
// which weights, which sum to 1.
#pragma once

#include <vector>

namespace supple {

class AxisWeights {
 public:
  /// exp(-d² / 2 sigma²) of inputs within 4 sigma (voxels) of each of `count` places.
  static AxisWeights gaussian(int count, double sigma);
  /// Linear interpolation of `from` inputs at `to` places that are `step` inputs apart, the first
  /// at (step - 1) / 2; for steps over 1 the hat is as much wider.
  static AxisWeights linear(int from, int to, double step);
  /// The same by the interpolating cubic B-spline, as far as its weights are above 1e-6; inputs are
  /// mirrored at the outer ones.
  static AxisWeights cubic(int from, int to, double step);
  /// The input nearest to each of these places.
  static AxisWeights nearest(int from, int to, double step);

  int size() const { return int(m_first.size()); }
  /// The inputs of an output: first … first + count - 1.
  int first(int output) const { return m_first[std::size_t(output)]; }
  int count(int output) const {
    return int(m_begin[std::size_t(output) + 1] - m_begin[std::size_t(output)]);
  }
  const double* weights(int output) const { return &m_weights[m_begin[std::size_t(output)]]; }

 private:
  /// The weights of the next output, to be scaled to a sum of 1.
  void add(int first, const std::vector<double>& weights);

  std::vector<int> m_first;
  std::vector<std::size_t> m_begin{0};
  std::vector<double> m_weights;
};

}  // namespace supple
