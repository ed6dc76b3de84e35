#include "tools/lab/tradeoff/error_norms.h"

#include <algorithm>
#include <cmath>

#include "lib/body/body.h"
#include "lib/body/slot_set.h"
#include "lib/material/material.h"
#include "lib/relax/relaxation.h"
#include "volumes/base/error.h"
#include "volumes/field/inversion/deformation_metrics.h"

namespace supple::tools {

namespace {

Vec3d offset_mm(const State& state, std::size_t slot) {
  Vec3d offset;
  for (int c = 0; c < 3; ++c) offset[c] = state.q[std::size_t(c)].at(slot) / kFixedOne;
  return state.geometry.world_vector_from_index(offset);
}

bool has_same_elements(const State& a, const State& b) {
  if (!(a.geometry == b.geometry) || a.elements.brick_count() != b.elements.brick_count()) {
    return false;
  }
  for (std::size_t n = 0; n < a.elements.brick_count(); ++n) {
    if (a.elements.origin(n) != b.elements.origin(n)) return false;
    if (a.elements.mask(n) != b.elements.mask(n)) return false;
  }
  return true;
}

/// The value that a part of all do not exceed; reorders them.
double percentile(std::vector<double>& values, double part) {
  if (values.empty()) return 0;
  const auto place = values.begin() + std::ptrdiff_t(part * double(values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

/// Energy of docs/models/relaxation.md under the reference's material, limits or not.
double energy_of_links(const State& state, const MaterialTable& material) {
  Body body = make_body(state, material);
  RelaxParams params;
  params.method = RelaxMethod::plain;
  return Relaxation(body, SlotSet(), Holds(), params).energy();
}

}  // namespace

ErrorReference::ErrorReference(const std::string& state_path, Progress* progress)
    : m_state(read_state(state_path, progress)),
      m_material(parse_material(m_state.material_toml, state_path)) {
  double longest_mm = 0;
  for_each_element(m_state.elements, [&](std::size_t slot) {
    longest_mm = std::max(longest_mm, offset_mm(m_state, slot).length());
  });
  m_least_mm = kMovedPart * longest_mm;
}

double ErrorReference::resolution_mm() const {
  const Vec3d spacing = m_state.geometry.spacing_mm();
  return std::max({spacing.x, spacing.y, spacing.z}) / kFixedOne;
}

ErrorNorms ErrorReference::norms_of(const std::string& state_path, Progress* progress,
                                    std::vector<float>* distances_mm) const {
  const State state = read_state(state_path, progress);
  if (!has_same_elements(state, m_state)) {
    throw InputError(
        {state_path, "", "other elements than those of the reference", "a state of the same body"});
  }
  ErrorNorms norms;
  std::vector<double> errors_mm;
  for_each_element(state.elements, [&](std::size_t slot) {
    const Vec3d wanted_mm = offset_mm(m_state, slot);
    const double error_mm = (offset_mm(state, slot) - wanted_mm).length();
    norms.max_mm = std::max(norms.max_mm, error_mm);
    if (distances_mm != nullptr) distances_mm->push_back(float(error_mm));
    if (wanted_mm.length() > m_least_mm) errors_mm.push_back(error_mm);
  });
  norms.moved = std::int64_t(errors_mm.size());
  norms.p50_mm = percentile(errors_mm, 0.5);
  norms.p95_mm = percentile(errors_mm, 0.95);
  const DeformationMaps maps = map_deformation(displacement_of(state), state.elements, state.cuts);
  norms.volume_percent = 100 * summarize(maps, state.geometry).volume_change();
  norms.energy_uj = energy_of_links(state, m_material);
  return norms;
}

}  // namespace supple::tools
