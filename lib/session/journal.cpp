#include "lib/session/journal.h"

#include <nlohmann/json.hpp>

#include "lib/material/material_file.h"
#include "volumes/base/json.h"
#include "volumes/base/version.h"

namespace supple {

namespace {

nlohmann::ordered_json to_json(const Vec3i& voxel) {
  return {voxel.x, voxel.y, voxel.z};
}

nlohmann::ordered_json to_json(const IndexBox& box) {
  return {box.lo.x, box.lo.y, box.lo.z, box.hi.x, box.hi.y, box.hi.z};
}

nlohmann::ordered_json to_json(const Vec3d& v) {
  return {v.x, v.y, v.z};
}

void add_motion(const HandleMotion& motion, nlohmann::ordered_json& json) {
  if (motion.is_shift()) return;
  if (motion.about_lps_mm) json["about_lps_mm"] = to_json(*motion.about_lps_mm);
  if (motion.scale != Vec3d(1)) {
    json[motion.scales_along_grid ? "scale_ijk" : "scale_lps"] = to_json(motion.scale);
  }
  if (motion.angle_deg == 0) return;
  json["axis_lps"] = to_json(motion.axis_lps);
  json["rotate_degrees"] = motion.angle_deg;
}

/// With the voxels themselves, so that the record does not depend on other files.
nlohmann::ordered_json to_json(const Drag& drag) {
  nlohmann::ordered_json json;
  if (drag.selection) {
    json = nlohmann::ordered_json::parse(selection_json(*drag.selection));
  } else if (drag.label != 0) {
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
  add_motion(drag.motion, json);
  json["by_mm"] = to_json(drag.by_mm);
  for (const DragPose& pose : drag.way) {
    nlohmann::ordered_json& on_the_way = json["way"].emplace_back();
    add_motion(pose.motion, on_the_way);
    on_the_way["by_mm"] = to_json(pose.by_mm);
  }
  if (drag.soft_mm > 0) json["soft_mm"] = drag.soft_mm;
  if (drag.kind == HandleKind::push) json["push"] = true;
  if (drag.spares_fixed) json["spare_fixed"] = true;
  if (drag.slides) json["slide"] = true;
  return json;
}

/// The settings of a struct that lists its fields.
template <class Params>
nlohmann::ordered_json recorded(Params params) {
  return nlohmann::ordered_json::parse(json_text(fields_value(fields(params))));
}

nlohmann::ordered_json to_json(const StepRecord& record) {
  nlohmann::ordered_json step;
  for (const Drag& drag : record.drags) {
    step["handles"].push_back(to_json(drag));
  }
  for (const IndexBox& box : record.fix) {
    step["fix"].push_back(to_json(box));
  }
  if (!record.fix_labels.empty()) step["fix_label"] = record.fix_labels;
  for (const Selection& selection : record.fix_selections) {
    step["anchors"].push_back(nlohmann::ordered_json::parse(selection_json(selection)));
  }
  if (record.release) step["release"] = true;
  if (record.shift_pieces) step["shift_pieces"] = true;
  if (record.material) step["material"] = material_to_toml(*record.material);
  if (record.ball) step["limits"] = "ball";
  if (record.tightened) step["limits"] = "tighten";
  for (const CutSurface& surface : record.cuts) {
    step["cut"].push_back(nlohmann::ordered_json::parse(settings_json(surface)));
  }
  if (!record.cuts.empty()) step["cut_links"] = record.cut_links;
  for (const ChosenPart& part : record.remove) {
    step["remove"].push_back(nlohmann::ordered_json::parse(chosen_json(part)));
  }
  for (const Retraction& retraction : record.retract) {
    step["retract"].push_back(nlohmann::ordered_json::parse(settings_json(retraction)));
  }
  step.update(nlohmann::ordered_json::parse(settings_json(record.rigid)));
  if (record.relax) {
    step["relax"] = recorded(*record.relax);
    if (record.relax->bulk_modulus_kpa == 0) step["relax"].erase("bulk_modulus_kpa");
    if (!record.relax->poisson) step["relax"].erase("poisson");
    if (record.relax->budget_million == 0) step["relax"].erase("budget_million");
  }
  if (record.springs) {
    step["springs"] = nlohmann::ordered_json::parse(settings_json(*record.springs));
  }
  if (record.fem) {
    step["fem"] = nlohmann::ordered_json::parse(settings_json(*record.fem));
    step["fem"]["iterations"] = record.equilibrium.report.iterations;
    step["fem"]["residual_max"] = record.equilibrium.report.residual_max;
    step["fem"]["force_balance"] = record.equilibrium.report.force_balance;
    step["fem"]["energy_identity"] = record.equilibrium.report.energy_identity;
  }
  step["fraction"] = std::to_string(record.report.fraction_numerator) + "/" +
                     std::to_string(record.report.fraction_denominator);
  return step;
}

}  // namespace

std::string journal_json(const std::string& earlier, const std::vector<StepRecord>& records) {
  nlohmann::ordered_json steps = nlohmann::ordered_json::array();
  const auto before = nlohmann::ordered_json::parse(earlier, nullptr, false);
  if (before.is_object() && before.contains("steps")) steps = before["steps"];
  for (const StepRecord& record : records) steps.push_back(to_json(record));
  nlohmann::ordered_json json;
  json["program"] = std::string("supple ") + kVersion;
  json["steps"] = steps;
  return json.dump();
}

}  // namespace supple
