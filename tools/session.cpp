#include "tools/session.h"

#include <algorithm>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "lib/model/quasi_static.h"
#include "tools/console/parse.h"
#include "tools/console/read_options.h"
#include "tools/material_file.h"
#include "tools/version.h"
#include "volumes/io/load/label_file.h"
#include "volumes/io/load/load.h"
#include "volumes/io/open_volume.h"

namespace supple::tools {

namespace {

std::string percent(double part) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g %%", 100 * part);
  return text;
}

void warn_of_projection(std::int64_t links, double max_voxels, std::int64_t held,
                        Console& console) {
  if (links == 0) return;
  if (held > 0) {
    console.warn(with_count(held, "held element") +
                 " had to move: links do not reach from one to the other");
  }
  console.warn("the start broke " + with_count(links, "link") +
               "; it was projected, largest move " + std::to_string(max_voxels) + " voxels");
}

void warn_of_report(const EcmReport& report, Console& console) {
  warn_of_projection(report.projected_links, report.projected_max_voxels, report.projected_held,
                     console);
  if (report.fraction_numerator != report.fraction_denominator) {
    console.warn("anchors stopped the drag at " + percent(report.fraction()) + " (" +
                 std::to_string(report.fraction_numerator) + "/" +
                 std::to_string(report.fraction_denominator) + ")");
  }
}

nlohmann::ordered_json to_json(const Vec3i& voxel) {
  return {voxel.x, voxel.y, voxel.z};
}

nlohmann::ordered_json to_json(const IndexBox& box) {
  return {box.lo.x, box.lo.y, box.lo.z, box.hi.x, box.hi.y, box.hi.z};
}

/// With the voxels themselves, so that the record does not depend on other files.
nlohmann::ordered_json to_json(const Drag& drag) {
  nlohmann::ordered_json json;
  if (drag.label != 0) {
    json["grab_label"] = drag.label;
  } else if (const IndexBox* box = drag.region.box()) {
    if (box->lo == box->hi) {
      json["grab"] = to_json(box->lo);
    } else {
      json["grab_box"] = to_json(*box);
    }
  } else {
    json["name"] = drag.region.name();
    if (drag.region.points() != nullptr) {
      for (const Vec3i& voxel : *drag.region.points()) json["voxels"].push_back(to_json(voxel));
    }
  }
  json["by_mm"] = {drag.by_mm.x, drag.by_mm.y, drag.by_mm.z};
  if (drag.kind == HandleKind::push) json["push"] = true;
  return json;
}

nlohmann::ordered_json relax_settings(const RelaxParams& params) {
  nlohmann::ordered_json json = {{"method", name_of(params.method)},
                                 {"passes", params.passes},
                                 {"tolerance_voxels", params.tolerance_voxels}};
  if (params.bulk_modulus_kpa > 0) json["volume_kpa"] = params.bulk_modulus_kpa;
  return json;
}

void warn_of_report(const BallReport& report, Console& console) {
  if (report.violated == 0) return;
  console.warn("ball limits leave " + with_count(report.violated, "link") + " of " +
               std::to_string(report.links) + " violated, by at most " +
               std::to_string(report.worst_excess_voxels) + " voxels" +
               (report.capped ? "; the moves reached their limit" : ""));
}

}  // namespace

std::optional<Limits> limits_of_name(const std::string& name) {
  if (name == "box") return Limits::box;
  if (name == "ball") return Limits::ball;
  if (name == "tighten") return Limits::tighten;
  return std::nullopt;
}

Session::Session(const std::string& path, const ReadOptions& read,
                 const std::optional<MaterialTable>& material, const std::string& labels_path,
                 Console& console) {
  if (material) m_material = *material;
  if (is_state_file(path)) {
    require_unused(read, path);
    m_state = read_state(path, &console);
    if (!material) m_material = parse_material(m_state.material_toml, path + " material");
  } else {
    if (!material) {
      const VolumeStatistics statistics =
          digest_volume(*open_volume(path, read), &console).statistics;
      m_material = homogeneous_material(statistics.min, statistics.max);
      console.warn("no material given: every voxel above " + std::to_string(statistics.min) +
                   " is tissue of one kind (stretch 1.2, compression 0.8, shear 0.3)");
    }
    open_volume_file(path, read, console);
  }
  if (!labels_path.empty()) open_labels(labels_path, console);
  warn_of_material(console);

  console.stage("building the body");
  m_body = make_body(m_state, m_material);
  m_state.material_toml = material_to_toml(m_material);
  m_links = check_links(m_body);
  m_body.links_known_valid = m_links.violated == 0;
  find_anchors();
  m_ecm = std::make_unique<VoxelEcmModel>(held());
  if (!m_links.fold_free) {
    console.note("the material does not rule out folds (min_length > 2 shear fails on some link)");
  }
}

void Session::open_volume_file(const std::string& path, const ReadOptions& read, Console& console) {
  ElementVolume loaded = load_elements(*open_input(path, read, console), m_material.active_lo,
                                       m_material.active_hi, m_material.components, 2, &console);
  if (loaded.volume.statistics.nan_count > 0) {
    console.warn(path + ": " + with_count(loaded.volume.statistics.nan_count, "NaN voxel") +
                 " treated as void");
  }
  m_state.geometry = loaded.volume.geometry;
  m_state.density = std::move(loaded.volume.density);
  m_state.elements = std::move(loaded.elements);
  m_state.source_name = std::filesystem::path(path).filename().string();
  m_state.source_type = loaded.volume.value_type;
}

void Session::open_labels(const std::string& path, Console& console) {
  if (!m_state.anchor_labels.empty()) {
    throw InputError({path, "labels", "labels beside those that fix parts of the state",
                      "a state without fixed labels"});
  }
  m_state.labels =
      read_labels(*open_input(path, {}, console), m_state.geometry, m_state.elements, &console);
  if (m_state.labels.empty()) console.warn(path + ": no element has a label");
}

void Session::warn_of_material(Console& console) const {
  for (const std::string& line : m_material.warnings()) console.warn("material: " + line);
  if (m_material.labels.empty()) return;
  const auto counts = label_counts(m_state.labels);
  for (const auto& [label, table] : m_material.labels) {
    if (counts.count(label) != 0) continue;
    console.warn("material: label." + std::to_string(label) + ": no element has this label");
  }
}

Region Session::region_of_label(std::int32_t label, const std::string& role) const {
  require_label(m_state.labels, label, role);
  return Region::of_mask(
      std::make_shared<BrickTopology>(label_mask(m_state.elements, m_state.labels, label)),
      "label:" + std::to_string(label));
}

void Session::release_and_fix(const StepRequest& request) {
  if (request.release) {
    m_state.anchors.clear();
    m_state.anchor_labels.clear();
    m_holds = {};
    m_grips.release();
  }
  const auto add = [](auto& list, const auto& item) {
    if (std::find(list.begin(), list.end(), item) == list.end()) list.push_back(item);
  };
  for (const IndexBox& box : request.fix) add(m_state.anchors, box);
  for (const std::int32_t label : request.fix_labels) {
    require_label(m_state.labels, label, "fix");
    add(m_state.anchor_labels, label);
  }
  if (request.release || !request.fix.empty() || !request.fix_labels.empty()) find_anchors();
}

std::vector<Handle> Session::handles_of(const std::vector<Drag>& drags) const {
  std::vector<Handle> handles;
  for (const Drag& drag : drags) {
    handles.emplace_back(drag.label != 0 ? region_of_label(drag.label, "grab") : drag.region,
                         fixed_from_mm(drag.by_mm, geometry().spacing_mm()), drag.kind);
  }
  return handles;
}

void Session::find_anchors() {
  m_anchors.assign(m_state.anchors.begin(), m_state.anchors.end());
  for (const std::int32_t label : m_state.anchor_labels) {
    m_anchors.push_back(region_of_label(label, "fix"));
  }
}

const StepRecord& Session::step(const StepRequest& request, Console& console) {
  StepRecord record;
  static_cast<StepRequest&>(record) = request;
  release_and_fix(request);
  const std::vector<Handle> handles = handles_of(request.drags);
  record.cut_links = apply_cuts(m_body, m_state.labels, request.cuts, console);
  m_links.fold_free = m_links.fold_free && m_body.cuts.empty();
  HandleLedger grips = m_grips;
  grips.add(int(m_records.size()) + 1, handles, m_body);
  if (request.springs) {
    const std::vector<SlotSet> told = request.forces ? grips.elements() : std::vector<SlotSet>();
    record.sprung = move_by_springs(*request.springs, held(), handles, told, console);
    if (request.forces) record.pulls = grips.forces(record.sprung.reactions);
    m_pressure_kpa = 0;
  } else {
    move_quasi_statically(handles, record, console);
    if (request.forces) {
      record.pulls = grips.forces(quasi_static_reactions(held(), grips.elements(), m_pressure_kpa));
    }
  }
  m_grips = std::move(grips);
  m_records.push_back(std::move(record));
  return m_records.back();
}

void Session::move_quasi_statically(const std::vector<Handle>& handles, StepRecord& record,
                                    Console& console) {
  console.stage("solving");
  solve(handles, record, console);
  if (!handles.empty() || record.release) m_pressure_kpa = 0;
  console.debug(std::string("solve: ") + (record.ball ? "ball" : name_of(record.report.engine)) +
                " engine, " + std::to_string(record.report.visited) + " visits, longest queue " +
                std::to_string(record.report.max_queue) + ", body " +
                std::to_string(m_body.bytes() >> 20) + " MiB");
  if (record.relax) relax_body(record, console);
  if (record.limits == Limits::tighten) tighten_body(record, console);
}

void Session::solve(const std::vector<Handle>& handles, StepRecord& record, Console& console) {
  if (record.limits != Limits::ball) {
    m_ecm->move(handles, 1, &console);
    record.report = m_ecm->report();
    warn_of_report(record.report, console);
    return;
  }
  record.ball = drag_ball(m_body, handles, m_anchors, m_holds, BallParams(), &console);
  m_links.fold_free = false;
  record.report.moved = record.ball->moved;
  record.report.visited = record.ball->moves;
  record.report.max_queue = record.ball->max_queue;
  record.report.milliseconds = record.ball->milliseconds;
  warn_of_report(*record.ball, console);
}

void Session::relax_body(StepRecord& record, Console& console) {
  console.stage("relaxing");
  m_pressure_kpa = record.relax->bulk_modulus_kpa;
  RelaxModel model(held(), *record.relax);
  run_model(model, record.relax->passes, &console);
  record.relaxed = model.report();
  const RelaxReport& report = record.relaxed;
  warn_of_projection(report.projected_links, report.projected_max_voxels, report.projected_held,
                     console);
  const LinkCheck check =
      record.relax->method == RelaxMethod::plain ? check_links(m_body) : LinkCheck();
  if (check.violated > 0) {
    console.warn("plain relaxation broke " + with_count(check.violated, "link") + " of " +
                 std::to_string(check.links) + ", by at most " +
                 std::to_string(check.worst_excess_voxels) + " voxels");
  }
}

void Session::tighten_body(StepRecord& record, Console& console) {
  console.stage("tightening");
  record.tightened = tighten(m_body, m_anchors, m_holds, TightenParams(), &console);
  const TightenReport& report = *record.tightened;
  warn_of_projection(report.projected_links, report.projected_max_voxels, report.projected_held,
                     console);
  if (report.violated == 0) return;
  console.note("tightened limits leave " + with_count(report.violated, "link") + " of " +
               std::to_string(report.links) + " violated, by at most " +
               std::to_string(report.worst_excess_voxels) +
               " voxels; the material's own limits hold");
}

std::string Session::configuration() const {
  nlohmann::ordered_json steps = nlohmann::ordered_json::array();
  if (!m_state.configuration.empty()) {
    const auto earlier = nlohmann::ordered_json::parse(m_state.configuration, nullptr, false);
    if (earlier.is_object() && earlier.contains("steps")) steps = earlier["steps"];
  }
  for (const StepRecord& record : m_records) {
    nlohmann::ordered_json step;
    for (const Drag& drag : record.drags) {
      step["handles"].push_back(to_json(drag));
    }
    for (const IndexBox& box : record.fix) {
      step["fix"].push_back(to_json(box));
    }
    if (!record.fix_labels.empty()) step["fix_label"] = record.fix_labels;
    if (record.release) step["release"] = true;
    if (record.ball) step["limits"] = "ball";
    if (record.tightened) step["limits"] = "tighten";
    for (const CutSurface& surface : record.cuts) step["cut"].push_back(to_json(surface));
    if (!record.cuts.empty()) step["cut_links"] = record.cut_links;
    if (record.relax) step["relax"] = relax_settings(*record.relax);
    if (record.springs) step["springs"] = settings_json(*record.springs);
    step["fraction"] = std::to_string(record.report.fraction_numerator) + "/" +
                       std::to_string(record.report.fraction_denominator);
    steps.push_back(step);
  }
  nlohmann::ordered_json json;
  json["program"] = std::string("supple ") + kVersion;
  json["steps"] = steps;
  return json.dump();
}

State Session::state() const {
  State state = m_state;
  state.q = m_body.q;
  state.cuts = m_body.cuts;
  state.rest = m_body.rest;
  state.velocity_mm_s = m_body.velocity_mm_s;
  state.configuration = configuration();
  return state;
}

}  // namespace supple::tools
