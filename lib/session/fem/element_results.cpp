#include "lib/session/fem/element_results.h"

#include <map>

namespace supple {

void SolvedElements::add_to(StrainGauge& gauge, std::size_t element) const {
  const std::vector<std::int32_t> itself{std::int32_t(element)};
  const std::vector<std::int32_t>& of = parts.empty() ? itself : parts[element];
  for (const std::int32_t part : of) {
    const ElementState state =
        element_state(solid.mesh(), solid.material(), u_mm, part, theory, swelling_kpa);
    for (std::size_t n = 0; n < kFemQuantities.size(); ++n) {
      gauge.mean[n] += value_of(state, kFemQuantities[n].first) / double(of.size());
    }
  }
}

std::vector<float> SolvedElements::values_of(FemQuantity quantity) const {
  std::vector<float> values =
      element_values(solid.mesh(), solid.material(), u_mm, quantity, theory, swelling_kpa);
  if (parts.empty()) return values;
  std::vector<float> means;
  for (const std::vector<std::int32_t>& of : parts) {
    double sum = 0;
    for (const std::int32_t part : of) sum += values[std::size_t(part)];
    means.push_back(float(sum / double(of.size())));
  }
  return means;
}

std::vector<StrainGauge> gauges_of(const SolvedElements& solved, const BrickTopology& elements,
                                   const BrickValues& labels) {
  std::map<std::int32_t, StrainGauge> gauges;
  if (labels.empty()) return {};
  std::size_t element = 0;
  for_each_element(elements, [&](Slot slot) {
    const std::int32_t label = labels.at(slot);
    if (label > 0) {
      StrainGauge& gauge = gauges[label];
      gauge.label = label;
      ++gauge.elements;
      solved.add_to(gauge, element);
    }
    ++element;
  });
  std::vector<StrainGauge> list;
  for (auto& [label, gauge] : gauges) {
    for (double& mean : gauge.mean) mean /= double(gauge.elements);
    list.push_back(gauge);
  }
  return list;
}

std::vector<ElementValues> values_of(const SolvedElements& solved, const BrickTopology& elements,
                                     const std::vector<FemQuantity>& wanted) {
  std::vector<ElementValues> values;
  for (const FemQuantity quantity : wanted) {
    values.push_back({quantity, elements, solved.values_of(quantity)});
  }
  return values;
}

}  // namespace supple
