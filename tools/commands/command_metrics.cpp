// supple metrics: displacement, Jacobian determinant, folds and volume change of a deformed body,
// as a summary and as maps.
#include <cstdio>

#include "tools/console/command.h"
#include "tools/console/field_options.h"
#include "tools/console/people_text.h"
#include "tools/scene/run/output_plan.h"
#include "volumes/base/json.h"
#include "volumes/field/inversion/deformation_metrics.h"
#include "volumes/io/load/label_file.h"
#include "volumes/io/open_volume.h"
#include "volumes/state/state_outputs.h"

namespace supple::tools {

namespace {

struct MetricsOptions {
  std::string input, labels;
  std::string displacement_map, jacobian_map, fold_map;
};

Fields fields(MetricsOptions& options) {
  return {
      Field("labels", options.labels, "Label volume on the same grid: a line per label")
          .shown_as("FILE")
          .otherwise("the state's labels"),
      Field("displacement", options.displacement_map,
            "Map of |u| in mm on the source grid, 0 outside the body")
          .shown_as("VOLUME"),
      Field("jacobian", options.jacobian_map, "Map of det F = det(I + grad u), 1 outside the body")
          .shown_as("VOLUME"),
      Field("folds", options.fold_map, "Map of folded cells: 1 at their lowest corner")
          .shown_as("VOLUME"),
  };
}

Value summary_json(const DeformationSummary& summary) {
  return {{"elements", summary.elements},
          {"moved", summary.moved},
          {"mean_mm", summary.mean_mm},
          {"rms_mm", summary.rms_mm},
          {"p95_mm", summary.p95_mm},
          {"max_mm", summary.max_mm},
          {"min_jacobian", summary.min_jacobian},
          {"max_jacobian", summary.max_jacobian},
          {"folded_cells", summary.folded_cells},
          {"folded_voxels", summary.folded_cells},  // the former name, for one release
          {"rest_volume_mm3", summary.rest_volume_mm3},
          {"volume_mm3", summary.volume_mm3},
          {"volume_change_percent", 100 * summary.volume_change()}};
}

/// Values of the elements on the source grid, `elsewhere` around them.
ScalarSliceSource slices_of(const DeformationMaps& maps, const Vec3i& dims, float elsewhere,
                            const std::function<float(std::size_t b, int offset)>& value) {
  return [&maps, dims, elsewhere, value](int k, float* out) {
    std::fill(out, out + std::size_t(dims.x) * dims.y, elsewhere);
    for (std::size_t b = 0; b < maps.elements.brick_count(); ++b) {
      const Vec3i& origin = maps.elements.origin(b);
      if (k < origin.z || k >= origin.z + kBrickDim) continue;
      for_each_active(maps.elements.mask(b), [&](int offset) {
        const Vec3i voxel = origin + brick_local(offset);
        if (voxel.z == k) out[std::size_t(voxel.y) * dims.x + voxel.x] = value(b, offset);
      });
    }
  };
}

void write_maps(const MetricsOptions& options, const State& state, const DeformationMaps& maps,
                Console& console) {
  const Vec3i& dims = state.geometry.dims();
  const auto write = [&](const std::string& path, ValueType type, float elsewhere,
                         const std::function<float(std::size_t, int)>& value) {
    if (path.empty()) return;
    const auto slices = slices_of(maps, dims, elsewhere, value);
    warn_of_all(path, write_volume(path, state.geometry, type, slices, &console), &console);
  };
  write(options.displacement_map, ValueType::float32, 0,
        [&](std::size_t b, int offset) { return maps.length_mm[b * kBrickVoxels + offset]; });
  write(options.jacobian_map, ValueType::float32, 1,
        [&](std::size_t b, int offset) { return maps.jacobian[b * kBrickVoxels + offset]; });
  write(options.fold_map, ValueType::uint8, 0,
        [&](std::size_t b, int offset) { return mask_test(maps.folded[b], offset) ? 1.0f : 0.0f; });
}

void print_metrics(const Value& json) {
  for (const auto& [name, value] : json.entries()) {
    if (name == "labels") continue;
    std::printf("%-22s %s\n", name.c_str(), people_text(value).c_str());
  }
  if (!json.contains("labels")) return;
  std::printf("\n%8s %10s %10s %10s %12s %14s %10s\n", "label", "elements", "mean mm", "max mm",
              "min det F", "volume mm3", "change %");
  for (const auto& [label, row] : json["labels"].entries()) {
    std::printf("%8s %10lld %10.4g %10.4g %12.4g %14.4g %10.4g\n", label.c_str(),
                static_cast<long long>(row["elements"].whole()), row["mean_mm"].number(),
                row["max_mm"].number(), row["min_jacobian"].number(), row["volume_mm3"].number(),
                row["volume_change_percent"].number());
  }
}

int run_metrics(const MetricsOptions& options, const GlobalOptions& global, Console& console) {
  OutputPlan plan(global.force);
  plan.protect(options.input);
  if (!options.labels.empty()) plan.protect(options.labels);
  for (const std::string& map :
       {options.displacement_map, options.jacobian_map, options.fold_map}) {
    if (!map.empty()) plan.add_dense(map);
  }
  console.claim(plan.files());
  const State state = read_reachable_state(options.input, &console);
  const BrickValues labels = options.labels.empty()
                                 ? state.labels
                                 : read_labels(*open_volume(options.labels, {}, &console),
                                               state.geometry, state.elements, &console);
  console.stage("measuring");
  const DeformationMaps maps = map_deformation(displacement_of(state), state.elements, state.cuts);
  write_maps(options, state, maps, console);

  Value json = summary_json(summarize(maps, state.geometry));
  if (!labels.empty()) {
    json["labels"] = Value::table();
    for (const auto& [label, summary] : summarize_labels(maps, labels, state.geometry)) {
      json["labels"][std::to_string(label)] = summary_json(summary);
    }
  }
  console.stage_seconds();
  if (global.json) {
    std::printf("%s\n", json_text(json, 2).c_str());
  } else if (!global.quiet) {
    print_metrics(json);
  }
  return kOk;
}

}  // namespace

Command add_metrics(CLI::App& program) {
  auto options = std::make_shared<MetricsOptions>();
  CLI::App* app = add_subcommand(
      program, "metrics", "Displacement, Jacobian, folds and volume change of a deformed body",
      "  supple metrics drag.vdb\n"
      "  supple metrics drag.vdb --labels organs.nrrd --json\n"
      "  supple metrics drag.vdb --jacobian det_f.nrrd --displacement length.nrrd");
  app->add_option("state", options->input, "A state file")->required()->option_text("STATE.vdb");
  add_field_options(*app, fields(*options));
  return {app, [options](const GlobalOptions& global, Console& console) {
            return run_metrics(*options, global, console);
          }};
}

}  // namespace supple::tools
