// Results of a solution by finite elements at the elements of a body: values of each, and means
// over labels.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lib/body/body.h"
#include "lib/fem/fem_report.h"
#include "lib/fem/voxel/fem.h"
#include "lib/fem/voxel/fem_results.h"

namespace supple {

/// The elements of the solid that each element of the body consists of.
using ElementParts = std::vector<std::vector<std::int32_t>>;

/// A solution and the elements of the body, each of which may have parts.
struct SolvedElements {
  const FemModel& solid;
  const std::vector<double>& u_mm;
  StrainTheory theory;
  const std::vector<double>& swelling_kpa;
  ElementParts parts;  // per element of the body; empty: each is its own

  void add_to(StrainGauge& gauge, std::size_t element) const;
  /// Mean of a quantity over each element.
  std::vector<float> values_of(FemQuantity quantity) const;
};

/// Returns the gauges of the labels of these elements, ascending.
std::vector<StrainGauge> gauges_of(const SolvedElements& solved, const BrickTopology& elements,
                                   const BrickValues& labels);
std::vector<ElementValues> values_of(const SolvedElements& solved, const BrickTopology& elements,
                                     const std::vector<FemQuantity>& wanted);

}  // namespace supple
