// Grids and arrays of numpy: volumes [k, j, i], vectors [k, j, i, 3] in mm LPS.
#pragma once

#include <functional>

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include "volumes/field/dense/resample.h"
#include "volumes/field/dense/warp.h"
#include "volumes/geometry/geometry.h"
#include "volumes/io/format/volume_file.h"

namespace supple::python {

using VectorArray = pybind11::array_t<float, pybind11::array::c_style | pybind11::array::forcecast>;

/// A grid of `shape` (k, j, i) and an affine that takes (i, j, k, 1) to LPS mm.
Geometry make_grid(const pybind11::tuple& shape,
                   const pybind11::array_t<double, pybind11::array::forcecast>& affine);
pybind11::tuple shape_of(const Geometry& grid);
pybind11::array_t<double> affine_of(const Geometry& grid);

/// Throws InputError for values of any other type.
ValueType type_of(const pybind11::array& array);
/// An array of the grid with a row of `components` at every voxel (1: no row), filled slice by
/// slice.
using SliceBytes = std::function<void(int k, char* out)>;
pybind11::array array_of(const Geometry& grid, ValueType type, int components, const char* stage,
                         const pybind11::object& callback, const SliceBytes& slice);
/// The values as a file has them, float32 where they have slope and intercept; vectors as rows.
pybind11::array values_of(VolumeFile& file, const pybind11::object& callback);
/// The slices of a source of vectors.
pybind11::array vectors_of(const Geometry& grid, const VectorSliceSource& slices,
                           const pybind11::object& callback);
/// The same of scalars, rounded and clamped as files of the type have them.
pybind11::array scalars_of(const Geometry& grid, ValueType type, const ScalarSliceSource& slices,
                           const pybind11::object& callback);
/// An array as a warp. Throws InputError where it does not fit the grid.
Warp warp_of(const VectorArray& vectors, const Geometry& grid, const std::string& direction);
/// Throws InputError for any other name.
WarpDirection direction_of(const std::string& name);

}  // namespace supple::python
