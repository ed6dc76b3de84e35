#include "lib/session/fem/fem_modes.h"

#include <algorithm>
#include <cmath>

#include "lib/body/node_offsets.h"
#include "lib/fem/voxel/fem_results.h"

namespace supple {

namespace {

constexpr double kAmplitudePart = 1.0 / 20;
constexpr int kMostModes = 200;

std::vector<Vec3f> centre_shape(const HexMesh& mesh, const std::vector<double>& nodes) {
  std::vector<Vec3d> centres(std::size_t(mesh.element_count()));
  double longest = 0;
  for (std::size_t e = 0; e < centres.size(); ++e) {
    centres[e] = centre_displacement(mesh, nodes, std::int32_t(e));
    longest = std::max(longest, centres[e].length());
  }
  std::vector<Vec3f> shape;
  shape.reserve(centres.size());
  for (const Vec3d& centre : centres) {
    shape.push_back(longest > 0 ? Vec3f(centre / longest) : Vec3f(0.0f));
  }
  return shape;
}

}  // namespace

double default_amplitude_mm(const Body& body) {
  Vec3i lo(0), hi(0);
  bool is_first = true;
  for_each_element(body.elements, [&](Slot slot) {
    const Vec3i voxel = voxel_of(body.elements, slot);
    for (int a = 0; a < 3; ++a) {
      lo[a] = is_first ? voxel[a] : std::min(lo[a], voxel[a]);
      hi[a] = is_first ? voxel[a] : std::max(hi[a], voxel[a]);
    }
    is_first = false;
  });
  const Vec3d edges(hi - lo + Vec3i(1));
  return kAmplitudePart * body.geometry.world_vector_from_index(edges).length();
}

ModesRecord find_modes_of_body(const ModeStep& step, const FemParams& params, const Body& shape,
                               const FemSolid& solid, const SlotSet& held, Progress* progress) {
  if (step.shape > step.count) {
    throw InputError({"", "shape", std::to_string(step.shape),
                      "at most the count of modes, " + std::to_string(step.count)});
  }
  ModeParams of_modes;
  of_modes.count = step.count;
  of_modes.max_iterations = params.max_iterations;
  of_modes.loose = params.loose;
  std::vector<HeldElements> grips;
  if (!held.empty()) grips.emplace_back().elements = held;
  FemModel model(shape, solid.elastic, params.elements, progress);
  while (model.part_hinges(shape, held_bits(model.mesh(), grips), progress)) {
  }
  const VibrationModes found =
      lowest_modes(model, solid.mass_density, held_bits(model.mesh(), grips), of_modes, progress);
  ModesRecord record;
  record.report = found.report;
  for (const VibrationMode& mode : found.modes) {
    record.modes.push_back({mode.frequency_hz, mode.residual, mode.participation_kg_half,
                            mode.effective_mass_kg(), centre_shape(model.mesh(), mode.shape)});
  }
  return record;
}

void take_mode_shape(const ModesRecord& record, int number, Body& body) {
  const std::vector<Vec3f>& shape = record.modes.at(std::size_t(number - 1)).shape;
  NodeOffsets offsets(body);
  std::size_t element = 0;
  for_each_element(body.elements, [&](Slot slot) {
    const Vec3d offset =
        body.geometry.index_vector_from_world(Vec3d(shape[element++]) * record.amplitude_mm);
    for (int c = 0; c < 3; ++c) offsets.set_offset(c, slot, offset[c]);
  });
  offsets.give(body);
}

Fields fields(ModeStep& step) {
  return {
      Field("count", step.count, "Lowest modes of vibration to find").range(1, kMostModes),
      Field("shape", step.shape, "Mode whose shape the body takes, the lowest is 1")
          .range(1, kMostModes)
          .only_in_scenes(),
      Field("amplitude", step.amplitude_mm, "Its largest displacement")
          .unit("mm")
          .positive()
          .otherwise("a twentieth of the body's diagonal")
          .recorded_as("amplitude_mm"),
  };
}

}  // namespace supple
