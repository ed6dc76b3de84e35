// Warps: their files, inverses, sums and measures, and what goes through them.
#include "tools/python/attended.h"
#include "tools/python/bindings.h"
#include "tools/python/python_arrays.h"
#include "tools/python/python_values.h"
#include "tools/python/sent_through.h"
#include "volumes/field/dense/invert_warp.h"
#include "volumes/io/load/landmark_fit.h"
#include "volumes/io/load/load.h"
#include "volumes/io/transform/transform_volume.h"
#include "volumes/io/warp_file.h"

namespace py = pybind11;

namespace supple::python {

namespace {

const Geometry* address_of(const std::optional<Geometry>& grid) {
  return grid ? &*grid : nullptr;
}

py::tuple read_warp_file(const std::string& path, const std::optional<Geometry>& grid,
                         const py::object& callback) {
  const Warp warp = attended(
      callback, [&](Progress& progress) { return read_warp(path, &progress, address_of(grid)); });
  const std::size_t voxels =
      std::size_t(warp.geometry.dims().x) * std::size_t(warp.geometry.dims().y);
  const auto slice = [&](int k, Vec3f* out) {
    for (std::size_t n = 0; n < voxels; ++n) out[n] = warp.vectors[std::size_t(k) * voxels + n];
  };
  py::object direction = py::none();
  if (warp.direction) {
    direction = py::str(*warp.direction == WarpDirection::resample ? "resample" : "material");
  }
  return py::make_tuple(vectors_of(warp.geometry, slice, callback), warp.geometry, direction);
}

py::tuple invert_array(const VectorArray& vectors, const Geometry& grid,
                       const std::string& direction, const std::string& void_name,
                       const std::optional<Geometry>& on, const py::object& callback) {
  const OffsetField inverse = attended(callback, [&](Progress& progress) {
    return invert(displacement_of_warp(warp_of(vectors, grid, direction)), {}, &progress);
  });
  const Geometry target = on.value_or(grid);
  const BrickTopology nothing_vacated;
  const auto slices = dense_offsets(inverse, nothing_vacated, target, void_of(void_name));
  return py::make_tuple(vectors_of(target, slices, callback), target,
                        to_value(inverse.certificate));
}

TransformChain chain_of(const VectorArray& vectors, const Geometry& grid) {
  warp_of(vectors, grid, "resample");
  const float* const data = vectors.data();
  std::vector<Vec3d> mm(std::size_t(grid.voxel_count()));
  for (std::size_t n = 0; n < mm.size(); ++n) {
    mm[n] = Vec3d(data[3 * n], data[3 * n + 1], data[3 * n + 2]);
  }
  TransformChain chain;
  chain.links.push_back({field_map(grid, std::move(mm)), false});
  chain.grid = grid;
  return chain;
}

/// Transforms in the order of ANTs' -t, each a path, or vectors with their grid.
py::tuple compose_all(const py::list& transforms, const std::optional<Geometry>& grid,
                      const py::object& callback) {
  std::vector<TransformChain> chains;
  for (const py::handle transform : transforms) {
    if (py::isinstance<py::str>(transform)) {
      const auto path = transform.cast<std::string>();
      chains.push_back(attended(callback, [&](Progress& progress) {
        return read_transform(path, &progress, address_of(grid));
      }));
    } else {
      const auto given = transform.cast<std::pair<VectorArray, Geometry>>();
      chains.push_back(
          attended(callback, [&](Progress&) { return chain_of(given.first, given.second); }));
    }
  }
  TransformChain chain = compose(std::move(chains));
  const std::optional<Geometry> target = grid ? grid : chain.grid;
  if (!target) {
    throw UsageError("grid: found transforms of all space, expected a grid to write them on");
  }
  const auto file = transform_volume("composed", *target, std::move(chain));
  return py::make_tuple(values_of(*file, callback), *target);
}

py::tuple measure_warp(const VectorArray& vectors, const Geometry& grid,
                       const std::string& direction, bool has_maps, const py::object& callback) {
  const DeformationMaps maps = attended(callback, [&](Progress&) {
    const Displacement u = displacement_of_warp(warp_of(vectors, grid, direction));
    return map_deformation(u, u.u.topology, {});
  });
  return measures_of(maps, grid, {}, has_maps, callback);
}

py::tuple move_points(const VectorArray& vectors, const Geometry& grid,
                      const std::string& direction, const PointArray& points, bool back,
                      const py::object& callback) {
  const Warp warp =
      attended(callback, [&](Progress&) { return warp_of(vectors, grid, direction); });
  const auto motion = attended(callback, [&](Progress&) { return motion_through(warp, back); });
  return send_points(*motion, points, callback);
}

/// A volume file seen through a warp, by trilinear densities.
py::array warp_volume(const VectorArray& vectors, const Geometry& grid, const std::string& path,
                      const Geometry& target, const py::object& callback) {
  struct Source {
    Volume volume;
    OffsetField offsets;
  };
  const Source source = attended(callback, [&](Progress& progress) {
    Volume volume = load_volume(path, {}, &progress);
    OffsetField offsets =
        offsets_from_warp(warp_of(vectors, grid, "resample"), volume.geometry, &progress);
    return Source{std::move(volume), std::move(offsets)};
  });
  const DensityGrid& density = source.volume.density;
  ValueType type = ValueType::float32;
  find_numpy_type(source.volume.value_type, type);
  return scalars_of(target, type,
                    dense_resampled(source.offsets, density, target, density.background()),
                    callback);
}

py::array warp_labels(const VectorArray& vectors, const Geometry& grid,
                      const std::string& direction, const StoredLabels& labels, bool back,
                      const Geometry& target, const py::object& callback) {
  const Warp warp =
      attended(callback, [&](Progress&) { return warp_of(vectors, grid, direction); });
  const auto motion = attended(callback, [&](Progress&) { return motion_through(warp, !back); });
  std::atomic<std::int64_t> unresolved{0};
  return labels_of(labels, target, followed_labels(labels, *motion, target, unresolved), callback);
}

/// The vectors and the report of `supple fit`; `keys` without `rigid`.
py::tuple fit_points(const PointArray& from, const PointArray& to, const Geometry& grid,
                     const Value& keys, const std::vector<int>& rigid, const py::object& callback) {
  LandmarkFit settings;
  read_keys(keys, fields(settings));
  settings.rigid = rigid;
  const std::vector<Vec3d> begins = places_of(from), ends = places_of(to);
  const UnfoldedMap found = attended(callback, [&](Progress& progress) {
    return fit_landmarks(settings, begins, ends, grid, &progress);
  });
  GridFolds folds(grid);
  const py::array vectors = vectors_of(grid, counted(found.map.slices(grid), folds), callback);
  return py::make_tuple(vectors, to_value(found, folds));
}

}  // namespace

void bind_warps(py::module_& module) {
  py::class_<StoredLabels>(module, "StoredLabels")
      .def(py::init([](const std::string& path, const py::object& callback) {
        return attended(callback, [&](Progress& progress) {
          return StoredLabels(*open_volume(path, {}, &progress), &progress);
        });
      }));
  module.def("read_warp", &read_warp_file);
  module.def("invert", &invert_array);
  module.def("compose", &compose_all);
  module.def("fit", &fit_points);
  module.def("measure", &measure_warp);
  module.def("move_points", &move_points);
  module.def("warp_volume", &warp_volume);
  module.def("warp_labels", &warp_labels);
}

}  // namespace supple::python
