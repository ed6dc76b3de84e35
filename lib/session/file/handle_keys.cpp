#include "lib/session/file/handle_keys.h"

#include <algorithm>
#include <set>

#include "volumes/base/error.h"

namespace supple {

namespace {

/// Keys of handles that are no plain fields.
constexpr std::initializer_list<const char*> kOtherKeys = {
    "grab", "grab_box", "grab_label", "at_mm", "points", "to", "path"};

std::int32_t label_of(const Table& table, const std::string& key, const std::string& text,
                      const LabelNames& names) {
  const auto label = find_label(names, text);
  if (!label) table.fail(key, text, expected_label(names));
  return *label;
}

std::optional<PointFile> read_points(Table& table, const std::string& key) {
  const auto path = table.path(key);
  if (!path) return std::nullopt;
  return read_point_file(*path);
}

/// A voxel is a box of one.
void read_corners(Table& table, PlacedSelection& given) {
  const bool in_voxels = given.frame == PlaceFrame::voxel;
  if (in_voxels) {
    if (const auto voxel = table.get<Vec3i>("grab")) given.corners = {Vec3d(*voxel), Vec3d(*voxel)};
  } else if (const auto at = table.get<Vec3d>("grab")) {
    given.corners = {*at, *at};
  }
  const auto row = table.get<std::vector<double>>("grab_box");
  if (!row) return;
  if (given.corners) table.fail("grab_box", "grab and grab_box", "one of both");
  if (row->size() != 6) {
    table.fail("grab_box", std::to_string(row->size()) + " numbers",
               "six integers [i0, j0, k0, i1, j1, k1]");
  }
  if (in_voxels) {
    const IndexBox box = to_box(table, "grab_box", *row);
    given.corners = {Vec3d(box.lo), Vec3d(box.hi)};
  } else {
    const std::vector<double>& v = *row;
    given.corners = {Vec3d(v[0], v[1], v[2]), Vec3d(v[3], v[4], v[5])};
  }
}

/// Returns those keys of a handle, an anchor or a step that say what is held, and how.
Value keys_that_hold(const Table& table) {
  std::set<std::string> names = {"soft", "push", "spare_fixed", "slide"};
  names.insert(kOtherKeys.begin(), kOtherKeys.end());
  PlacedSelection selection;
  for (const Field& field : fields(selection)) names.insert(field.name());
  names.erase("path");
  const Value written = table.written();
  Value keys = Value::Entries();
  for (const auto& [name, value] : written.entries()) {
    if (names.count(name) != 0) keys[name] = value;
  }
  return keys;
}

void read_selection(Table& table, const LabelNames& names, PlacedSelection& given) {
  given.place = table.place("grab");
  table.read(fields(given));
  read_corners(table, given);
  given.at_lps_mm = table.get<Vec3d>("at_mm");
  given.points = read_points(table, "points");
  given.label = read_label(table, "grab_label", names);
  const bool has_place = given.corners || given.at_lps_mm || given.ball;
  const bool narrows = given.density || given.piece_at || given.rigid_at;
  const int count = int(given.corners.has_value()) + int(given.at_lps_mm.has_value()) +
                    int(given.points.has_value()) + int(given.label.has_value()) +
                    int(given.ball.has_value());
  const char* expected =
      "one of grab = [i, j, k], grab_box, grab_ball, grab_label, grab_density, piece_at, rigid_at, "
      "at_mm and points";
  if (count == 0 && !narrows) table.fail_missing("grab", expected);
  if (count > 1) table.fail("grab", "several of them", expected);
  if (narrows && count == 1 && !has_place) {
    table.fail(given.density    ? "grab_density"
               : given.piece_at ? "piece_at"
                                : "rigid_at",
               "beside points or a label", "it alone, or with a voxel, box or ball");
  }
  if (given.ball.has_value() != given.radius_mm.has_value()) {
    if (given.ball) table.fail_missing("radius", "of the ball, a number of mm");
    if (!given.points) {
      table.fail("radius", "a radius without a ball", "grab_ball = [i, j, k] beside it");
    }
  }
  if (given.density && !(given.density->first <= given.density->second)) {
    table.fail("grab_density", "the larger one first", "[LEAST, LARGEST]");
  }
  given.keys = keys_that_hold(table);
}

/// True where each point is a handle of its own.
bool has_own_ways(const PlacedHandle& handle) {
  return handle.points && handle.points->has_displacements;
}

/// Reads where points go, pair by pair.
void read_targets(Table& table, PlacedHandle& handle) {
  const std::optional<PointFile> to = read_points(table, "to");
  if (!to) return;
  if (!handle.points || handle.points->has_displacements) {
    table.fail("to", handle.points ? "beside points with displacements" : "without points",
               "points = \"file.csv\" with columns x, y, z beside it");
  }
  handle.points = led_to(std::move(*handle.points), *to);
}

void check_turn(const Table& table, const Drag& drag) {
  const PlacedHandle& handle = *drag.placed;
  const bool scales = handle.scale || handle.scale_axes;
  if (handle.scale && handle.scale_axes) table.fail("scale", "scale and scale_axes", "one of both");
  if (handle.rotate_deg && !handle.axis) table.fail_missing("axis", "the direction [x, y, z]");
  if (handle.axis && !handle.rotate_deg && !drag.is_animated()) {
    table.fail("axis", "an axis without rotate", "both");
  }
  if (handle.axis && *handle.axis == Vec3d(0)) table.fail("axis", "[0, 0, 0]", "a direction");
  if (handle.about && !handle.rotate_deg && !scales && !drag.is_animated()) {
    table.fail("about", "a point without rotate or scale", "one of both");
  }
  if (drag.soft_mm > 0 && (handle.piece_at || !(handle.corners || handle.ball || handle.at_lps_mm ||
                                                has_own_ways(handle)))) {
    table.fail("soft", "an edge of something else", "an edge of a voxel, box or ball");
  }
  if (handle.points && handle.radius_mm && !has_own_ways(handle)) {
    table.fail("radius", "a radius of points that go as one",
               "points with displacements or to = \"file.csv\"");
  }
}

PlacedPose read_pose(Table& table) {
  PlacedPose pose;
  pose.place = table.place();
  table.read(fields(pose));
  table.finish();
  const bool scales = pose.scale || pose.scale_axes;
  if (!pose.by && !pose.by_lps_mm && !pose.rotate_deg && !scales) {
    table.fail_missing("by", "by = [x, y, z], by_mm_lps, rotate or scale");
  }
  if (pose.by && pose.by_lps_mm) table.fail("by", "by and by_mm_lps", "one of both");
  if (pose.scale && pose.scale_axes) table.fail("scale", "scale and scale_axes", "one of both");
  if (pose.axis && *pose.axis == Vec3d(0)) table.fail("axis", "[0, 0, 0]", "a direction");
  return pose;
}

void read_poses(Table& table, Drag& drag) {
  PlacedHandle& handle = *drag.placed;
  bool has_axis = handle.axis.has_value(), turns = false;
  for (Table& pose : table.tables("path")) {
    handle.path.push_back(read_pose(pose));
    has_axis = has_axis || handle.path.back().axis;
    turns = turns || handle.path.back().rotate_deg;
    require_later(pose, handle.path);
  }
  if (!drag.is_animated()) return;
  if (drag.slides) table.fail("slide", "slide beside path", "a shift, or a path that stops");
  for (const char* key : {"by", "by_mm_lps", "scale", "scale_axes", "rotate"}) {
    if (table.has(key)) table.fail(key, std::string(key) + " beside path", "it in the path's keys");
  }
  if (turns && !has_axis) table.fail_missing("axis", "the direction [x, y, z] of the turns");
  if (!turns && has_axis) table.fail("axis", "an axis without rotate", "both");
  if (has_own_ways(handle)) {
    table.fail("path", "a path beside the displacements of the points", "one of both");
  }
}

}  // namespace

IndexBox to_box(Table& table, const std::string& key, const std::vector<double>& row) {
  IndexBox box;
  const std::size_t last = row.size() - 3;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double value : {row[axis], row[last + axis]}) {
      if (!is_integer(value)) table.fail(key, number_text(value), "integer voxels");
    }
    box.lo[axis] = int(std::min(row[axis], row[last + axis]));
    box.hi[axis] = int(std::max(row[axis], row[last + axis]));
  }
  return box;
}

std::optional<std::int32_t> read_label(Table& table, const std::string& key,
                                       const LabelNames& names) {
  if (!table.has(key)) return std::nullopt;
  return label_of(table, key,
                  is_text(table.find(key)) ? *table.get<std::string>(key)
                                           : number_text(*table.get<double>(key)),
                  names);
}

std::vector<std::int32_t> read_labels(Table& table, const std::string& key,
                                      const LabelNames& names) {
  std::vector<std::string> texts;
  const Value* value = table.find(key);
  if (value != nullptr && !value->items().empty() && value->front().is_text()) {
    texts = *table.get<std::vector<std::string>>(key);
  } else if (const auto numbers = table.get<std::vector<double>>(key)) {
    for (const double number : *numbers) texts.push_back(number_text(number));
  }
  std::vector<std::int32_t> labels;
  for (const std::string& text : texts) labels.push_back(label_of(table, key, text, names));
  return labels;
}

bool has_handle(Table& table) {
  Drag handle;
  bool found = false;
  for (const char* key : kOtherKeys) found = table.has(key) || found;
  for (const Field& field : fields(handle.placed.emplace())) {
    found = table.has(field.name()) || found;
  }
  for (const Field& field : fields(handle)) {
    found = table.has(field.name()) || found;
  }
  return found;
}

Drag read_handle(Table& table, const LabelNames& names) {
  Drag drag;
  PlacedHandle& handle = drag.placed.emplace();
  table.know(kOtherKeys);
  table.know({"by", "by_mm_lps"});
  has_handle(table);
  read_selection(table, names, handle);
  read_targets(table, handle);
  table.read(fields(drag));
  read_poses(table, drag);
  check_turn(table, drag);
  if (drag.is_animated()) return drag;
  const bool is_posed = handle.rotate_deg || handle.scale || handle.scale_axes;
  if (has_own_ways(handle)) {
    if (!handle.by && !handle.by_lps_mm && !is_posed) return drag;
    table.fail(handle.by           ? "by"
               : handle.by_lps_mm  ? "by_mm_lps"
               : handle.rotate_deg ? "rotate"
                                   : "scale",
               "a displacement beside those of the points", "one of both");
  }
  if (handle.by && handle.by_lps_mm) {
    table.fail("by", "by and by_mm_lps", "either by = [x, y, z] or by_mm_lps");
  }
  if (!handle.by && !handle.by_lps_mm && !is_posed) {
    table.fail_missing("by", "by = [x, y, z], by_mm_lps, rotate, scale or path");
  }
  return drag;
}

PlacedSelection read_anchor(Table& table, const LabelNames& names) {
  PlacedSelection given;
  table.know(kOtherKeys);
  read_selection(table, names, given);
  if (table.has("path")) table.fail("path", "in anchors", "it in handles");
  if (given.points || given.label) {
    table.fail(given.points ? "points" : "grab_label", "in anchors", "fix_points or fix_label");
  }
  return given;
}

ChosenPart read_part(Table& table, const LabelNames& names) {
  ChosenPart part;
  table.know(kOtherKeys);
  part.name = table.get<std::string>("name").value_or("");
  read_selection(table, names, part.placed.emplace());
  if (part.placed->points) {
    table.fail("points", "points of a file", "a label, box, ball or densities");
  }
  return part;
}

}  // namespace supple
