#include "tools/python/sent_through.h"

#include <cmath>

#include "tools/python/attended.h"
#include "tools/python/python_values.h"
#include "volumes/base/parallel.h"
#include "volumes/field/dense/grid_positions.h"

namespace py = pybind11;

namespace supple::python {

namespace {

/// `find(i, j, k, place)`: LPS mm of the place whose label a voxel takes; false for none.
template <class Find>
py::array labels_at(const StoredLabels& labels, const Geometry& grid, const Find& find,
                    const py::object& callback) {
  py::array array = empty_array(grid, py::dtype(numpy_name(labels.type())));
  auto* const out = static_cast<char*>(array.mutable_data());
  const std::size_t bytes = std::size_t(labels.bytes_per_voxel());
  const Vec3i dims = grid.dims();
  attend(callback, [&](Progress& progress) {
    progress.stage("labels");
    std::fill(out, out + bytes * std::size_t(grid.voxel_count()), char(0));
    for (int k = 0; k < dims.z; ++k) {
      parallel_for(dims.y, [&](int j) {
        for (int i = 0; i < dims.x; ++i) {
          Vec3d place;
          if (!find(i, j, k, place)) continue;
          const std::size_t row = std::size_t(k) * std::size_t(dims.y) + std::size_t(j);
          labels.nearest(place, out + (row * std::size_t(dims.x) + std::size_t(i)) * bytes);
        }
      });
      report(&progress, double(k + 1) / dims.z);
    }
  });
  return array;
}

/// Values at the elements, `elsewhere` around them.
template <class Number, class At>
py::array map_of(const DeformationMaps& maps, const Geometry& grid, Number elsewhere,
                 const At& at) {
  py::array array = empty_array(grid, py::dtype::of<Number>());
  auto* const out = static_cast<Number*>(array.mutable_data());
  std::fill(out, out + grid.voxel_count(), elsewhere);
  const Vec3i& dims = grid.dims();
  for (std::size_t b = 0; b < maps.elements.brick_count(); ++b) {
    for_each_active(maps.elements.mask(b), [&](int offset) {
      const Vec3i voxel = maps.elements.origin(b) + brick_local(offset);
      const std::size_t row = std::size_t(voxel.z) * std::size_t(dims.y) + std::size_t(voxel.y);
      out[row * std::size_t(dims.x) + std::size_t(voxel.x)] =
          at(b, offset, b * kBrickVoxels + std::size_t(offset));
    });
  }
  return array;
}

}  // namespace

VoidMode void_of(const std::string& name) {
  if (name == "nearest") return VoidMode::nearest;
  if (name == "outside") return VoidMode::outside;
  if (name == "extend") return VoidMode::extend;
  throw InputError({"", "void", "\"" + name + "\"", "\"nearest\", \"outside\" or \"extend\""});
}

py::tuple send_points(const PointMotion& motion, const PointArray& points,
                      const py::object& callback) {
  if (points.ndim() != 2 || points.shape(1) != 3) {
    throw InputError({"", "points", "an array of another shape", "(n, 3) in LPS mm"});
  }
  static constexpr const char* kKinds[] = {"inside", "outside", "folded", "torn", "unresolved"};
  const auto count = std::size_t(points.shape(0));
  const auto* from = reinterpret_cast<const Vec3d*>(points.data());
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

py::array send_labels(const PointMotion& motion, const StoredLabels& labels, const Geometry& grid,
                      const py::object& callback) {
  const auto find = [&](int i, int j, int k, Vec3d& place) {
    const MovedPoint moved = motion.move(grid.world_from_index(Vec3d(i, j, k)));
    place = moved.to_lps_mm;
    return moved.kind != PlaceKind::unresolved && moved.kind != PlaceKind::outside;
  };
  return labels_at(labels, grid, find, callback);
}

py::array send_labels(const OffsetField& offsets, const StoredLabels& labels, const Geometry& grid,
                      const py::object& callback) {
  const GridPositions positions(grid, offsets.geometry);
  const auto find = [&](int i, int j, int k, Vec3d& place) {
    Vec3d source;
    if (!offsets.source_of(positions.at(i, j, k), source)) return false;
    place = offsets.geometry.world_from_index(source);
    return true;
  };
  return labels_at(labels, grid, find, callback);
}

py::array densities_of(const ScalarSliceSource& slices, const Geometry& grid,
                       const std::string& type_name, const py::object& callback) {
  ValueType type = ValueType::float32;
  find_numpy_type(type_name, type);
  py::array array = empty_array(grid, py::dtype(numpy_name(type)));
  auto* const out = static_cast<char*>(array.mutable_data());
  const std::size_t count = std::size_t(grid.dims().x) * std::size_t(grid.dims().y);
  attend(callback, [&](Progress& progress) {
    progress.stage("resampling");
    std::vector<float> values(count);
    for (int k = 0; k < grid.dims().z; ++k) {
      slices(k, values.data());
      store_values(type, values.data(), count,
                   out + std::size_t(k) * count * std::size_t(bytes_of(type)));
      report(&progress, double(k + 1) / grid.dims().z);
    }
  });
  return array;
}

py::tuple measures_of(const DeformationMaps& maps, const Geometry& grid, const BrickValues& labels,
                      bool has_maps) {
  Value summary = to_value(summarize(maps, grid));
  if (!labels.empty()) {
    summary["labels"] = Value::Entries();
    for (const auto& [label, of_label] : summarize_labels(maps, labels, grid)) {
      summary["labels"][std::to_string(label)] = to_value(of_label);
    }
  }
  py::dict arrays;
  if (has_maps) {
    arrays["jacobian"] = map_of<float>(
        maps, grid, 1, [&](std::size_t, int, std::size_t n) { return maps.jacobian[n]; });
    arrays["length_mm"] = map_of<float>(
        maps, grid, 0, [&](std::size_t, int, std::size_t n) { return maps.length_mm[n]; });
    arrays["bending_per_mm2"] = map_of<float>(maps, grid, 0, [&](std::size_t, int, std::size_t n) {
      return std::isnan(maps.bending_per_mm2[n]) ? 0 : maps.bending_per_mm2[n];
    });
    arrays["folded"] =
        map_of<std::uint8_t>(maps, grid, 0, [&](std::size_t b, int offset, std::size_t) {
          return std::uint8_t(mask_test(maps.folded[b], offset));
        });
  }
  return py::make_tuple(summary, arrays);
}

}  // namespace supple::python
