#include "lib/session/file/step_keys.h"

#include "lib/material/material.h"
#include "lib/session/file/cut_keys.h"
#include "lib/session/file/handle_keys.h"
#include "lib/session/retraction.h"
#include "lib/session/step_model.h"

namespace supple {

namespace {

/// Refuses the table of a model that does not move the body.
void require_no_table(Table& table, const std::string& name) {
  auto own = table.table(name);
  if (!own) return;
  const std::vector<std::string> keys = own->keys();
  own->fail(keys.empty() ? "" : keys.front(), name + " without its model",
            "model = \"" + name + '"');
}

RelaxParams read_relax(Table& table) {
  RelaxParams params;
  table.read(fields(params));
  if (params.bulk_modulus_kpa > 0 && params.poisson) {
    table.fail("poisson", "poisson beside bulk_modulus", "one of them");
  }
  if (params.conserves_volume() && !conserves_volume(params.method)) {
    table.fail(params.poisson ? "poisson" : "bulk_modulus",
               std::string("method \"") + name_of(params.method) + "\"",
               "method \"red-black\" or \"accelerated\"");
  }
  table.finish();
  return params;
}

/// Reads the removed and the rigid parts.
void read_parts(Table& table, const LabelNames& names, Step& step) {
  for (Table& part : table.table_or_tables("remove")) {
    step.remove.push_back(read_part(part, names));
    part.finish();
  }
  for (Table& part : table.table_or_tables("rigid")) {
    step.rigid.parts.push_back(read_part(part, names));
    part.finish();
  }
  const auto seeds = table.rows("rigid_seeds", {3}, "a list of voxels [i, j, k]");
  for (std::size_t n = 0; seeds && n < seeds->size(); ++n) {
    step.rigid.seeds.push_back(to_box(table, "rigid_seeds", (*seeds)[n]).lo);
  }
}

Retraction read_retraction(Table& table) {
  Retraction retraction;
  retraction.place = table.place();
  table.read(fields(retraction));
  require_area(table, retraction.edge1, retraction.edge2);
  table.finish();
  return retraction;
}

Field model_field(StepKeys& keys) {
  const std::deque<StepModel>& models = step_models();
  std::vector<std::string> names;
  std::string help = "What moves the body: ";
  for (std::size_t n = 0; n < models.size(); ++n) {
    const bool is_last = n + 1 == models.size();
    names.push_back(models[n].name);
    help += (n == 0 ? "" : is_last ? ", or " : ", ") + models[n].title;
  }
  help += " (docs/models)";
  return {"model", keys.model, std::move(names), help.c_str()};
}

}  // namespace

Fields fields(Step& step, StepKeys& keys) {
  return {
      model_field(keys),
      Field("body", step.body, "The mesh body that the step moves")
          .otherwise("the voxels")
          .only_in_scenes(),
      Field("limits", step.limits, {"box", "ball", "tighten"},
            "box: each component of a link; ball: its length, order-dependent; tighten: box, and "
            "narrower across stretched links"),
      Field("fix_density", keys.fix_density, "Elements of these densities stay where they are"),
      Field("rigid_density", step.rigid.density,
            "Connected parts of these densities move as rigid pieces"),
      Field("joint", step.rigid.joint_mm, "Part the tissue between pieces that are so near")
          .unit("mm")
          .at_least(0),
      Field("no_relax", step.no_relax, "Leave drags unrelaxed, whatever the material asks for"),
      Field("shift_pieces", step.shift_pieces,
            "Rigid pieces that nothing holds only shift with these drags, which is found sooner; "
            "they turn in the next step of ECM without it")
          .only_in_scenes(),
      Field("turn_pieces", step.turn_pieces, "Turn them now, with nothing else in the step")
          .only_in_scenes(),
      Field("release", step.release, "Let go of everything that is held or fixed"),
  };
}

void read_model(Table& table, const LabelNames& names, int chosen, Step& step) {
  const std::deque<StepModel>& models = step_models();
  for (std::size_t n = 1; n < models.size(); ++n) {
    const StepModel& model = models[n];
    if (int(n) != chosen) {
      require_no_table(table, model.name);
      continue;
    }
    auto own = table.table(model.name);
    for (const char* key : {"relax", "limits"}) {
      if (!table.has(key)) continue;
      table.fail(key, std::string(key) + " beside " + model.name, "a step of its own for it");
    }
    model.choose(step);
    if (!own) continue;
    if (model.read) {
      model.read(*own, names, step);
    } else {
      own->read(model.fields(step));
      own->finish();
    }
  }
}

MaterialTable read_material_choice(Table& table, const LabelNames& names, std::string* path) {
  const auto file = table.path("table");
  if (!file) return read_material_table(table, names);
  table.finish();
  if (path != nullptr) *path = *file;
  return read_material(*file, names);
}

Step read_step(Table& table, const LabelNames& names) {
  Step step;
  step.place = table.place();
  for (Table& handle : table.tables("handles")) {
    step.drags.push_back(read_handle(handle, names));
    handle.finish();
  }
  const bool is_short = has_handle(table);
  if (is_short && !step.drags.empty()) {
    table.fail("grab", "grab beside handles", "either the short form or handles");
  }
  const auto rows = table.rows("fix", {3, 6}, "a list of [i, j, k] or [i0, j0, k0, i1, j1, k1]");
  if (rows) {
    for (const auto& row : *rows) step.fix.push_back(to_box(table, "fix", row));
  }
  for (const std::string& path : table.paths("fix_points")) {
    step.fix.emplace_back().placed.emplace().points = read_point_file(path);
  }
  for (const std::int32_t label : read_labels(table, "fix_label", names)) {
    step.fix.emplace_back().label = label;
  }
  for (Table& anchor : table.table_or_tables("anchors")) {
    step.fix.emplace_back().placed = read_anchor(anchor, names);
    anchor.finish();
  }
  read_parts(table, names, step);
  StepKeys keys;
  table.read(fields(step, keys));
  if (keys.fix_density) {
    PlacedSelection& bone = step.fix.emplace_back().placed.emplace();
    bone.place = table.place("fix_density");
    bone.density = keys.fix_density;
    bone.keys = {{"grab_density", {bone.density->first, bone.density->second}}};
  }
  if (step.rigid.joint_mm > 0 && step.rigid.parts.empty() && step.rigid.seeds.empty()) {
    table.fail("joint", "no rigid or rigid_seeds beside it", "pieces that the joint is around");
  }
  if (step.shift_pieces && step.turn_pieces) {
    table.fail("turn_pieces", "turn_pieces beside shift_pieces", "one of them");
  }
  read_model(table, names, keys.model, step);
  for (Table& cut : table.tables("cut")) step.cuts.push_back(read_cut(cut, names));
  for (Table& patch : table.table_or_tables("retract")) {
    step.retract.push_back(read_retraction(patch));
  }
  if (auto relax = table.table("relax")) {
    if (step.no_relax) table.fail("no_relax", "no_relax beside relax", "one of them");
    step.relax = read_relax(*relax);
  }
  if (auto material = table.table("material")) {
    step.material = read_material_choice(*material, names);
  }
  table.finish();
  if (is_short) step.drags.push_back(read_handle(table, names));
  step.keys = table.written();
  if (step.does_nothing()) {
    table.fail("", "a step that does nothing",
               "grab, handles, fix, fix_label, fix_points, cut, remove, rigid, retract, relax, "
               "model, material, release, turn_pieces "
               "or limits");
  }
  return step;
}

}  // namespace supple
