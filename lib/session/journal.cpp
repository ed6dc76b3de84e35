#include "lib/session/journal.h"

#include "lib/material/material.h"
#include "lib/session/cut_surface.h"
#include "lib/session/mesh_step.h"
#include "lib/session/retraction.h"
#include "lib/session/rigid_request.h"
#include "lib/session/spring_step.h"
#include "lib/session/step_model.h"
#include "volumes/base/json.h"
#include "volumes/base/version.h"

namespace supple {

namespace {

void add_motion(const HandleMotion& motion, Value& value) {
  if (motion.is_shift()) return;
  if (motion.about_lps_mm) value["about_lps_mm"] = *motion.about_lps_mm;
  if (motion.scale != Vec3d(1)) {
    value[motion.scales_along_grid ? "scale_ijk" : "scale_lps"] = motion.scale;
  }
  if (motion.angle_deg == 0) return;
  value["axis_lps"] = motion.axis_lps;
  value["rotate_degrees"] = motion.angle_deg;
}

/// Records the voxels themselves, so that the record does not depend on other files.
Value to_value(const Drag& drag) {
  Value value;
  if (drag.selection) {
    value = selection_value(*drag.selection);
  } else if (drag.label != 0) {
    value["grab_label"] = drag.label;
  } else if (const IndexBox* box = drag.region.box()) {
    if (box->lo == box->hi) {
      value["grab"] = box->lo;
    } else {
      value["grab_box"] = *box;
    }
  } else {
    value["name"] = drag.region.name();
    if (drag.region.points() != nullptr) value["voxels"] = *drag.region.points();
  }
  add_motion(drag.motion, value);
  value["by_mm"] = drag.by_mm;
  for (const DragPose& pose : drag.way) {
    Value& on_the_way = value["way"].push_back({});
    add_motion(pose.motion, on_the_way);
    on_the_way["by_mm"] = pose.by_mm;
  }
  if (drag.soft_mm > 0) value["soft_mm"] = drag.soft_mm;
  if (drag.pushes) value["push"] = true;
  if (drag.spares_fixed) value["spare_fixed"] = true;
  if (drag.slides) value["slide"] = true;
  return value;
}

/// Boxes, labels and other selections are lists of their own.
void add_anchors(const std::vector<ChosenPart>& anchors, Value& step) {
  Value boxes, labels, selections;
  for (const ChosenPart& part : anchors) {
    if (part.label != 0) {
      labels.push_back(part.label);
    } else if (const IndexBox* box = part.box()) {
      boxes.push_back(*box);
    } else {
      selections.push_back(selection_value(*part.selection));
    }
  }
  for (const auto& [key, list] : {std::pair("fix", &boxes), std::pair("fix_label", &labels),
                                  std::pair("anchors", &selections)}) {
    if (!list->empty()) step[key] = *list;
  }
}

/// The settings of a struct that lists its fields.
template <class Params>
Value recorded(Params params) {
  return fields_value(fields(params));
}

Value to_value(const StepRecord& record) {
  if (record.mesh) return to_value(*record.mesh, record);
  Value step;
  for (const Drag& drag : record.drags) step["handles"].push_back(to_value(drag));
  add_anchors(record.fix, step);
  if (record.release) step["release"] = true;
  if (record.shift_pieces) step["shift_pieces"] = true;
  if (record.material) step["material"] = material_to_toml(*record.material);
  if (record.ball) step["limits"] = "ball";
  if (record.tightened) step["limits"] = "tighten";
  for (const CutSurface& surface : record.cuts) {
    step["cut"].push_back(settings_value(surface));
  }
  if (!record.cuts.empty()) step["cut_links"] = record.cut_links;
  for (const ChosenPart& part : record.remove) {
    step["remove"].push_back(chosen_value(part));
  }
  for (const Retraction& retraction : record.retract) {
    step["retract"].push_back(settings_value(retraction));
  }
  step.update(settings_value(record.rigid));
  if (record.relax) {
    step["relax"] = recorded(*record.relax);
    if (record.relax->bulk_modulus_kpa == 0) step["relax"].erase("bulk_modulus_kpa");
    if (!record.relax->poisson) step["relax"].erase("poisson");
    if (record.relax->budget_million == 0) step["relax"].erase("budget_million");
    if (record.relax->still_voxels == 0) step["relax"].erase("still_voxels");
  }
  const StepModel& model = model_of(record);
  if (model.settings) step[model.name] = model.settings(record);
  step["fraction"] = std::to_string(record.report.fraction_numerator) + "/" +
                     std::to_string(record.report.fraction_denominator);
  return step;
}

}  // namespace

std::string journal_json(const std::string& earlier, const std::vector<StepRecord>& records) {
  Value steps = Value::List();
  const Value before = json_or_null(earlier);
  if (before.contains("steps")) steps = before["steps"];
  for (const StepRecord& record : records) steps.push_back(to_value(record));
  return json_text({{"program", std::string("supple ") + kVersion}, {"steps", steps}});
}

}  // namespace supple
