// A volume filtered along its three axes one after the other, slice by slice.
#pragma once

#include <array>
#include <deque>
#include <memory>
#include <vector>

#include "volumes/io/format/volume_file.h"

namespace supple {

// A linear filter along one axis of a grid as a table: which inputs each output takes, and with
// which weights, which sum to 1.

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

/// Reads scalars of `file` once, front to back. Values that are not finite have no weight; where
/// they had more than half of it the result is NaN. Sums are in doubles and in a fixed order.
/// Memory: the slices that one output slice takes, filtered along i and j.
class SeparableVolume final : public VolumeFile {
 public:
  /// `weights` of i, j, k; `geometry` is that of their outputs.
  SeparableVolume(std::unique_ptr<VolumeFile> file, std::array<AxisWeights, 3> weights,
                  const Geometry& geometry);

  void read_slice(void* out) override;

 private:
  using Plane = std::vector<double>;
  struct Slice {
    Plane values, known;  // share of the weight that finite values have; empty: all of it
  };

  Slice next_input();
  Plane filtered(const Plane& plane) const;

  std::unique_ptr<VolumeFile> m_file;
  std::array<AxisWeights, 3> m_weights;
  std::deque<Slice> m_slices;  // filtered along i and j
  int m_first = 0;             // number of the first of them
  int m_next = 0;              // output slice
};

}  // namespace supple
