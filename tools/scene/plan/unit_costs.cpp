#include "tools/scene/plan/unit_costs.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "lib/body/body_cost.h"
#include "lib/chainmail/ecm_cost.h"
#include "lib/fem/voxel/fem_cost.h"
#include "lib/relax/relax_cost.h"
#include "lib/springs/spring_cost.h"
#include "lib/state/state_cost.h"
#include "raycast/march/march_cost.h"
#include "volumes/base/atomic_file.h"
#include "volumes/base/error.h"
#include "volumes/base/json.h"
#include "volumes/base/table.h"
#include "volumes/field/inversion/inversion_cost.h"
#include "volumes/io/load/load_cost.h"

namespace supple::tools {

namespace {

/// All that a calibration measures, in the order of its file.
const UnitCost* const kUnits[] = {
    &kReadVoxelCost,     &kBodyElementCost, &kEcmElementCost, &kRelaxElementCost,
    &kVolumeElementCost, &kSpringCost,      &kFemUnknownCost, &kDisplacementVoxelCost,
    &kInvertVoxelCost,   &kSourceBrickCost, &kRayCost,        &kSampleCost,
    &kStillBrickCost,    &kWarpVoxelCost,   &kStateBrickCost, &kStateVectorBrickCost,
};

}  // namespace

double UnitCosts::operator[](const UnitCost& unit) const {
  const auto found = m_ns.find(unit.name);
  return found == m_ns.end() ? unit.ns : found->second;
}

Fields UnitCosts::fields() {
  Fields all;
  for (const UnitCost* unit : kUnits) {
    double& ns = m_ns.emplace(unit->name, unit->ns).first->second;
    all.push_back(Field(unit->name, ns, unit->help).unit("ns").positive());
  }
  all.push_back(Field("measured", measured, "When, and by which program"));
  return all;
}

std::string calibration_file() {
  const char* const cache = std::getenv("XDG_CACHE_HOME");
  const char* const home = std::getenv("HOME");
  std::filesystem::path folder;
  if (cache != nullptr && *cache == '/') {  // relative ones are to be ignored
    folder = cache;
  } else if (home != nullptr && *home != '\0') {
    folder = std::filesystem::path(home) / ".cache";
  } else {
    return "";
  }
  return (folder / "supple" / "calibration.toml").string();
}

UnitCosts read_costs(const std::string& path) {
  UnitCosts costs;
  std::error_code missing;
  if (path.empty() || !std::filesystem::exists(path, missing)) return costs;
  Table table = Table::read(path);
  table.read(costs.fields());
  table.finish();
  return costs;
}

void write_costs(const std::string& path, const UnitCosts& costs) {
  UnitCosts written = costs;
  std::string text =
      "# What a unit of work costs on this machine, in ns (supple bench --calibrate).\n";
  for (const Field& field : written.fields()) {
    const std::string value =
        field.holds<std::string>() ? json_string(written.measured) : field.text();
    text += field.name() + " = " + value + "\n";
  }
  std::error_code failed;
  std::filesystem::create_directories(std::filesystem::path(path).parent_path(), failed);
  AtomicFile file(path);
  std::ofstream stream(file.path(), std::ios::binary);
  if (!(stream << text << std::flush)) throw SystemError(path + ": cannot write");
  file.commit();
}

std::string origin_of(const UnitCosts& costs) {
  return costs.measured.empty()
             ? "costs as shipped; supple bench --calibrate measures those of this machine"
             : "costs measured " + costs.measured;
}

}  // namespace supple::tools
