#include "lib/session/session.h"

#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include "lib/material/material_file.h"
#include "lib/model/quasi_static.h"
#include "lib/session/drag_handles.h"
#include "lib/session/journal.h"
#include "lib/session/step_warnings.h"
#include "lib/session/tissue.h"
#include "volumes/base/text.h"
#include "volumes/io/load/label_file.h"
#include "volumes/io/load/load.h"
#include "volumes/io/open_volume.h"
#include "volumes/state/state_outputs.h"

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

struct Session::Before {
  std::array<BrickValues, 3> q;
  std::array<BrickArray<std::int16_t>, 3> fraction;
  LinkCuts cuts;
  RestStretch rest;
  Velocities velocity_mm_s;
  bool links_known_valid;
  LinkCheck links;
  std::vector<IndexBox> anchors;
  std::vector<std::int32_t> anchor_labels;
  std::vector<std::string> anchor_selections;
  Holds holds;
  HandleLedger ledger;
  double pressure_kpa;
};

Session::Before Session::before() const {
  return {m_body.q,
          m_body.fraction,
          m_body.cuts,
          m_body.rest,
          m_body.velocity_mm_s,
          m_body.links_known_valid,
          m_links,
          m_state.anchors,
          m_state.anchor_labels,
          m_state.anchor_selections,
          m_holds,
          m_ledger,
          m_pressure_kpa};
}

void Session::restore(Before&& before) {
  m_body.q = std::move(before.q);
  m_body.fraction = std::move(before.fraction);
  m_body.cuts = std::move(before.cuts);
  m_body.rest = std::move(before.rest);
  m_body.velocity_mm_s = std::move(before.velocity_mm_s);
  m_body.links_known_valid = before.links_known_valid;
  m_links = before.links;
  m_state.anchors = std::move(before.anchors);
  m_state.anchor_labels = std::move(before.anchor_labels);
  m_state.anchor_selections = std::move(before.anchor_selections);
  m_holds = std::move(before.holds);
  m_ledger = std::move(before.ledger);
  m_pressure_kpa = before.pressure_kpa;
  find_anchors();
}

Session::Session(const std::string& path, const SessionOptions& options, Progress* heard)
    : m_keeps_undo(options.keeps_undo) {
  Listener listener(m_messages, heard);
  Progress* progress = &listener;
  if (options.material) m_material = *options.material;
  if (is_state_file(path)) {
    require_unused(options.read, path);
    m_state = read_state(path, progress);
    if (!options.material) {
      m_material = parse_material(m_state.material_toml, path + " material");
    }
  } else {
    if (!options.material || m_material.fits_domain) choose_material(path, options, progress);
    open_volume_file(path, options.read, progress);
  }
  if (!options.labels_path.empty()) open_labels(options.labels_path, progress);
  warn_of_material(progress);

  stage(progress, "building the body");
  m_body = make_body(m_state, m_material);
  m_state.material_toml = material_to_toml(m_material);
  m_links = check_links(m_body);
  m_body.links_known_valid = m_links.violated == 0;
  find_anchors();
  m_ecm = std::make_unique<VoxelEcmModel>(held());
  if (!m_links.fold_free) {
    note(progress,
         "the material does not rule out folds (min_length > 2 shear fails on some link)");
  }
}

Session::~Session() = default;

/// By the densities of the volume: one tissue where no material is given, the domain of a preset.
void Session::choose_material(const std::string& path, const SessionOptions& options,
                              Progress* progress) {
  const VolumeStatistics statistics =
      digest_volume(*open_volume(path, options.read), progress).statistics;
  if (options.material) {
    const bool fits_active = m_material.fits_active;
    m_material = fitted_to(m_material, statistics);
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

void Session::open_volume_file(const std::string& path, const ReadOptions& read,
                               Progress* progress) {
  std::vector<CountedRange> counted = tissue_ranges(m_material);
  ElementVolume loaded =
      load_elements(*open_volume(path, read, progress), m_material.active_lo, m_material.active_hi,
                    m_material.components, 2, progress, &counted);
  const std::string void_values = void_values_text(loaded.volume.statistics);
  if (!void_values.empty()) warn(progress, path + ": " + void_values + " treated as void");
  const std::string missed = warning_of_domain(m_material, loaded.volume, counted);
  if (!missed.empty()) warn(progress, "material: " + missed);
  m_state.geometry = loaded.volume.geometry;
  m_state.density = std::move(loaded.volume.density);
  m_state.elements = std::move(loaded.elements);
  m_source = {path, read};
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
  if (drag.selection) return supple::region_of(*drag.selection, m_body, m_state.density, "grab");
  return drag.label != 0 ? region_of_label(drag.label, "grab") : drag.region;
}

void Session::check(const StepRequest& request) const {
  for (const Drag& drag : request.drags) {
    const Region region = region_of(drag);
    require_element(region, "grab", m_body, m_state, m_source);
    elements_of(m_body, region, "grab");
  }
  for (const IndexBox& box : request.fix) {
    require_element(box, "fix", m_body, m_state, m_source);
    elements_of(m_body, box, "fix");
  }
  for (const std::int32_t label : request.fix_labels) require_label(m_state.labels, label, "fix");
  for (const Selection& selection : request.fix_selections) {
    supple::region_of(selection, m_body, m_state.density, "fix");
  }
}

std::vector<HandlePlace> Session::places(const std::vector<Drag>& drags) const {
  std::vector<HandlePlace> places;
  for (const Drag& drag : drags) places.push_back(place_of(region_of(drag), m_body, m_state));
  return places;
}

void Session::release_and_fix(const StepRequest& request) {
  if (request.release) {
    m_state.anchors.clear();
    m_state.anchor_labels.clear();
    m_state.anchor_selections.clear();
    m_holds = {};
    m_ledger.release();
  }
  const auto add = [](auto& list, const auto& item) {
    if (std::find(list.begin(), list.end(), item) == list.end()) list.push_back(item);
  };
  for (const IndexBox& box : request.fix) add(m_state.anchors, box);
  for (const std::int32_t label : request.fix_labels) {
    require_label(m_state.labels, label, "fix");
    add(m_state.anchor_labels, label);
  }
  for (const Selection& selection : request.fix_selections) {
    add(m_state.anchor_selections, selection_json(selection));
  }
  if (request.release || !request.fix.empty() || !request.fix_labels.empty() ||
      !request.fix_selections.empty()) {
    find_anchors();
  }
}

std::vector<Handle> Session::handles_of(const StepRequest& request) const {
  std::vector<Region> regions;
  bool has_edges = false;
  for (const Drag& drag : request.drags) {
    regions.push_back(region_of(drag));
    has_edges = has_edges || drag.soft_mm > 0;
  }
  const bool is_pushed = !request.springs && request.limits != Limits::ball;
  return supple::handles_of(request.drags, regions,
                            {m_body, m_state.density,
                             has_edges ? anchored_elements(m_body, m_anchors, m_holds) : SlotSet(),
                             is_pushed ? HandleKind::push : HandleKind::two_sided});
}

void Session::find_anchors() {
  m_anchors.assign(m_state.anchors.begin(), m_state.anchors.end());
  for (const std::int32_t label : m_state.anchor_labels) {
    m_anchors.push_back(region_of_label(label, "fix"));
  }
  for (const std::string& text : m_state.anchor_selections) {
    m_anchors.push_back(
        supple::region_of(selection_from_json(text, "state"), m_body, m_state.density, "fix"));
  }
}

const StepRecord& Session::step(const StepRequest& request, Progress* heard) {
  Listener listener(m_messages, heard);
  StepRecord record;
  static_cast<StepRequest&>(record) = request;
  std::optional<Before> earlier;
  if (m_keeps_undo) earlier = before();
  m_pose.reset();
  try {
    run_step(record, &listener);
  } catch (...) {
    if (earlier) restore(std::move(*earlier));
    throw;
  }
  if (earlier) m_undo.push_back(std::move(*earlier));
  m_records.push_back(std::move(record));
  return m_records.back();
}

void Session::run_step(StepRecord& record, Progress* progress) {
  check(record);
  if (is_relaxed_by_default(record)) record.relax = tissue_relaxation();
  release_and_fix(record);
  const std::vector<Handle> handles = handles_of(record);
  record.cut_links = apply_cuts(m_body, m_state.labels, record.cuts, progress);
  m_links.fold_free = m_links.fold_free && m_body.cuts.empty();
  HandleLedger ledger = m_ledger;
  ledger.add(int(m_records.size()) + 1, handles, m_body);
  if (record.springs) {
    const std::vector<SlotSet> told =
        record.tells_reactions ? ledger.elements() : std::vector<SlotSet>();
    record.sprung = move_by_springs(*record.springs, held(), handles, told, progress);
    if (record.tells_reactions) record.reactions = ledger.name(record.sprung.reactions);
    m_pressure_kpa = 0;
  } else {
    move_quasi_statically(handles, record, progress);
    if (record.tells_reactions) {
      record.reactions =
          ledger.name(quasi_static_reactions(held(), ledger.elements(), m_pressure_kpa));
    }
  }
  m_ledger = std::move(ledger);
}

const StepRecord& Session::drag(const Region& grabbed, const Vec3d& by_mm, Progress* progress) {
  StepRequest request;
  request.drags.push_back({grabbed, by_mm});
  return step(request, progress);
}

const StepRecord& Session::fix(const IndexBox& box, Progress* progress) {
  StepRequest request;
  request.fix.push_back(box);
  return step(request, progress);
}

const StepRecord& Session::cut(const CutSurface& surface, Progress* progress) {
  StepRequest request;
  request.cuts.push_back(surface);
  return step(request, progress);
}

const StepRecord& Session::relax(const RelaxParams& params, Progress* progress) {
  StepRequest request;
  request.relax = params;
  return step(request, progress);
}

const StepRecord& Session::release(Progress* progress) {
  StepRequest request;
  request.release = true;
  return step(request, progress);
}

bool Session::undo() {
  if (!m_keeps_undo)
    throw std::logic_error("undo() of a session without SessionOptions::keeps_undo");
  if (m_undo.empty()) return false;
  restore(std::move(m_undo.back()));
  m_undo.pop_back();
  m_records.pop_back();
  m_pose.reset();
  return true;
}

void Session::move_quasi_statically(const std::vector<Handle>& handles, StepRecord& record,
                                    Progress* progress) {
  stage(progress, "solving");
  solve(handles, record, progress);
  if (!handles.empty() || record.release) m_pressure_kpa = 0;
  debug(progress, std::string("solve: ") + (record.ball ? "ball" : name_of(record.report.engine)) +
                      " engine, " + std::to_string(record.report.visited) +
                      " visits, longest queue " + std::to_string(record.report.max_queue) +
                      ", body " + std::to_string(m_body.bytes() >> 20) + " MiB");
  if (record.relax) relax_body(record, progress);
  if (record.limits == Limits::tighten) tighten_body(record, progress);
}

void Session::solve(const std::vector<Handle>& handles, StepRecord& record, Progress* progress) {
  if (record.limits != Limits::ball) {
    m_ecm->move(handles, 1, progress);
    record.report = m_ecm->report();
    warn_of_report(record.report, progress);
    return;
  }
  record.ball = drag_ball(m_body, handles, m_anchors, m_holds, BallParams(), progress);
  m_links.fold_free = false;
  record.report.moved = record.ball->moved;
  record.report.visited = record.ball->moves;
  record.report.max_queue = record.ball->max_queue;
  record.report.milliseconds = record.ball->milliseconds;
  warn_of_report(*record.ball, progress);
}

bool Session::is_relaxed_by_default(const StepRequest& request) const {
  return m_material.relaxes && !request.no_relax && !request.relax && !request.drags.empty() &&
         !request.springs && request.limits != Limits::ball;
}

void Session::relax_body(StepRecord& record, Progress* progress) {
  stage(progress, "relaxing");
  m_pressure_kpa = record.relax->bulk_modulus_kpa;
  RelaxModel model(held(), *record.relax);
  run_model(model, record.relax->passes, progress);
  record.relaxed = model.report();
  const LinkCheck check =
      record.relax->method == RelaxMethod::plain ? check_links(m_body) : LinkCheck();
  warn_of_report(record.relaxed, check, progress);
}

void Session::tighten_body(StepRecord& record, Progress* progress) {
  stage(progress, "tightening");
  record.tightened = tighten(m_body, m_anchors, m_holds, TightenParams(), progress);
  warn_of_report(*record.tightened, progress);
}

std::string Session::journal() const {
  return journal_json(m_state.configuration, m_records);
}

State Session::state() const {
  State state = m_state;
  state.q = m_body.q;
  state.cuts = m_body.cuts;
  state.rest = m_body.rest;
  state.velocity_mm_s = m_body.velocity_mm_s;
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
