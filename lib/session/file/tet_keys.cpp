#include "lib/session/file/tet_keys.h"

#include <algorithm>

#include "lib/session/file/fem_keys.h"
#include "lib/session/file/handle_keys.h"
#include "lib/session/tet_step.h"

namespace supple {

namespace {

/// Reads a direction with its angle, or a part of the body.
TetOpening read_opening(Table& table, const LabelNames& names) {
  TetOpening opening;
  if (!table.has("toward")) {
    opening.part = read_part(table, names);
    table.read(fields(opening));
    if (table.has("degrees")) table.fail("degrees", "degrees without toward", "both of them");
    table.finish();
    return opening;
  }
  table.read(fields(opening));
  if (*opening.toward == Vec3d(0)) table.fail("toward", "[0, 0, 0]", "a direction");
  if (!table.has("degrees")) table.fail_missing("degrees", "an angle in degrees");
  table.finish();
  return opening;
}

TetSheet read_sheet(Table& table, const LabelNames& names) {
  TetSheet sheet;
  const std::vector<std::int32_t> labels = read_labels(table, "between", names);
  table.read(fields(sheet));
  if (labels.empty()) {
    if (sheet.sheet.faces.empty()) table.fail_missing("faces", "an opening, outside, or between");
  } else if (labels.size() != 2 || labels[0] == labels[1]) {
    table.fail("between", std::to_string(labels.size()) + " labels", "two that differ");
  } else {
    if (!sheet.sheet.faces.empty()) table.fail("faces", "faces beside between", "one of them");
    sheet.between = std::pair(labels[0], labels[1]);
  }
  table.finish();
  return sheet;
}

/// A name stands for one set of faces, and sheets name those that there are.
void require_names(Table& table, const TetStep& tets) {
  std::vector<std::string> known{kOutside};
  for (const TetOpening& opening : tets.openings) {
    if (opening.name.find(" to ") != std::string::npos || opening.name.rfind("pressure ", 0) == 0) {
      table.fail("openings", opening.name, "a name unlike \"1 to 2\" and \"pressure 1\"");
    }
    if (std::count(known.begin(), known.end(), opening.name) > 0) {
      table.fail("openings", "a second " + opening.name, "a name of its own");
    }
    known.push_back(opening.name);
  }
  for (const TetSheet& sheet : tets.sheets) {
    if (sheet.between || std::count(known.begin(), known.end(), sheet.sheet.faces) > 0) continue;
    std::string expected;
    for (const std::string& name : known) expected += (expected.empty() ? "" : ", ") + name;
    table.fail("sheets", sheet.sheet.faces, expected);
  }
}

}  // namespace

FemStep read_tets(Table& table, const LabelNames& names) {
  FemStep fem = make_tet_step();
  TetStep& tets = *fem.tets;
  table.read(tet_fields(fem));
  read_loads(table, names, fem);
  for (Table& opening : table.table_or_tables("openings")) {
    tets.openings.push_back(read_opening(opening, names));
  }
  for (Table& sheet : table.table_or_tables("sheets")) {
    tets.sheets.push_back(read_sheet(sheet, names));
  }
  if (!tets.mesh.empty()) {
    for (const Field& field : fields(tets.solid)) {
      const std::string& key = field.name();
      if (table.has(key)) table.fail(key, key + " beside mesh", "one of them");
    }
  }
  require_names(table, tets);
  if (const auto problem = contradiction(fem)) {
    table.fail(problem->field, problem->found, problem->expected);
  }
  table.finish();
  return fem;
}

}  // namespace supple
