#include "lib/session/tet_step.h"

#include "lib/session/tet_record.h"

namespace supple {

Fields fields(TetOpening& opening) {
  return {
      Field("name", opening.name, "By which sheets and results name the opening").required(),
      Field("toward", opening.toward, "Direction in LPS in which the mesh's centroid sees it"),
      Field("degrees", opening.degrees, "Largest angle of its faces to that direction")
          .unit("degrees")
          .range(0, 180),
  };
}

Fields fields(TetSheet& sheet) {
  ElasticSheet& of = sheet.sheet;
  return {
      Field("faces", of.faces, "An opening, or outside: all other outer faces"),
      Field("kind", of.kind, {"stretch", "bending", "both"}, "What it resists"),
      Field("stiffness", of.young_kpa, "Young's modulus")
          .unit("kPa")
          .positive()
          .required()
          .recorded_as("stiffness_kpa"),
      Field("poisson", of.poisson, "Poisson's ratio").range(0, 0.5),
      Field("thickness", of.thickness_mm, "Thickness")
          .unit("mm")
          .positive()
          .required()
          .recorded_as("thickness_mm"),
  };
}

Fields fields(TetStep& step) {
  Fields all = {
      Field("mesh", step.mesh, "A mesh of tetrahedra in LPS mm: .vtu or .inp")
          .shown_as("FILE")
          .otherwise("made of the body")
          .path(),
  };
  for (const Field& field : fields(step.solid)) all.push_back(field);
  const Fields more = {
      Field("bins", step.bins, "At most so many materials, in steps of equal ratio")
          .range(1, 10000),
      Field("labels", step.has_labels, "Labels are regions of the mesh, with borders between them"),
      Field("element", step.element, {"linear", "nodal_pressure", "quadratic"},
            "linear locks as Poisson's ratio nears 1/2; quadratic has ten nodes"),
      Field("equations", step.equations, {"gradients", "factor"},
            "Solved by conjugate gradients, or by exact factors"),
      Field("outside", step.outside, {"free", "held", "shell"},
            "Outer faces in no opening: held, or kept inside where they rest"),
      Field("shell_planes", step.has_planes,
            "Each node keeps behind the plane at its place in the shell: for large slides"),
      Field("free_rims", step.frees_rims, "Rims of openings may pass the shell"),
      Field("clamped", step.clamps, "Sheets do not turn along edges between held nodes"),
  };
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

Value settings_value(const TetStep& step) {
  TetStep copy = step;
  Value value = fields_value(fields(copy));
  for (TetOpening& opening : copy.openings) {
    Value row = opening.part ? chosen_value(*opening.part) : Value::Entries();
    row.update(fields_value(fields(opening)));
    if (opening.part) row.erase("degrees");
    value["openings"].push_back(std::move(row));
  }
  for (TetSheet& sheet : copy.sheets) {
    Value row = fields_value(fields(sheet));
    if (sheet.between) {
      row.erase("faces");
      row["between"] = {sheet.between->first, sheet.between->second};
    }
    value["sheets"].push_back(std::move(row));
  }
  return value;
}

std::optional<Problem> contradiction(const TetStep& step, StrainTheory strain) {
  const bool is_shell = step.outside == TetOutside::shell;
  if (strain == StrainTheory::finite && (is_shell || step.equations == TetEquations::factor)) {
    return Problem{"", "strain", is_shell ? "finite beside a shell" : "finite beside factor",
                   "linear"};
  }
  if ((step.frees_rims || step.has_planes) && !is_shell) {
    return Problem{"", step.frees_rims ? "free_rims" : "shell_planes", "no shell",
                   "outside = \"shell\""};
  }
  if (is_shell && step.equations == TetEquations::factor) {
    return Problem{"", "equations", "factor beside a shell", "gradients"};
  }
  for (const TetSheet& sheet : step.sheets) {
    if (sheet.between && !step.has_labels) {
      return Problem{"", "sheets", "a sheet between labels of a mesh without", "labels = true"};
    }
  }
  return std::nullopt;
}

namespace {

Value to_value(const TetOpeningRecord& opening) {
  Value row = {{"name", opening.name},
               {"area_mm2", opening.area_mm2},
               {"bulge_mm", opening.bulge_mm},
               {"out_ml", opening.out_ml}};
  if (opening.free_area_mm2) row["free_area_mm2"] = *opening.free_area_mm2;
  return row;
}

Value to_value(const ShellContactReport& shell) {
  return {{"rounds", shell.rounds},
          {"nodes", shell.nodes},
          {"pressing", shell.pressing},
          {"deepest_mm", shell.deepest_mm},
          {"pressed_area_mm2", shell.pressed_area_mm2},
          {"largest_pressure_kpa", shell.largest_pressure_kpa},
          {"force_n", shell.force_n},
          {"force_balance", shell.force_balance}};
}

}  // namespace

Value to_value(const TetRecord& record) {
  Value json = {{"tetrahedra", record.tetrahedra},
                {"nodes", record.nodes},
                {"outer_faces", record.outer_faces},
                {"mesh_ml", record.mesh_ml},
                {"voxels_ml", record.voxels_ml},
                {"least_dihedral_deg", record.least_dihedral_deg},
                {"largest_dihedral_deg", record.largest_dihedral_deg},
                {"unmeshed_voxels", record.unmeshed},
                {"far_voxels", record.far},
                {"mean_pressure_kpa", record.mean_pressure_kpa}};
  for (const TetOpeningRecord& opening : record.openings) {
    json["openings"].push_back(to_value(opening));
  }
  if (record.shell) json["shell"] = to_value(*record.shell);
  if (record.outside) json["outside_force_n"] = record.outside->force_n;
  return json;
}

}  // namespace supple
