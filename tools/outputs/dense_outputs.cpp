#include "tools/outputs/dense_outputs.h"

#include <nlohmann/json.hpp>

#include "tools/outputs/outputs.h"
#include "volumes/io/open_volume.h"

namespace supple::tools {

Geometry choose_grid(const Geometry& source, const GridChoice& choice) {
  const Geometry grid = choice.file.empty() ? source : open_volume(choice.file)->header().geometry;
  return choice.margin_mm > 0 ? with_margin(grid, choice.margin_mm) : grid;
}

namespace {

std::int64_t warn_of_lost_material(const std::string& path, const State& state,
                                   const Pose& deformed, const Geometry& grid, Console& console) {
  const std::int64_t lost =
      count_outside(on_elements(state.geometry, state.elements, &deformed.displacement), grid);
  if (lost > 0) {
    console.warn(path + ": " + std::to_string(lost) +
                 " voxels of material lie outside the grid (see --margin)");
  }
  return lost;
}

}  // namespace

void warn_of_all(const std::string& path, const std::vector<std::string>& lines, Console& console) {
  for (const std::string& line : lines) console.warn(path + ": " + line);
}

VoidMode parse_void_mode(const std::string& name) {
  if (name == "nearest") return VoidMode::nearest;
  if (name == "outside") return VoidMode::outside;
  return VoidMode::extend;
}

std::int64_t write_state_warp(const WarpOutput& output, const State& state, const Pose& deformed,
                              Console& console) {
  WarpFacts facts{state.geometry, output.direction, ""};
  VectorSliceSource slices;
  std::int64_t lost = 0;
  if (output.direction == WarpDirection::material) {
    slices = dense_displacement(deformed.displacement);
  } else {
    lost = warn_of_lost_material(output.path, state, deformed, output.grid, console);
    facts.geometry = output.grid;
    facts.certificate = to_json(deformed.offsets.certificate).dump();
    slices = dense_offsets(deformed.offsets, state.density.bricks(), output.grid, output.void_mode);
  }
  warn_of_all(output.path, write_warp(output.path, facts, slices, &console, output.options),
              console);
  return lost;
}

std::int64_t write_resampled(const std::string& path, const State& state, const Pose& deformed,
                             const Geometry& grid, const WriteOptions& options, Console& console) {
  const std::int64_t lost = warn_of_lost_material(path, state, deformed, grid, console);
  ValueType type = ValueType::float32;
  find_numpy_type(state.source_type, type);
  const auto slices =
      dense_resampled(deformed.offsets, state.density, grid, state.density.background());
  warn_of_all(path, write_volume(path, grid, type, slices, &console, options), console);
  return lost;
}

void print_dense_report(const std::string& path, const Geometry& grid, std::int64_t lost_voxels,
                        const InversionCertificate& certificate) {
  const Vec3i& dims = grid.dims();
  const nlohmann::ordered_json json = {{"output", path},
                                       {"dims", {dims.x, dims.y, dims.z}},
                                       {"lost_voxels", lost_voxels},
                                       {"certificate", to_json(certificate)}};
  std::printf("%s\n", json.dump(2).c_str());
}

}  // namespace supple::tools
