#include "tools/scene/plan/unit_costs.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "volumes/base/atomic_file.h"
#include "volumes/base/error.h"
#include "volumes/base/json.h"
#include "volumes/base/table.h"

namespace supple::tools {

Fields fields(UnitCosts& costs) {
  const auto cost = [](const char* name, double& value, const char* help) {
    return Field(name, value, help).unit("ns").positive();
  };
  return {
      cost("read_voxel", costs.read_voxel, "A voxel of the file's box, read and put into bricks"),
      cost("body_element", costs.body_element, "An element of the body, its links checked"),
      cost("ecm_element", costs.ecm_element, "An element that ECM moves, per coordinate"),
      cost("relax_element", costs.relax_element, "An element, per pass and coordinate"),
      cost("volume_element", costs.volume_element, "The same where cells keep their volume"),
      cost("spring", costs.spring, "A spring, per step of the first two to a minimum"),
      cost("fem_unknown", costs.fem_unknown, "An unknown of finite elements, per iteration"),
      cost("displacement_voxel", costs.displacement_voxel, "A voxel of bricks that move"),
      cost("invert_voxel", costs.invert_voxel, "A voxel of bricks that move, inverted"),
      cost("source_brick", costs.source_brick, "A brick of the volume as pictures read it"),
      cost("ray", costs.ray, "A pixel beside its samples"),
      cost("sample", costs.sample, "A sample of a ray"),
      cost("still_brick", costs.still_brick, "A brick of the body that does not move"),
      cost("warp_voxel", costs.warp_voxel, "A voxel of a dense warp or volume, written"),
      cost("state_brick", costs.state_brick, "A brick of a state, written"),
      cost("state_vector_brick", costs.state_vector_brick, "The same with offsets"),
      Field("measured", costs.measured, "When, and by which program"),
  };
}

double fem_work(double unknowns, double iterations) {
  constexpr double kSetup = 5, kSmallest = 18000;
  return (unknowns + kSmallest) * (iterations + kSetup);
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
  table.read(fields(costs));
  table.finish();
  return costs;
}

void write_costs(const std::string& path, const UnitCosts& costs) {
  UnitCosts written = costs;
  std::string text =
      "# What a unit of work costs on this machine, in ns (supple bench --calibrate).\n";
  for (const Field& field : fields(written)) {
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
