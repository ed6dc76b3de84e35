#include "lib/relax/relaxation.h"

#include <algorithm>
#include <cmath>

#include "lib/relax/cell_moduli.h"
#include "lib/relax/coordinate_relaxation.h"
#include "lib/relax/volume_relaxation.h"

namespace supple {

namespace {

/// Names of the methods, in the order of the enumerators.
const std::vector<std::string> kMethodNames = {"plain", "jacobi", "red-black", "accelerated"};

/// 2^-32 voxel of coordinate c in mm.
double fine_mm(const Body& body, int c) {
  return body.geometry.spacing_mm()[c] / (kFinePerUnit * kFixedOne);
}

/// Throws InputError where diagonals would yield, as rest stretches belong to axis links.
void require_no_yield(const Body& body) {
  const int links = body.slacks.links();
  if (links == 6) return;
  for (int c = 0; c < 3; ++c) {
    if (!body.material.has_yield_strain() && !has_rest(body, c)) continue;
    throw InputError({"", "links", std::to_string(links) + " with plastic flow",
                      "links = 6, or a material without plastic: diagonals do not yield"});
  }
}

}  // namespace

const char* name_of(RelaxMethod method) {
  return kMethodNames[std::size_t(method)].c_str();
}

bool conserves_volume(RelaxMethod method) {
  return method == RelaxMethod::red_black || method == RelaxMethod::accelerated;
}

int spring_links(const Body& body, bool conserves_volume) {
  return conserves_volume ? 6 : body.slacks.links();
}

Fields fields(RelaxParams& params) {
  return {
      Field("passes", params.passes, "Relax the body, at most so many passes")
          .range(1, kMaxPasses)
          .otherwise("20 beside others")
          .option("relax"),
      Field("method", params.method, kMethodNames,
            "plain (the thesis' pass, breaks limits), jacobi, red-black or accelerated"),
      Field("tolerance", params.tolerance_voxels,
            "End when a pass moves no further, and forces agree")
          .unit("voxels")
          .at_least(0)
          .recorded_as("tolerance_voxels"),
      Field("bulk_modulus", params.bulk_modulus_kpa,
            "Bulk modulus by which relaxed tissue keeps its volume")
          .unit("kPa")
          .range(0, kMaxBulkModulusKpa)
          .option("bulk-modulus")
          .recorded_as("bulk_modulus_kpa")
          .formerly("volume"),
      Field("poisson", params.poisson,
            "Keep volume as the material's Poisson's ratio says, in place of a bulk modulus")
          .only_in_scenes(),
      Field("budget", params.budget_million, "End after so many looks at elements; 0: no limit")
          .unit("million")
          .at_least(0)
          .recorded_as("budget_million"),
      Field("still", params.still_voxels,
            "Leave out, with links = 18 or 26, what a pass moves no further")
          .unit("voxels")
          .at_least(0)
          .only_in_scenes()
          .recorded_as("still_voxels"),
  };
}

RelaxParams tissue_relaxation(bool poisson) {
  RelaxParams params;
  params.poisson = poisson;
  params.passes = 5000;
  params.tolerance_voxels = 0.01;
  params.budget_million = 200;
  return params;
}

void RelaxParams::validate() const {
  if (passes < 0 || passes > kMaxPasses) {
    throw InputError({"", "passes", std::to_string(passes), "0 to " + std::to_string(kMaxPasses)});
  }
  if (!(tolerance_voxels >= 0)) {
    throw InputError({"", "tolerance", std::to_string(tolerance_voxels), "0 or more voxels"});
  }
  if (!(budget_million >= 0)) {
    throw InputError({"", "budget", number_text(budget_million), "0 or more million elements"});
  }
  if (!(still_voxels >= 0)) {
    throw InputError({"", "still", number_text(still_voxels), "0 or more voxels"});
  }
  check_bulk_modulus(bulk_modulus_kpa);
  if (conserves_volume() && !supple::conserves_volume(method)) {
    throw InputError(
        {"", "bulk_modulus", std::string("method ") + name_of(method), "red-black or accelerated"});
  }
}

void check_bulk_modulus(double kpa) {
  if (kpa >= 0 && kpa <= kMaxBulkModulusKpa) return;
  throw InputError(
      {"", "bulk_modulus", number_text(kpa), "0 to " + number_text(kMaxBulkModulusKpa) + " kPa"});
}

Relaxation::Relaxation(Body& body, const SlotSet& fixed, const Holds& held,
                       const RelaxParams& params)
    : Relaxation(body, fixed, held, params, moduli_of(body, params)) {}

Relaxation::Relaxation(Body& body, const SlotSet& fixed, const Holds& held,
                       const RelaxParams& params, const CellModuli& moduli)
    : m_body(body) {
  params.validate();
  require_no_yield(body);
  if (moduli.any()) {
    m_volume = std::make_unique<VolumeRelaxation>(body, fixed, held, params.method, moduli);
    return;
  }
  for (int c = 0; c < 3; ++c) {
    const std::size_t at = std::size_t(c);
    if (body.q[at].empty() && body.fraction[at].empty() && !has_rest(body, c)) continue;
    m_coordinates[at] = std::make_unique<CoordinateRelaxation>(body, c, fixed, held, params);
  }
}

Relaxation::~Relaxation() = default;

double Relaxation::pass() {
  if (m_volume) {
    m_work += m_volume->work_of_pass();
    const double largest = m_volume->pass();
    m_energy = m_volume->energy_before_pass();
    return largest;
  }
  double largest = 0;
  m_energy = 0;
  for (int c = 0; c < 3; ++c) {
    const auto& coordinate = m_coordinates[std::size_t(c)];
    if (!coordinate) continue;
    m_work += coordinate->work_of_pass();
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

std::optional<double> Relaxation::excess() const {
  if (m_volume) return std::nullopt;
  double total = 0;
  for (int c = 0; c < 3; ++c) {
    const auto& coordinate = m_coordinates[std::size_t(c)];
    const double mm = fine_mm(m_body, c);
    if (coordinate) total += 0.5 * coordinate->excess() * mm * mm;
  }
  return total;
}

void Relaxation::store() {
  if (m_volume) return m_volume->store(m_body);
  for (const auto& coordinate : m_coordinates) {
    if (coordinate) coordinate->store(m_body);
  }
}

SlotSet anchored_elements(const Body& body, const std::vector<Region>& fixed, const Holds& held) {
  SlotSet anchored = held.anchored;
  for (const Region& region : fixed) anchored.add(elements_of(body, region, "fix"));
  return anchored;
}

std::size_t Relaxation::bytes() const {
  std::size_t total = m_volume ? m_volume->bytes() : 0;
  for (const auto& coordinate : m_coordinates) {
    if (coordinate) total += coordinate->bytes();
  }
  return total;
}

}  // namespace supple
