#include "lib/relax/relaxation.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "lib/relax/coordinate_relaxation.h"
#include "lib/relax/plastic_flow.h"
#include "lib/relax/volume_relaxation.h"

namespace supple {

namespace {

constexpr RelaxMethod kMethods[] = {RelaxMethod::plain, RelaxMethod::jacobi, RelaxMethod::red_black,
                                    RelaxMethod::accelerated};

void check(const RelaxParams& params) {
  if (params.passes < 0 || params.passes > kMaxPasses) {
    throw InputError(
        {"", "passes", std::to_string(params.passes), "0 to " + std::to_string(kMaxPasses)});
  }
  if (!(params.tolerance_voxels >= 0)) {
    throw InputError(
        {"", "tolerance", std::to_string(params.tolerance_voxels), "0 or more voxels"});
  }
  check_volume_stiffness(params.volume_stiffness_kpa);
  if (params.volume_stiffness_kpa > 0 && !conserves_volume(params.method)) {
    throw InputError({"", "volume", std::string("method ") + name_of(params.method),
                      "red-black or accelerated"});
  }
}

/// 2^-32 voxel of coordinate c in mm.
double fine_mm(const Body& body, int c) {
  return body.geometry.spacing_mm()[c] / (kFinePerUnit * kFixedOne);
}

}  // namespace

const char* name_of(RelaxMethod method) {
  switch (method) {
    case RelaxMethod::plain:
      return "plain";
    case RelaxMethod::jacobi:
      return "jacobi";
    case RelaxMethod::red_black:
      return "red-black";
    default:
      return "accelerated";
  }
}

std::optional<RelaxMethod> relax_method(const std::string& name) {
  for (const RelaxMethod method : kMethods) {
    if (name == name_of(method)) return method;
  }
  return std::nullopt;
}

std::string relax_method_names() {
  std::string names;
  for (const RelaxMethod method : kMethods) {
    names += (names.empty() ? "" : ", ") + std::string(name_of(method));
  }
  return names;
}

bool conserves_volume(RelaxMethod method) {
  return method == RelaxMethod::red_black || method == RelaxMethod::accelerated;
}

void check_volume_stiffness(double kpa) {
  if (kpa >= 0 && kpa <= kMaxVolumeStiffnessKpa) return;
  throw InputError(
      {"", "volume", number_text(kpa), "0 to " + number_text(kMaxVolumeStiffnessKpa) + " kPa"});
}

Relaxation::Relaxation(Body& body, const SlotSet& fixed, const Holds& held,
                       const RelaxParams& params)
    : m_body(body) {
  check(params);
  if (params.volume_stiffness_kpa > 0) {
    m_volume = std::make_unique<VolumeRelaxation>(body, fixed, held, params);
    return;
  }
  for (int c = 0; c < 3; ++c) {
    if (body.q[std::size_t(c)].empty() && !has_rest(body, c)) continue;
    m_coordinates[std::size_t(c)] =
        std::make_unique<CoordinateRelaxation>(body, c, fixed, held, params.method);
  }
}

Relaxation::~Relaxation() = default;

double Relaxation::pass() {
  if (m_volume) {
    const double largest = m_volume->pass();
    m_energy = m_volume->energy_before_pass();
    return largest;
  }
  double largest = 0;
  m_energy = 0;
  for (int c = 0; c < 3; ++c) {
    const auto& coordinate = m_coordinates[std::size_t(c)];
    if (!coordinate) continue;
    largest = std::max(largest, coordinate->pass());
    const double mm = fine_mm(m_body, c);
    m_energy += 0.5 * coordinate->energy_before_pass() * mm * mm;
  }
  return largest / (kFinePerUnit * kFixedOne);
}

double Relaxation::energy() {
  if (m_volume) return m_volume->energy();
  double total = 0;
  for (int c = 0; c < 3; ++c) {
    const auto& coordinate = m_coordinates[std::size_t(c)];
    const double mm = fine_mm(m_body, c);
    if (coordinate) total += 0.5 * coordinate->energy() * mm * mm;
  }
  return total;
}

void Relaxation::store() {
  if (m_volume) return m_volume->store(m_body.q);
  for (std::size_t c = 0; c < 3; ++c) {
    if (m_coordinates[c]) m_coordinates[c]->store(m_body.q[c]);
  }
}

SlotSet still_elements(const Body& body, const std::vector<Region>& fixed, const Holds& held) {
  SlotSet still = held.still;
  for (const Region& region : fixed) still.add(elements_of(body, region, "fix"));
  return still;
}

RelaxReport relax(Body& body, const std::vector<Region>& fixed, const Holds& held,
                  const RelaxParams& params, Progress* progress) {
  const auto begin = std::chrono::steady_clock::now();
  check(params);
  RelaxReport result;
  const SlotSet still = still_elements(body, fixed, held);
  if (!body.links_known_valid) {
    const ProjectionReport projection = project(body);
    result.projected_links = projection.violated_links;
    result.projected_max_voxels = projection.max_move_voxels;
  }
  const bool conserves = params.volume_stiffness_kpa > 0;
  if (conserves) result.volumes_before = cell_volumes(body);
  Relaxation relaxation(body, still, held, params);
  const auto finish = [&] {
    result.energy_after = relaxation.energy();
    relaxation.store();
    if (body.material.has_plastic()) result.yielded_links = let_flow(body);
    body.links_known_valid = params.method != RelaxMethod::plain;
  };
  try {
    for (int n = 0; n < params.passes && !result.converged; ++n) {
      report(progress, double(n) / params.passes);
      result.largest_step_voxels = relaxation.pass();
      if (n == 0) result.energy_before = relaxation.energy_before_pass();
      ++result.passes;
      result.converged = result.largest_step_voxels <= params.tolerance_voxels;
    }
  } catch (const Cancelled&) {
    finish();
    throw;
  }
  finish();
  if (conserves) result.volumes_after = cell_volumes(body);
  if (result.passes == 0) result.energy_before = result.energy_after;
  result.milliseconds =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  return result;
}

std::size_t Relaxation::bytes() const {
  std::size_t total = m_volume ? m_volume->bytes() : 0;
  for (const auto& coordinate : m_coordinates) {
    if (coordinate) total += coordinate->bytes();
  }
  return total;
}

}  // namespace supple
