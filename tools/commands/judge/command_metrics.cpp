// supple metrics: displacement, Jacobian determinant, folds, volume change and bending of a
// deformed body or of a warp, as a summary and as maps.
#include <cmath>
#include <cstdio>

#include "lib/state/state_outputs.h"
#include "tools/console/command.h"
#include "tools/console/field_options.h"
#include "tools/console/result_lines.h"
#include "tools/scene/run/output_plan.h"
#include "volumes/base/json.h"
#include "volumes/field/dense/invert_warp.h"
#include "volumes/field/inversion/deformation_metrics.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/load/label_file.h"
#include "volumes/io/load/stored_labels.h"
#include "volumes/io/volume_writer.h"
#include "volumes/io/warp_file.h"

namespace supple::tools {

namespace {

struct MetricsOptions {
  std::string input, labels, mask, grid;
  std::string displacement_map, jacobian_map, fold_map, bending_map;
};

Fields fields(MetricsOptions& options) {
  return {
      Field("labels", options.labels, "Label volume on the same grid: a line per label")
          .shown_as("FILE")
          .otherwise("the state's labels"),
      Field("mask", options.mask, "Count only where this volume of whole numbers is not 0")
          .shown_as("FILE"),
      Field("grid", options.grid, "Grid for a transform that names none").shown_as("FILE"),
      Field("displacement", options.displacement_map,
            "Map of |u| in mm on the source or warp's grid, 0 outside the body")
          .shown_as("VOLUME"),
      Field("jacobian", options.jacobian_map, "Map of det F = det(I + grad u), 1 outside the body")
          .shown_as("VOLUME"),
      Field("folds", options.fold_map, "Map of folded cells: 1 at their lowest corner")
          .shown_as("VOLUME"),
      Field("bending", options.bending_map,
            "Map of the bending energy's density in 1/mm^2, 0 where a neighbour is missing")
          .shown_as("VOLUME"),
  };
}

/// A deformation to measure, of a state or of a warp, with the links that carry it.
struct Measured {
  Displacement u;
  BrickTopology elements;
  LinkCuts cuts;
  BrickValues labels;     // of the state
  std::string direction;  // of the warp; empty for a state

  const Geometry& geometry() const { return u.geometry; }
};

Measured read_measured(const MetricsOptions& options, Console& console) {
  Measured measured;
  if (is_state_file(options.input)) {
    if (!options.grid.empty()) {
      throw UsageError("--grid: found a state, expected a transform that names no grid");
    }
    State state = read_reachable_state(options.input, &console);
    measured.u = displacement_of(state);
    measured.elements = state.elements;
    measured.cuts = std::move(state.cuts);
    measured.labels = std::move(state.labels);
    return measured;
  }
  const auto grid = grid_of_file({options.grid});
  const Warp warp = read_warp(options.input, &console, grid ? &*grid : nullptr);
  measured.u = displacement_of_warp(warp);
  measured.elements = measured.u.u.topology;
  const char* const names[] = {"resample", "material"};
  measured.direction = warp.direction ? names[int(*warp.direction)] : "not recorded";
  return measured;
}

/// 1 at the elements where the mask of the file is not 0.
BrickValues read_mask(const std::string& path, const Measured& measured, Console& console) {
  const StoredLabels mask(*open_volume(path, {}, &console), &console);
  BrickValues values(measured.elements.brick_count());
  for (std::size_t b = 0; b < measured.elements.brick_count(); ++b) {
    for_each_active(measured.elements.mask(b), [&](int offset) {
      const Vec3d voxel(measured.elements.origin(b) + brick_local(offset));
      if (mask.label_at(measured.geometry().world_from_index(voxel)) != 0) {
        values.set(b * kBrickVoxels + std::size_t(offset), 1);
      }
    });
  }
  return values;
}

void write_maps(const MetricsOptions& options, const Geometry& geometry,
                const DeformationMaps& maps, Console& console) {
  const auto write = [&](const std::string& path, ValueType type, DeformationMap which) {
    if (path.empty()) return;
    const auto slices = slices_of(maps, which, geometry.dims());
    warn_of_all(path, write_volume(path, geometry, type, slices, &console), &console);
  };
  write(options.displacement_map, ValueType::float32, DeformationMap::length_mm);
  write(options.jacobian_map, ValueType::float32, DeformationMap::jacobian);
  write(options.fold_map, ValueType::uint8, DeformationMap::folded);
  write(options.bending_map, ValueType::float32, DeformationMap::bending_per_mm2);
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

OutputPlan plan_of(const MetricsOptions& options, const GlobalOptions& global) {
  OutputPlan plan(global.force);
  for (const std::string* input : {&options.input, &options.labels, &options.mask, &options.grid}) {
    if (!input->empty()) plan.protect(*input);
  }
  for (const std::string* map : {&options.displacement_map, &options.jacobian_map,
                                 &options.fold_map, &options.bending_map}) {
    if (!map->empty()) plan.add_dense(*map);
  }
  return plan;
}

int run_metrics(const MetricsOptions& options, const GlobalOptions& global, Console& console) {
  console.claim(plan_of(options, global).files());
  const Measured measured = read_measured(options, console);
  const Geometry& geometry = measured.geometry();
  const BrickValues labels = options.labels.empty()
                                 ? measured.labels
                                 : read_labels(*open_volume(options.labels, {}, &console), geometry,
                                               measured.elements, &console);
  std::optional<BrickValues> mask;
  if (!options.mask.empty()) mask = read_mask(options.mask, measured, console);
  const BrickValues* const within = mask ? &*mask : nullptr;
  console.stage("measuring");
  const DeformationMaps maps = map_deformation(measured.u, measured.elements, measured.cuts);
  const DeformationSummary whole = summarize(maps, geometry, within);
  if (whole.elements == 0 && within != nullptr) {
    throw InputError({options.mask, "", "0 wherever something is measured", "a mask of a part"});
  }
  write_maps(options, geometry, maps, console);

  Value json;
  if (!measured.direction.empty()) json["direction"] = measured.direction;
  json.update(to_value(whole));
  if (!labels.empty()) {
    json["labels"] = Value::Entries();
    for (const auto& [label, summary] : summarize_labels(maps, labels, geometry, within)) {
      json["labels"][std::to_string(label)] = to_value(summary);
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
      program, "metrics",
      "Displacement, Jacobian, folds, volume change and bending of a deformed body or a warp",
      "  supple metrics 1Warp.nii.gz --mask lung.nii.gz\n"
      "  supple metrics drag.vdb --labels organs.nrrd --json\n"
      "  supple metrics drag.vdb --jacobian det_f.nrrd --displacement length.nrrd");
  app->add_option("deformation", options->input,
                  "A state, or a warp or transform, whose vectors count as they stand")
      ->required()
      ->option_text("STATE.vdb|FIELD");
  add_field_options(*app, fields(*options));
  return {app, [options](const GlobalOptions& global, Console& console) {
            return run_metrics(*options, global, console);
          }};
}

}  // namespace supple::tools
