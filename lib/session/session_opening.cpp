#include "lib/session/session_opening.h"

#include <filesystem>

#include "lib/material/material.h"
#include "lib/material/tissue.h"
#include "lib/session/body_changes.h"
#include "lib/state/state_source.h"
#include "volumes/base/text.h"
#include "volumes/io/load/label_file.h"
#include "volumes/io/load/load.h"

namespace supple {

namespace {

void find_foreground(SessionBody& in, const std::string& path, const SessionOptions& options,
                     const VolumeStatistics& statistics, Progress* progress) {
  in.material.finds_foreground = !are_hounsfield_units(statistics.min);
  if (!in.material.finds_foreground) return;
  constexpr int kBins = 4096;
  in.material =
      with_foreground(in.material, statistics,
                      histogram(*open_volume(path, options.read), statistics, kBins, progress));
  note(progress, "material: densities of " + number_text(in.material.active_lo) +
                     " and more are tissue, brighter than the background (of " +
                     number_text(statistics.min) + " to " + number_text(statistics.max) + ")" +
                     (in.material.components == 1 ? ", their largest connected part" : ""));
}

/// Fits the material to the volume's densities: one tissue where none is given, a preset's domain.
void choose_material(SessionBody& in, const std::string& path, const SessionOptions& options,
                     Progress* progress) {
  const VolumeStatistics statistics =
      digest_volume(*open_volume(path, options.read), progress).statistics;
  if (options.material) {
    const bool fits_active = in.material.fits_active;
    in.material = fitted_to(in.material, statistics);
    if (in.material.finds_foreground)
      return find_foreground(in, path, options, statistics, progress);
    if (fits_active && !in.material.fits_active && !are_hounsfield_units(statistics.min)) {
      warn(progress, "material: densities from " + number_text(statistics.min) + " to " +
                         number_text(statistics.max) +
                         " are neither HU nor 0 to 255: every voxel above " +
                         number_text(statistics.min) +
                         " is tissue; active = [LO, HI] in the table chooses others");
    }
    return;
  }
  in.material = homogeneous_material(statistics.min, statistics.max);
  warn(progress, "no material given: every voxel above " + number_text(statistics.min) +
                     " is tissue of one kind (stretch 1.2, compression 0.8, shear 0.3)");
}

void open_state(SessionBody& in, const std::string& path, const SessionOptions& options,
                Progress* progress) {
  require_unused(options.read, path);
  in.state = read_state(path, progress);
  if (!options.refers) in.state.source.reset();
  if (options.refers && !in.state.source) {
    throw InputError({path, "refer", "a state that holds its densities",
                      "a volume, or a state that refers to one"});
  }
  if (!options.material) in.material = parse_material(in.state.material_toml, path + " material");
}

void open_volume_file(SessionBody& in, const std::string& path, const SessionOptions& options,
                      Progress* progress) {
  std::vector<CountedRange> counted = tissue_ranges(in.material);
  const auto file = open_volume(path, options.read, progress);
  ElementVolume loaded = load_elements(*file, in.material.active_lo, in.material.active_hi,
                                       in.material.components, 2, progress, &counted);
  const std::string void_values = void_values_text(loaded.volume.statistics);
  if (!void_values.empty()) warn(progress, path + ": " + void_values + " treated as void");
  const std::string missed = warning_of_domain(in.material, loaded.volume, counted);
  if (!missed.empty()) warn(progress, "material: " + missed);
  in.state.geometry = loaded.volume.geometry;
  in.state.density = std::move(loaded.volume.density);
  in.state.elements = std::move(loaded.elements);
  in.source = {path, options.read};
  if (options.refers) {
    stage(progress, "digesting the densities");
    in.state.source =
        make_source(file->header(), options.read, in.material.active_lo, in.material.active_hi,
                    in.material.components, in.state.density, in.state.elements);
  }
  in.state.source_name = std::filesystem::path(path).filename().string();
  in.state.source_type = loaded.volume.value_type;
}

void open_labels(SessionBody& in, const std::string& path, Progress* progress) {
  if (!in.state.anchor_labels.empty()) {
    throw InputError({path, "labels", "labels beside those that fix parts of the state",
                      "a state without fixed labels"});
  }
  in.state.labels =
      read_labels(*open_volume(path, {}, progress), in.state.geometry, in.state.elements, progress);
  if (in.state.labels.empty()) warn(progress, path + ": no element has a label");
}

void warn_of_material(const SessionBody& in, Progress* progress) {
  for (const std::string& line : in.material.warnings()) warn(progress, "material: " + line);
  if (in.material.labels.empty()) return;
  const auto counts = label_counts(in.state.labels);
  for (const auto& [label, table] : in.material.labels) {
    if (counts.count(label) != 0) continue;
    warn(progress, "material: label." + std::to_string(label) + ": no element has this label");
  }
}

}  // namespace

void open(SessionBody& in, const std::string& path, const SessionOptions& options,
          Progress* progress) {
  if (options.material) in.material = *options.material;
  if (is_state_file(path)) {
    open_state(in, path, options, progress);
  } else {
    if (!options.material || in.material.fits_domain || in.material.finds_foreground) {
      choose_material(in, path, options, progress);
    }
    open_volume_file(in, path, options, progress);
  }
  if (!options.labels_path.empty()) open_labels(in, options.labels_path, progress);
  warn_of_material(in, progress);

  stage(progress, "building the body");
  in.body = make_body(in.state, in.material);
  in.state.material_toml = material_to_toml(in.material);
  take_pieces_of_state(in, path, progress);
  in.start_anew();
  if (!in.links.fold_free && in.body.rigid.empty()) {
    note(progress,
         "the material does not rule out folds (min_length > 2 shear fails on some link)");
  }
}

}  // namespace supple
