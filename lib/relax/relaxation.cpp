#include "lib/relax/relaxation.h"

#include <algorithm>
#include <cmath>

#include "lib/relax/coordinate_relaxation.h"
#include "lib/relax/volume_relaxation.h"

namespace supple {

namespace {

constexpr RelaxMethod kMethods[] = {RelaxMethod::plain, RelaxMethod::jacobi, RelaxMethod::red_black,
                                    RelaxMethod::accelerated};

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

void RelaxParams::validate() const {
  if (passes < 0 || passes > kMaxPasses) {
    throw InputError({"", "passes", std::to_string(passes), "0 to " + std::to_string(kMaxPasses)});
  }
  if (!(tolerance_voxels >= 0)) {
    throw InputError({"", "tolerance", std::to_string(tolerance_voxels), "0 or more voxels"});
  }
  check_bulk_modulus(bulk_modulus_kpa);
  if (bulk_modulus_kpa > 0 && !conserves_volume(method)) {
    throw InputError(
        {"", "volume", std::string("method ") + name_of(method), "red-black or accelerated"});
  }
}

void check_bulk_modulus(double kpa) {
  if (kpa >= 0 && kpa <= kMaxBulkModulusKpa) return;
  throw InputError(
      {"", "volume", number_text(kpa), "0 to " + number_text(kMaxBulkModulusKpa) + " kPa"});
}

Relaxation::Relaxation(Body& body, const SlotSet& fixed, const Holds& held,
                       const RelaxParams& params)
    : m_body(body) {
  params.validate();
  if (params.bulk_modulus_kpa > 0) {
    m_volume = std::make_unique<VolumeRelaxation>(body, fixed, held, params);
    return;
  }
  for (int c = 0; c < 3; ++c) {
    const std::size_t at = std::size_t(c);
    if (body.q[at].empty() && body.fraction[at].empty() && !has_rest(body, c)) continue;
    m_coordinates[at] = std::make_unique<CoordinateRelaxation>(body, c, fixed, held, params.method);
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
  if (m_volume) return m_volume->store(m_body);
  for (const auto& coordinate : m_coordinates) {
    if (coordinate) coordinate->store(m_body);
  }
}

SlotSet still_elements(const Body& body, const std::vector<Region>& fixed, const Holds& held) {
  SlotSet still = held.still;
  for (const Region& region : fixed) still.add(elements_of(body, region, "fix"));
  return still;
}

std::size_t Relaxation::bytes() const {
  std::size_t total = m_volume ? m_volume->bytes() : 0;
  for (const auto& coordinate : m_coordinates) {
    if (coordinate) total += coordinate->bytes();
  }
  return total;
}

}  // namespace supple
