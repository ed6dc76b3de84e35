#include "tools/scene/file/fem_keys.h"

#include <cmath>
#include <string>

#include "tools/scene/file/handle_keys.h"

namespace supple::tools {

namespace {

GivenLoad read_load(Table& table, LoadKind kind, const LabelNames& names) {
  GivenLoad load;
  load.kind = kind;
  table.read(load_fields(load));
  if (load.facing && *load.facing == Vec3d(0.0)) table.fail("facing", "[0, 0, 0]", "a direction");
  load.given = read_part(table, names);
  table.finish();
  return load;
}

}  // namespace

GivenFem read_fem(Table& table, const LabelNames& names) {
  GivenFem given;
  table.read({accuracy_field(given.step)});
  given.step.params.set_accuracy(given.step.params.accuracy);
  table.read(fields(given.step));
  for (const LoadKind kind : {LoadKind::force, LoadKind::pressure, LoadKind::swelling}) {
    for (Table& load : table.table_or_tables(std::string(name_of(kind)) + "s")) {
      given.loads.push_back(read_load(load, kind, names));
    }
  }
  if (auto modes = table.table("modes")) {
    modes->read(fields(given.step.modes.emplace()));
    modes->finish();
    if (!given.loads.empty()) table.fail("modes", "modes beside loads", "one of them");
  }
  if (auto motion = table.table("motion")) {
    if (given.step.modes) table.fail("motion", "a motion beside modes", "one of them");
    MotionStep& step = given.step.motion.emplace();
    motion->read(fields(step));
    if (const auto rows = motion->rows("watch", {3}, "a list of [i, j, k]")) {
      for (const std::vector<double>& row : *rows)
        step.watch.push_back(to_box(*motion, "watch", row).lo);
    }
    motion->finish();
  }
  if (const auto problem = contradiction(given.step)) {
    table.fail(problem->field, problem->found, problem->expected);
  }
  table.finish();
  return given;
}

FemStep fem_step(const GivenFem& given, const Geometry& geometry) {
  FemStep step = given.step;
  for (const GivenLoad& load : given.loads) {
    step.loads.push_back(load);
    step.loads.back().part = to_part(load.given, geometry);
  }
  return step;
}

}  // namespace supple::tools
