#include "tools/python/python_arrays.h"

#include "tools/python/attended.h"

namespace py = pybind11;

namespace supple::python {

namespace {

std::size_t slice_voxels(const Geometry& grid) {
  return std::size_t(grid.dims().x) * std::size_t(grid.dims().y);
}

}  // namespace

Geometry make_grid(const py::tuple& shape,
                   const py::array_t<double, py::array::forcecast>& affine) {
  if (shape.size() != 3) {
    throw InputError({"", "shape", std::to_string(shape.size()) + " numbers", "(k, j, i)"});
  }
  if (affine.ndim() != 2 || affine.shape(0) < 3 || affine.shape(1) != 4) {
    throw InputError({"", "affine", "another shape", "4 x 4, from (i, j, k, 1) to LPS mm"});
  }
  const Vec3i dims(shape[2].cast<int>(), shape[1].cast<int>(), shape[0].cast<int>());
  const auto column = [&](int c) {
    return Vec3d(affine.at(0, c), affine.at(1, c), affine.at(2, c));
  };
  return Geometry(dims, column(3), {column(0), column(1), column(2)});
}

py::tuple shape_of(const Geometry& grid) {
  return py::make_tuple(grid.dims().z, grid.dims().y, grid.dims().x);
}

py::array_t<double> affine_of(const Geometry& grid) {
  py::array_t<double> affine({4, 4});
  auto at = affine.mutable_unchecked<2>();
  for (int row = 0; row < 4; ++row) {
    for (int c = 0; c < 3; ++c) at(row, c) = row < 3 ? grid.axes_mm()[std::size_t(c)][row] : 0;
    at(row, 3) = row < 3 ? grid.origin_lps_mm()[row] : 1;
  }
  return affine;
}

ValueType type_of(const py::array& array) {
  ValueType type;
  const std::string name = py::str(array.dtype().attr("name"));
  if (find_numpy_type(name, type)) return type;
  throw InputError({"", "array", "values of type " + name, "whole numbers, float32 or float64"});
}

py::array array_of(const Geometry& grid, ValueType type, int components, const char* stage,
                   const py::object& callback, const SliceBytes& slice) {
  std::vector<py::ssize_t> shape = {grid.dims().z, grid.dims().y, grid.dims().x};
  if (components != 1) shape.push_back(components);
  py::array array(py::dtype(numpy_name(type)), shape);
  auto* const out = static_cast<char*>(array.mutable_data());
  const std::size_t bytes =
      slice_voxels(grid) * std::size_t(components) * std::size_t(bytes_of(type));
  attend(callback, [&](Progress& progress) {
    progress.stage(stage);
    for (int k = 0; k < grid.dims().z; ++k) {
      slice(k, out + std::size_t(k) * bytes);
      report(&progress, double(k + 1) / grid.dims().z);
    }
  });
  return array;
}

py::array values_of(VolumeFile& file, const py::object& callback) {
  const VolumeHeader& header = file.header();
  const bool is_scaled = header.slope != 1 || header.intercept != 0;
  const ValueType type = is_scaled ? ValueType::float32 : header.type;
  const std::size_t count = slice_voxels(header.geometry) * std::size_t(header.components);
  std::vector<char> stored(is_scaled ? count * std::size_t(bytes_of(header.type)) : 0);
  std::vector<double> values(is_scaled ? count : 0);
  const auto slice = [&](int, char* out) {
    file.read_slice(is_scaled ? stored.data() : out);
    if (!is_scaled) return;
    scale_values_of(header.type)(stored.data(), count, header.slope, header.intercept,
                                 values.data());
    store_values(type, values.data(), count, out);
  };
  return array_of(header.geometry, type, header.components, "reading", callback, slice);
}

py::array vectors_of(const Geometry& grid, const VectorSliceSource& slices,
                     const py::object& callback) {
  return array_of(grid, ValueType::float32, 3, "vectors", callback,
                  [&](int k, char* out) { slices(k, reinterpret_cast<Vec3f*>(out)); });
}

py::array scalars_of(const Geometry& grid, ValueType type, const ScalarSliceSource& slices,
                     const py::object& callback) {
  std::vector<float> values(slice_voxels(grid));
  return array_of(grid, type, 1, "values", callback, [&](int k, char* out) {
    slices(k, values.data());
    store_values(type, values.data(), values.size(), out);
  });
}

WarpDirection direction_of(const std::string& name) {
  if (name == "resample") return WarpDirection::resample;
  if (name == "material") return WarpDirection::material;
  throw InputError({"", "direction", "\"" + name + "\"", "\"resample\" or \"material\""});
}

Warp warp_of(const VectorArray& vectors, const Geometry& grid, const std::string& direction) {
  const Vec3i& dims = grid.dims();
  const bool fits = vectors.ndim() == 4 && vectors.shape(0) == dims.z &&
                    vectors.shape(1) == dims.y && vectors.shape(2) == dims.x &&
                    vectors.shape(3) == 3;
  if (!fits) {
    throw InputError({"", "warp", "an array that does not fit its grid", "[k, j, i, 3]"});
  }
  Warp warp{"warp", grid, direction_of(direction), WarpVectors(std::size_t(grid.voxel_count()))};
  const auto* data = reinterpret_cast<const Vec3f*>(vectors.data());
  for (std::size_t n = 0; n < warp.vectors.size(); ++n) {
    if (!is_finite(Vec3d(data[n]))) {
      throw InputError({"", "warp", "a vector that is not finite", "mm along LPS"});
    }
  }
  warp.vectors.put(0, data, warp.vectors.size());
  return warp;
}

}  // namespace supple::python
