// A volume filtered along its three axes one after the other, slice by slice.
#pragma once

#include <array>
#include <deque>
#include <memory>
#include <vector>

#include "volumes/io/filter/axis_weights.h"
#include "volumes/io/format/volume_file.h"

namespace supple {

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
