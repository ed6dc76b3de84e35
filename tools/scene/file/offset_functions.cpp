#include "tools/scene/file/offset_functions.h"

#include <algorithm>
#include <optional>
#include <set>
#include <tuple>

#include "volumes/base/error.h"
#include "volumes/base/text.h"
#include "volumes/io/point_file.h"

namespace supple::tools {

Fields fields(FunctionKeys& keys) {
  return {
      Field("point", keys.point,
            "In LPS: on the axis (bend, twist, taper), or on the side that opens (cut-open)")
          .unit("mm")
          .otherwise("the middle of the volume"),
      Field("axis", keys.axis, "Direction in LPS, of the hinge for cut-open").otherwise("superior"),
      Field("range", keys.range, "Of bend, twist and taper: a stretch of the axis from the point")
          .unit("mm")
          .otherwise("all of the volume"),
      Field("towards", keys.towards, "Of bend: direction in LPS, across the axis"),
      Field("angle", keys.angle, "Of bend, at most 180; of twist; of cut-open with a hinge")
          .unit("degrees"),
      Field("factor", keys.factor, "Of taper: at the end of the range"),
      Field("normal", keys.normal, "Of cut-open: of its plane, in LPS"),
      Field("gap", keys.gap, "Of cut-open without a hinge, and of explode").unit("mm"),
      Field("hinge", keys.hinge, "Of cut-open by an angle: a point of the hinge in LPS").unit("mm"),
      Field("points", keys.points,
            "Of lattice: a point file whose displacements move the control points nearest to it")
          .path(),
  };
}

namespace {

using Maker = std::function<std::shared_ptr<const PathFunction>(const Geometry&)>;

Vec3d centre_of(const Geometry& geometry) {
  return geometry.world_from_index(Vec3d(geometry.dims() - Vec3i(1)) / 2.0);
}

AxisRange range_of(const FunctionKeys& keys, const Geometry& geometry) {
  AxisRange result;
  result.point = keys.point.value_or(centre_of(geometry));
  result.axis = keys.axis.value_or(result.axis);
  if (keys.range) {
    std::tie(result.begin_mm, result.end_mm) = *keys.range;
  } else {
    span_box(geometry, result);
  }
  return result;
}

/// The keys that a function has, and what else it reads.
FunctionKeys read_keys(Table& table, const std::set<std::string>& names,
                       std::initializer_list<const char*> others = {}) {
  FunctionKeys keys;
  Fields chosen;
  for (const Field& field : fields(keys)) {
    if (names.count(field.name()) != 0) chosen.push_back(field);
  }
  table.know({"function"});
  table.know(others);
  table.read(chosen);
  return keys;
}

/// Corners of `box`, in voxels; by default the outer faces of the volume's.
struct BoxKey {
  std::optional<std::vector<double>> corners;

  Vec3d corner() const { return corners ? row(0) : Vec3d(-0.5); }
  Vec3d opposite(const Geometry& geometry) const {
    return corners ? row(3) : Vec3d(geometry.dims()) - Vec3d(0.5);
  }

 private:
  Vec3d row(std::size_t n) const { return {(*corners)[n], (*corners)[n + 1], (*corners)[n + 2]}; }
};

BoxKey read_box(Table& table) {
  const BoxKey box{table.get<std::vector<double>>("box")};
  if (box.corners && box.corners->size() != 6) {
    table.fail("box", std::to_string(box.corners->size()) + " numbers",
               "six voxel coordinates [i0, j0, k0, i1, j1, k1]");
  }
  return box;
}

std::array<int, 3> read_counts(Table& table, const std::string& key, const std::string& expected) {
  const auto counts = table.get<Vec3i>(key);
  const Vec3i found = table.require(counts, key, expected);
  return {found.x, found.y, found.z};
}

Maker read_bend(Table& table) {
  const FunctionKeys keys = read_keys(table, {"point", "axis", "range", "towards", "angle"});
  const Vec3d towards = table.require(keys.towards, "towards", "a direction in LPS");
  const double angle = table.require(keys.angle, "angle", "an angle in degrees");
  return [=](const Geometry& g) { return make_bend({range_of(keys, g), towards, angle}); };
}

Maker read_twist(Table& table) {
  const FunctionKeys keys = read_keys(table, {"point", "axis", "range", "angle"});
  const double angle = table.require(keys.angle, "angle", "an angle in degrees");
  return [=](const Geometry& g) { return make_twist({range_of(keys, g), angle}); };
}

Maker read_taper(Table& table) {
  const FunctionKeys keys = read_keys(table, {"point", "axis", "range", "factor"});
  const double factor = table.require(keys.factor, "factor", "a factor");
  return [=](const Geometry& g) { return make_taper({range_of(keys, g), factor}); };
}

Maker read_cut_open(Table& table) {
  const FunctionKeys keys = read_keys(table, {"point", "normal", "gap", "angle", "hinge", "axis"});
  CutOpenParams params;
  params.normal = table.require(keys.normal, "normal", "a direction in LPS");
  const bool swings = keys.angle.has_value();
  if (swings == keys.gap.has_value()) {
    if (swings) table.fail("gap", "gap and angle", "one of both");
    table.fail_missing("gap", "either gap in mm or angle in degrees");
  }
  params.gap_mm = keys.gap.value_or(0);
  params.angle_degrees = keys.angle.value_or(0);
  if (swings) {
    params.hinge = table.require(keys.hinge, "hinge", "a point of the hinge in LPS mm");
    params.hinge_axis = table.require(keys.axis, "axis", "the direction of the hinge in LPS");
  } else if (keys.hinge || keys.axis) {
    table.fail(keys.hinge ? "hinge" : "axis", "a hinge beside gap", "angle, or no hinge");
  }
  return [=](const Geometry& g) {
    CutOpenParams placed = params;
    placed.point = keys.point.value_or(centre_of(g));
    return make_cut_open(placed);
  };
}

Maker read_explode(Table& table) {
  const FunctionKeys keys = read_keys(table, {"gap"}, {"grid", "box"});
  ExplodeParams params;
  params.grid = read_counts(table, "grid", "the number of pieces along i, j and k");
  params.gap_mm = table.require(keys.gap, "gap", "a gap in mm");
  const BoxKey box = read_box(table);
  return [=](const Geometry& g) {
    ExplodeParams placed = params;
    placed.corner_index = box.corner();
    placed.opposite_index = box.opposite(g);
    return make_explode(placed, g);
  };
}

/// [i, j, k, dx, dy, dz], displacements in LPS mm.
std::vector<LatticeParams::Move> read_moves(Table& table) {
  std::vector<LatticeParams::Move> moves;
  const auto rows = table.rows("move", {6}, "a list of [i, j, k, dx, dy, dz]");
  if (!rows) return moves;
  for (const auto& row : *rows) {
    for (int a = 0; a < 3; ++a) {
      if (!is_integer(row[a])) table.fail("move", number_text(row[a]), "integer control points");
    }
    moves.push_back(
        {table.place("move"), {int(row[0]), int(row[1]), int(row[2])}, {row[3], row[4], row[5]}});
  }
  return moves;
}

/// The control point nearest to each point of the file, which must lie within its cell.
void add_points(const PointFile& file, const Geometry& geometry, LatticeParams& params) {
  for (const PointFile::Row& row : file.rows) {
    const Vec3d index = geometry.index_from_world(row.at_lps_mm);
    LatticeParams::Move move{file.place(row), {}, row.by_lps_mm};
    for (int a = 0; a < 3; ++a) {
      const double step =
          (params.opposite_index[a] - params.corner_index[a]) / (params.points[a] - 1);
      const double at = (index[a] - params.corner_index[a]) / step;
      const double nearest = std::clamp(std::round(at), 0.0, params.points[a] - 1.0);
      if (!(std::abs(at - nearest) <= 0.5)) {
        throw InputError({file.place(row), "point", to_text(row.at_lps_mm),
                          "a place within half a cell of a control point"});
      }
      move.point[a] = int(nearest);
    }
    params.moves.push_back(move);
  }
}

Maker read_lattice(Table& table) {
  const FunctionKeys keys = read_keys(table, {"points"}, {"lattice", "box", "move"});
  LatticeParams params;
  params.points = read_counts(table, "lattice", "the number of control points along i, j and k");
  params.moves = read_moves(table);
  std::optional<PointFile> file;
  if (!keys.points.empty()) {
    file = read_point_file(keys.points);
    if (!file->has_displacements) {
      table.fail("points", "points without displacements", "columns x,y,z,dx,dy,dz");
    }
  }
  if (!file && params.moves.empty()) table.fail_missing("move", "move or points");
  const BoxKey box = read_box(table);
  return [=](const Geometry& g) {
    LatticeParams placed = params;
    placed.corner_index = box.corner();
    placed.opposite_index = box.opposite(g);
    // A lattice that cannot be is refused before points are looked for in it.
    make_lattice({placed.points, placed.corner_index, placed.opposite_index, {}}, g);
    if (file) add_points(*file, g, placed);
    return make_lattice(placed, g);
  };
}

OffsetFunction read_function(Table& table) {
  OffsetFunction function;
  function.place = table.place();
  function.name = table.full_name("");
  function.given = table.value();
  const auto name = table.get<std::string>("function");
  if (!name) {
    table.fail("function", "nothing", "bend, twist, taper, cut-open, explode or lattice");
  }
  if (*name == "bend") function.make = read_bend(table);
  if (*name == "twist") function.make = read_twist(table);
  if (*name == "taper") function.make = read_taper(table);
  if (*name == "cut-open") function.make = read_cut_open(table);
  if (*name == "explode") function.make = read_explode(table);
  if (*name == "lattice") function.make = read_lattice(table);
  if (!function.make) {
    table.fail("function", "\"" + *name + "\"", "bend, twist, taper, cut-open, explode or lattice");
  }
  table.finish();
  return function;
}

/// Errors of the paths themselves name what they can: the function does the rest.
template <class Work>
auto placed(const OffsetFunction& function, const Work& work) {
  try {
    return work();
  } catch (const InputError& error) {
    const Problem& problem = error.problem();
    if (!problem.file.empty()) throw;
    throw InputError(
        {function.place, function.name + "." + problem.field, problem.found, problem.expected});
  }
}

}  // namespace

namespace {

std::vector<OffsetFunction> read_functions(Table& table, const std::string& key) {
  std::vector<OffsetFunction> functions;
  for (Table& function : table.table_or_tables(key)) {
    functions.push_back(read_function(function));
  }
  return functions;
}

}  // namespace

std::vector<OffsetFunction> read_path(Table& table) {
  const std::string key = table.present_name("path", "offset");
  if (is_text(table.find(key))) {
    Table file = table.named_file(key);
    std::vector<OffsetFunction> functions =
        read_functions(file, file.present_name("path", "offset"));
    if (functions.empty()) file.fail_missing("path", "a table with a function, or a list of them");
    file.finish();
    return functions;
  }
  return read_functions(table, key);
}

Field path_file_field(std::string& file) {
  return Field("path", file, "Bend, twist, taper, cut open, explode … (docs/scenes.md)")
      .path()
      .formerly("offset")
      .shown_as("FILE.toml");
}

std::vector<OffsetFunction> read_path_file(const std::string& file, Progress& progress) {
  if (file.empty()) return {};
  Table table = Table({{"path", file}}, "", {{"path", "--path"}});
  std::vector<OffsetFunction> functions = read_path(table);
  for (const std::string& line : table.warnings()) warn(&progress, line);
  return functions;
}

SamplingPath to_path(const std::vector<OffsetFunction>& functions, const Geometry& geometry) {
  SamplingPath path;
  for (const OffsetFunction& function : functions) {
    auto made = placed(function, [&] { return function.make(geometry); });
    if (made != nullptr) path.push_back(std::move(made));
  }
  return path;
}

Pose send_along(const std::vector<OffsetFunction>& functions, const Geometry& geometry,
                const BrickTopology& body, Progress& progress) {
  const SamplingPath path = to_path(functions, geometry);
  return placed(functions.front(), [&] {
    return Pose{move_along(path, {geometry, {body, BrickVectors(body.brick_count())}}),
                follow_path(path, geometry, body, &progress)};
  });
}

OffsetField send_along(const std::vector<OffsetFunction>& functions, const OffsetField& moved,
                       Progress& progress) {
  const SamplingPath path = to_path(functions, moved.geometry);
  if (path.empty()) return moved;
  return placed(functions.front(), [&] { return follow_path(path, moved, &progress); });
}

Pose send_along(const std::vector<OffsetFunction>& functions, const Pose& moved,
                Progress& progress) {
  const SamplingPath path = to_path(functions, moved.offsets.geometry);
  if (path.empty()) return moved;
  return placed(functions.front(), [&] {
    return Pose{move_along(path, moved.displacement), follow_path(path, moved.offsets, &progress)};
  });
}

Pose send_along(const std::vector<OffsetFunction>& functions, Pose&& moved, Progress& progress) {
  const SamplingPath path = to_path(functions, moved.offsets.geometry);
  if (path.empty()) return std::move(moved);
  return placed(functions.front(), [&] {
    Pose sent;
    sent.displacement = move_along(path, moved.displacement);
    moved.displacement = {};
    sent.offsets = follow_path(path, moved.offsets, &progress);
    moved.offsets = {};
    return sent;
  });
}

Pose invert_and_send_along(const State& state, const std::vector<OffsetFunction>& functions,
                           Progress& progress) {
  return send_along(functions, invert_state(state, &progress), progress);
}

}  // namespace supple::tools
