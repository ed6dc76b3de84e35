#include "lib/session/session.h"

#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include "lib/material/material_file.h"
#include "lib/session/handles/drag_handles.h"
#include "lib/session/journal.h"
#include "lib/session/session_before.h"
#include "lib/session/session_walk.h"
#include "lib/session/step_warnings.h"
#include "lib/session/tissue.h"
#include "lib/state/state_outputs.h"
#include "lib/state/state_source.h"
#include "volumes/base/text.h"
#include "volumes/io/load/label_file.h"
#include "volumes/io/load/load.h"
#include "volumes/io/open_volume.h"

namespace supple {

namespace {

/// Keeps the warnings that it hands on.
class Listener final : public Progress {
 public:
  Listener(std::vector<std::string>& messages, Progress* next)
      : m_messages(messages), m_next(next) {}

  void stage(std::string_view name) override { supple::stage(m_next, name); }
  void update(double fraction) override {
    if (m_next != nullptr) m_next->update(fraction);
  }
  bool cancelled() const override { return m_next != nullptr && m_next->cancelled(); }
  void warn(const std::string& line) override {
    m_messages.push_back(line);
    supple::warn(m_next, line);
  }
  void note(const std::string& line) override { supple::note(m_next, line); }
  void debug(const std::string& line) override { supple::debug(m_next, line); }

 private:
  std::vector<std::string>& m_messages;
  Progress* m_next;
};

}  // namespace

Session::Session(const std::string& path, const SessionOptions& options, Progress* heard)
    : m_keeps_undo(options.keeps_undo) {
  Listener listener(m_messages, heard);
  Progress* progress = &listener;
  if (options.material) m_material = *options.material;
  if (is_state_file(path)) {
    open_state(path, options, progress);
  } else {
    if (!options.material || m_material.fits_domain || m_material.finds_foreground) {
      choose_material(path, options, progress);
    }
    open_volume_file(path, options, progress);
  }
  if (!options.labels_path.empty()) open_labels(options.labels_path, progress);
  warn_of_material(progress);

  stage(progress, "building the body");
  m_body = make_body(m_state, m_material);
  m_state.material_toml = material_to_toml(m_material);
  take_pieces_of_state(path, progress);
  m_links = check_links(m_body);
  m_body.links_known_valid = !m_body.beyond && m_links.violated == 0;
  find_anchors();
  m_ecm = std::make_unique<VoxelEcmModel>(held());
  if (!m_links.fold_free && m_body.rigid.empty()) {
    note(progress,
         "the material does not rule out folds (min_length > 2 shear fails on some link)");
  }
}

Session::~Session() = default;

/// Fits the material to the volume's densities: one tissue where none is given, a preset's domain.
void Session::choose_material(const std::string& path, const SessionOptions& options,
                              Progress* progress) {
  const VolumeStatistics statistics =
      digest_volume(*open_volume(path, options.read), progress).statistics;
  if (options.material) {
    const bool fits_active = m_material.fits_active;
    m_material = fitted_to(m_material, statistics);
    if (m_material.finds_foreground) return find_foreground(path, options, statistics, progress);
    if (fits_active && !m_material.fits_active && !are_hounsfield_units(statistics.min)) {
      warn(progress, "material: densities from " + number_text(statistics.min) + " to " +
                         number_text(statistics.max) +
                         " are neither HU nor 0 to 255: every voxel above " +
                         number_text(statistics.min) +
                         " is tissue; active = [LO, HI] in the table chooses others");
    }
    return;
  }
  m_material = homogeneous_material(statistics.min, statistics.max);
  warn(progress, "no material given: every voxel above " + number_text(statistics.min) +
                     " is tissue of one kind (stretch 1.2, compression 0.8, shear 0.3)");
}

void Session::find_foreground(const std::string& path, const SessionOptions& options,
                              const VolumeStatistics& statistics, Progress* progress) {
  m_material.finds_foreground = !are_hounsfield_units(statistics.min);
  if (!m_material.finds_foreground) return;
  constexpr int kBins = 4096;
  m_material =
      with_foreground(m_material, statistics,
                      histogram(*open_volume(path, options.read), statistics, kBins, progress));
  note(progress, "material: densities of " + number_text(m_material.active_lo) +
                     " and more are tissue, brighter than the background (of " +
                     number_text(statistics.min) + " to " + number_text(statistics.max) + ")" +
                     (m_material.components == 1 ? ", their largest connected part" : ""));
}

void Session::open_state(const std::string& path, const SessionOptions& options,
                         Progress* progress) {
  require_unused(options.read, path);
  m_state = read_state(path, progress);
  if (!options.refers) m_state.source.reset();
  if (options.refers && !m_state.source) {
    throw InputError({path, "refer", "a state that holds its densities",
                      "a volume, or a state that refers to one"});
  }
  if (!options.material) m_material = parse_material(m_state.material_toml, path + " material");
}

void Session::open_volume_file(const std::string& path, const SessionOptions& options,
                               Progress* progress) {
  std::vector<CountedRange> counted = tissue_ranges(m_material);
  const auto file = open_volume(path, options.read, progress);
  ElementVolume loaded = load_elements(*file, m_material.active_lo, m_material.active_hi,
                                       m_material.components, 2, progress, &counted);
  const std::string void_values = void_values_text(loaded.volume.statistics);
  if (!void_values.empty()) warn(progress, path + ": " + void_values + " treated as void");
  const std::string missed = warning_of_domain(m_material, loaded.volume, counted);
  if (!missed.empty()) warn(progress, "material: " + missed);
  m_state.geometry = loaded.volume.geometry;
  m_state.density = std::move(loaded.volume.density);
  m_state.elements = std::move(loaded.elements);
  m_source = {path, options.read};
  if (options.refers) {
    stage(progress, "digesting the densities");
    m_state.source =
        make_source(file->header(), options.read, m_material.active_lo, m_material.active_hi,
                    m_material.components, m_state.density, m_state.elements);
  }
  m_state.source_name = std::filesystem::path(path).filename().string();
  m_state.source_type = loaded.volume.value_type;
}

void Session::open_labels(const std::string& path, Progress* progress) {
  if (!m_state.anchor_labels.empty()) {
    throw InputError({path, "labels", "labels beside those that fix parts of the state",
                      "a state without fixed labels"});
  }
  m_state.labels =
      read_labels(*open_volume(path, {}, progress), m_state.geometry, m_state.elements, progress);
  if (m_state.labels.empty()) warn(progress, path + ": no element has a label");
}

void Session::warn_of_material(Progress* progress) const {
  for (const std::string& line : m_material.warnings()) warn(progress, "material: " + line);
  if (m_material.labels.empty()) return;
  const auto counts = label_counts(m_state.labels);
  for (const auto& [label, table] : m_material.labels) {
    if (counts.count(label) != 0) continue;
    warn(progress, "material: label." + std::to_string(label) + ": no element has this label");
  }
}

Region Session::region_of_label(std::int32_t label, const std::string& role) const {
  require_label(m_state.labels, label, role);
  return Region::of_mask(
      std::make_shared<BrickTopology>(label_mask(m_state.elements, m_state.labels, label)),
      "label:" + std::to_string(label));
}

Region Session::region_of(const Drag& drag) const {
  Region region = drag.region;
  if (drag.selection) {
    region = supple::region_of(*drag.selection, m_body, m_state.density, "grab");
  } else if (drag.label != 0) {
    region = region_of_label(drag.label, "grab");
  }
  return drag.spares_fixed && !m_anchors.empty() ? without_fixed(region) : region;
}

Region Session::without_fixed(const Region& region) const {
  SlotSet free = elements_of(m_body, region, "grab");
  const SlotSet fixed = fixed_elements();
  Slot slot;
  if (!free.first_common(fixed, slot)) return region;
  free.remove(fixed);
  if (free.empty()) {
    throw InputError({"", "grab " + region.name(), "fixed elements alone",
                      "elements that no anchor holds; an anchor that is released lets go of them"});
  }
  return supple::region_of(free, m_body.elements, region.name());
}

namespace {

/// Errors that name no file get the place of the step.
template <class Work>
decltype(auto) placed_at(const Step& step, const Work& work) {
  try {
    return work();
  } catch (const InputError& error) {
    const Problem& problem = error.problem();
    if (!problem.file.empty()) throw;
    throw InputError({step.place, problem.field, problem.found, problem.expected});
  }
}

void require_points(const Step& step, const Body& body) {
  const auto require = [&](const auto& placed) {
    if (placed && placed->points) require_in_body(*placed->points, body);
  };
  for (const Drag& drag : step.drags) require(drag.placed);
  for (const ChosenPart& part : step.fix) require(part.placed);
}

}  // namespace

void Session::check(const Step& step) const {
  placed_at(step, [&] {
    require_points(step, m_body);
    check_elements(on_grid(step, geometry()));
  });
}

void Session::check_elements(const Step& request) const {
  const auto waits = [&](const Selection& selection) {  // for pieces that a step makes
    return selection.rigid_at && m_body.rigid.empty();
  };
  for (const Drag& drag : request.drags) {
    if (drag.selection && waits(*drag.selection)) continue;
    const Region region = region_of(drag);
    require_element(region, "grab", m_body, m_state, m_source);
    elements_of(m_body, region, "grab");
  }
  for (const ChosenPart& part : request.fix) {
    if (const IndexBox* box = part.box()) {
      require_element(*box, "fix", m_body, m_state, m_source);
      elements_of(m_body, *box, "fix");
    } else if (part.label != 0) {
      require_label(m_state.labels, part.label, "fix");
    } else if (!waits(*part.selection)) {
      supple::region_of(*part.selection, m_body, m_state.density, "fix");
    }
  }
}

std::vector<HandlePlace> Session::places(const Step& step) const {
  std::vector<HandlePlace> places;
  for (const Drag& drag : on_grid(step, geometry()).drags)
    places.push_back(place_of(region_of(drag), m_body, m_state));
  return places;
}

void Session::release_and_fix(const Step& request) {
  if (request.release) {
    m_state.anchors.clear();
    m_state.anchor_labels.clear();
    m_state.anchor_selections.clear();
    m_holds = {};
    m_ledger.release();
    forget_shifts();
  }
  const auto add = [](auto& list, const auto& item) {
    if (std::find(list.begin(), list.end(), item) == list.end()) list.push_back(item);
  };
  for (const ChosenPart& part : request.fix) {
    if (const IndexBox* box = part.box()) {
      add(m_state.anchors, *box);
    } else if (part.label != 0) {
      require_label(m_state.labels, part.label, "fix");
      add(m_state.anchor_labels, part.label);
    } else {
      add(m_state.anchor_selections, selection_value(*part.selection));
    }
  }
  if (request.release || !request.fix.empty()) find_anchors();
}

const StepRecord& Session::step(const Step& step, Progress* progress, double time) {
  return placed_at(step, [&]() -> const StepRecord& {
    require_points(step, m_body);
    return take(on_grid(step, geometry(), time), progress);
  });
}

const StepRecord& Session::take(const Step& request, Progress* heard) {
  Listener listener(m_messages, heard);
  StepRecord record;
  static_cast<Step&>(record) = request;
  std::optional<Before> earlier;
  if (m_keeps_undo) earlier = before(record);
  m_pose.reset();
  try {
    run_step(record, &listener);
  } catch (...) {
    m_walk.reset();
    if (earlier) restore(std::move(*earlier));
    throw;
  }
  m_walk.reset();
  FemNodes handed_over;
  if (!m_records.empty()) std::swap(handed_over, m_records.back().equilibrium.nodes);
  if (earlier) {
    earlier->handed_over = std::move(handed_over);
    keep(std::move(*earlier));
  }
  m_records.push_back(std::move(record));
  return m_records.back();
}

const StepRecord& Session::drag(const Region& grabbed, const Vec3d& by_mm, Progress* progress) {
  Step request;
  request.drags.push_back({grabbed, by_mm});
  return step(request, progress);
}

const StepRecord& Session::fix(const IndexBox& box, Progress* progress) {
  Step request;
  request.fix.push_back(box);
  return step(request, progress);
}

const StepRecord& Session::cut(const CutSurface& surface, Progress* progress) {
  Step request;
  request.cuts.push_back(surface);
  return step(request, progress);
}

const StepRecord& Session::relax(const RelaxParams& params, Progress* progress) {
  Step request;
  request.relax = params;
  return step(request, progress);
}

const StepRecord& Session::release(Progress* progress) {
  Step request;
  request.release = true;
  return step(request, progress);
}

std::string Session::journal() const {
  return journal_json(m_state.configuration, m_records);
}

State Session::state() const {
  State state = m_state;
  state.q = m_body.q;
  if (m_body.rigid.empty()) {
    state.cuts = m_body.cuts;
  } else {
    state.pieces = *m_body.rigid.number_of;
    state.piece_records = records_of(m_body.rigid);
  }
  state.rest = m_body.rest;
  state.velocity_mm_s = m_body.velocity_mm_s;
  state.beyond = m_body.beyond;
  state.configuration = journal();
  return state;
}

const Pose& Session::pose(Progress* progress) {
  Listener listener(m_messages, progress);
  if (!m_pose) m_pose = invert_state(state(), &listener);
  return *m_pose;
}

void Session::write_state(const std::string& path, Progress* progress) {
  supple::write_state(path, state(), pose(progress).offsets, progress);
}

void Session::write_warp(const std::string& path, Progress* progress) {
  Listener listener(m_messages, progress);
  WarpOutput output;
  output.path = path;
  output.grid = geometry();
  write_state_warp(output, state(), pose(progress), &listener);
}

}  // namespace supple
