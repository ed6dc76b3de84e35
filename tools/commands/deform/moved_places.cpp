#include "tools/commands/deform/moved_places.h"

#include "volumes/base/parallel.h"
#include "volumes/base/value.h"

namespace supple::tools {

namespace {

constexpr std::size_t kChunk = 65536;

std::vector<std::size_t> numbers_of(const MovedPlaces& moved, PlaceKind kind) {
  std::vector<std::size_t> numbers;
  for (std::size_t n = 0; n < moved.points.size() && numbers.size() < kListed; ++n) {
    if (moved.points[n].kind == kind) numbers.push_back(n);
  }
  return numbers;
}

void count(MovedPlaces& moved) {
  for (const MovedPoint& point : moved.points) {
    moved.outside += point.kind == PlaceKind::outside;
    moved.folded += point.kind == PlaceKind::folded;
    moved.torn += point.kind == PlaceKind::torn;
    moved.unresolved += point.kind == PlaceKind::unresolved;
  }
}

}  // namespace

std::vector<Vec3d> MovedPlaces::positions() const {
  std::vector<Vec3d> positions;
  positions.reserve(points.size());
  for (const MovedPoint& point : points) positions.push_back(point.to_lps_mm);
  return positions;
}

MovedPlaces move_all(const PointMotion& motion, const std::vector<Vec3d>& points_lps_mm,
                     Console& console) {
  console.stage("moving");
  MovedPlaces moved;
  moved.points.resize(points_lps_mm.size());
  for (std::size_t begin = 0; begin < points_lps_mm.size(); begin += kChunk) {
    const std::size_t end = std::min(begin + kChunk, points_lps_mm.size());
    parallel_for(begin, end,
                 [&](std::size_t n) { moved.points[n] = motion.move(points_lps_mm[n]); });
    report(&console, double(end) / double(points_lps_mm.size()));
  }
  count(moved);
  return moved;
}

void warn_of(const MovedPlaces& moved, bool is_warp,
             const std::function<std::string(std::size_t)>& name, Console& console) {
  const auto warn = [&](std::int64_t number, PlaceKind kind, const std::string& what) {
    if (number == 0) return;
    console.warn(with_count(number, "point") + " " + what + "; the first is " +
                 name(numbers_of(moved, kind).front()));
  };
  warn(moved.outside, PlaceKind::outside,
       is_warp ? "beyond the grid of the warp stay where they are"
               : "beyond the material go with what is nearest");
  warn(moved.folded, PlaceKind::folded, "in folds; ties go to the shortest way");
  warn(moved.torn, PlaceKind::torn, "between the sides of an open cut");
  warn(moved.unresolved, PlaceKind::unresolved,
       is_warp ? "could not be found and stay where they are" : "could not be found, only guessed");
}

Value to_value(const MovedPlaces& moved) {
  Value json = {{"points", moved.points.size()},
                {"outside", moved.outside},
                {"folded", moved.folded},
                {"torn", moved.torn},
                {"unresolved", moved.unresolved}};
  json["folded_points"] = numbers_of(moved, PlaceKind::folded);
  json["torn_points"] = numbers_of(moved, PlaceKind::torn);
  json["unresolved_points"] = numbers_of(moved, PlaceKind::unresolved);
  return json;
}

}  // namespace supple::tools
