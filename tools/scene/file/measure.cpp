#include "tools/scene/file/measure.h"

#include <cmath>

#include "volumes/base/csv.h"
#include "volumes/base/text.h"

namespace supple::tools {

namespace {

constexpr std::size_t kMostPoints = 3;
constexpr double kFurthestMm = 1e6;
constexpr std::size_t kLongestName = 100;
constexpr double kDegrees = 57.29577951308232;

void add_points(const std::vector<Vec3d>& points, std::vector<std::string>& cells) {
  for (std::size_t n = 0; n < kMostPoints; ++n) {
    for (int axis = 0; axis < 3; ++axis) {
      cells.push_back(n < points.size() ? exact_text(points[n][axis]) : "");
    }
  }
}

}  // namespace

Measure read_measure(Table& table) {
  const char* const expected = "[x, y, z] in mm of two places of a distance, three of an angle";
  Measure measure;
  measure.name = table.get<std::string>("name").value_or("");
  if (measure.name.size() > kLongestName) table.fail("name", "a longer one", "100 letters at most");
  const auto rows = table.require(table.rows("points", {3}, expected), "points", expected);
  for (const std::vector<double>& row : rows) {
    const Vec3d point(row[0], row[1], row[2]);
    if (!(point.length() <= kFurthestMm)) table.fail("points", "a place far away", "at most 1 km");
    if (!measure.points.empty() && measure.points.back() == point) {
      table.fail("points", "one place twice in a row", "places apart");
    }
    measure.points.push_back(point);
  }
  const std::size_t count = measure.points.size();
  if (count != 2 && count != 3) table.fail("points", std::to_string(count) + " places", expected);
  return measure;
}

Value keys_of(const Measure& measure) {
  Value keys = Value::Entries();
  if (!measure.name.empty()) keys["name"] = measure.name;
  for (const Vec3d& point : measure.points) keys["points"].push_back(point);
  return keys;
}

double measured_value(const std::vector<Vec3d>& points) {
  const Vec3d a = points[0] - points[1];
  if (points.size() == 2) return a.length();
  const Vec3d b = points[2] - points[1];
  return kDegrees * std::atan2(a.cross(b).length(), a.dot(b));
}

Vec3d place_now(const Vec3d& rest_index, const Displacement& moved) {
  Vec3d u(0);
  if (!moved.u.sample(rest_index, u)) u = Vec3d(0);
  return rest_index + u;
}

std::vector<Vec3d> points_now(const Measure& measure, const Displacement& moved) {
  const Geometry& geometry = moved.geometry;
  std::vector<Vec3d> now;
  for (const Vec3d& point : measure.points) {
    const Vec3d rest = geometry.index_from_world(point);
    const Vec3d index = place_now(rest, moved);
    now.push_back(index == rest ? point : geometry.world_from_index(index));
  }
  return now;
}

std::string measures_csv(const std::vector<Measure>& measures, const Displacement& moved) {
  std::vector<std::string> cells = {"name", "kind", "unit", "at_rest", "now"};
  for (const char* when : {"", "_rest"}) {
    for (std::size_t n = 1; n <= kMostPoints; ++n) {
      for (const char axis : {'x', 'y', 'z'}) cells.push_back(axis + std::to_string(n) + when);
    }
  }
  std::string text = csv_line(cells);
  for (std::size_t n = 0; n < measures.size(); ++n) {
    const Measure& measure = measures[n];
    const std::vector<Vec3d> now = points_now(measure, moved);
    cells = {measure.name.empty() ? std::to_string(n + 1) : measure.name, measure.kind(),
             measure.unit(), exact_text(measured_value(measure.points)),
             exact_text(measured_value(now))};
    add_points(now, cells);
    add_points(measure.points, cells);
    text += csv_line(cells);
  }
  return text;
}

}  // namespace supple::tools
