#include "tools/python/sent_through.h"

#include "tools/python/attended.h"
#include "tools/python/python_values.h"
#include "volumes/base/parallel.h"

namespace py = pybind11;

namespace supple::python {

VoidMode void_of(const std::string& name) {
  if (name == "nearest") return VoidMode::nearest;
  if (name == "outside") return VoidMode::outside;
  if (name == "extend") return VoidMode::extend;
  throw InputError({"", "void", "\"" + name + "\"", "\"nearest\", \"outside\" or \"extend\""});
}

std::vector<Vec3d> places_of(const PointArray& points) {
  if (points.ndim() != 2 || points.shape(1) != 3) {
    throw InputError({"", "points", "an array of another shape", "(n, 3) in LPS mm"});
  }
  const auto* const first = reinterpret_cast<const Vec3d*>(points.data());
  return {first, first + points.shape(0)};
}

py::tuple send_points(const PointMotion& motion, const PointArray& points,
                      const py::object& callback) {
  const std::vector<Vec3d> from = places_of(points);
  static constexpr const char* kKinds[] = {"inside", "outside", "folded", "torn", "unresolved"};
  const std::size_t count = from.size();
  py::array_t<double> moved({py::ssize_t(count), py::ssize_t(3)});
  auto* const to = reinterpret_cast<Vec3d*>(moved.mutable_data());
  std::vector<PlaceKind> kinds(count);
  attend(callback, [&](Progress& progress) {
    progress.stage("moving");
    parallel_for(count, [&](std::size_t n) {
      const MovedPoint point = motion.move(from[n]);
      to[n] = point.to_lps_mm;
      kinds[n] = point.kind;
    });
  });
  py::list names;
  for (const PlaceKind kind : kinds) names.append(kKinds[int(kind)]);
  return py::make_tuple(moved, names);
}

py::array labels_of(const StoredLabels& labels, const Geometry& grid,
                    const LabelSliceSource& slices, const py::object& callback) {
  return array_of(grid, labels.type(), 1, "labels", callback, slices);
}

py::tuple measures_of(const DeformationMaps& maps, const Geometry& grid, const BrickValues& labels,
                      bool has_maps, const py::object& callback) {
  const Value summary = attended(callback, [&](Progress&) {
    Value whole = to_value(summarize(maps, grid));
    if (labels.empty()) return whole;
    whole["labels"] = Value::Entries();
    for (const auto& [label, of_label] : summarize_labels(maps, labels, grid)) {
      whole["labels"][std::to_string(label)] = to_value(of_label);
    }
    return whole;
  });
  py::dict arrays;
  const auto add = [&](const char* name, ValueType type, DeformationMap which) {
    arrays[name] = scalars_of(grid, type, slices_of(maps, which, grid.dims()), callback);
  };
  if (has_maps) {
    add("jacobian", ValueType::float32, DeformationMap::jacobian);
    add("length_mm", ValueType::float32, DeformationMap::length_mm);
    add("bending_per_mm2", ValueType::float32, DeformationMap::bending_per_mm2);
    add("folded", ValueType::uint8, DeformationMap::folded);
  }
  return py::make_tuple(summary, arrays);
}

}  // namespace supple::python
