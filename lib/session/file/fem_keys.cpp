#include "lib/session/file/fem_keys.h"

#include <cmath>
#include <string>

#include "lib/session/fem/fem_modes.h"
#include "lib/session/fem/motion_step.h"
#include "lib/session/file/handle_keys.h"

namespace supple {

namespace {

/// Shifts, linear maps: a handle has no more.

FemLoad read_load(Table& table, LoadKind kind, const LabelNames& names) {
  FemLoad load;
  load.kind = kind;
  const Fields own = load_fields(load);
  // All keys are known before one is missed, so that the error names the one that is misspelt.
  for (const Field& field : own) table.has(field.name());
  load.part = read_part(table, names);
  table.read(own);
  if (load.facing && *load.facing == Vec3d(0.0)) table.fail("facing", "[0, 0, 0]", "a direction");
  table.finish();
  return load;
}

}  // namespace

void read_loads(Table& table, const LabelNames& names, FemStep& fem) {
  for (const LoadKind kind : {LoadKind::force, LoadKind::pressure, LoadKind::swelling}) {
    for (Table& load : table.table_or_tables(std::string(name_of(kind)) + "s")) {
      fem.loads.push_back(read_load(load, kind, names));
    }
  }
}

std::vector<HandDirection> read_directions(Table& table) {
  std::vector<HandDirection> directions;
  if (const auto rows =
          table.rows("directions", {3, 4}, "a list of [x, y, z] in mm or [x, y, z, degrees]")) {
    for (const std::vector<double>& row : *rows) {
      directions.push_back({Vec3d(row[0], row[1], row[2]), row.size() == 4 ? row[3] : 0});
      const HandDirection& last = directions.back();
      if (last.turn_deg != 0 && last.way == Vec3d(0)) {
        table.fail("directions", "a turn about no axis", "[x, y, z, degrees] with an axis");
      }
    }
  }
  if (directions.size() > kMostDirections) {
    table.fail("directions", std::to_string(directions.size()),
               "at most " + std::to_string(kMostDirections));
  }
  return directions;
}

FemStep read_fem(Table& table, const LabelNames& names) {
  FemStep fem;
  table.read(fields(fem));
  read_loads(table, names, fem);
  fem.directions = read_directions(table);
  if (auto modes = table.table("modes")) {
    modes->read(fields(fem.modes.emplace()));
    modes->finish();
    if (!fem.loads.empty()) table.fail("modes", "modes beside loads", "one of them");
  }
  if (auto motion = table.table("motion")) {
    if (fem.modes) table.fail("motion", "a motion beside modes", "one of them");
    MotionStep& step = fem.motion.emplace();
    motion->read(fields(step));
    if (const auto rows = motion->rows("watch", {3}, "a list of [i, j, k]")) {
      for (const std::vector<double>& row : *rows)
        step.watch.push_back(to_box(*motion, "watch", row).lo);
    }
    motion->finish();
  }
  if (const auto problem = contradiction(fem)) {
    table.fail(problem->field, problem->found, problem->expected);
  }
  table.finish();
  return fem;
}

}  // namespace supple
