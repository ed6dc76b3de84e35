// Arrays of what a deformation carries along or says of itself, of bodies and of warps alike:
// points, labels, densities, and measures at voxels.
#pragma once

#include "tools/python/python_arrays.h"
#include "volumes/field/inversion/deformation_metrics.h"
#include "volumes/field/points/point_motion.h"
#include "volumes/io/load/stored_labels.h"

namespace supple::python {

using PointArray = pybind11::array_t<double, pybind11::array::c_style | pybind11::array::forcecast>;

/// Throws InputError for any other name.
VoidMode void_of(const std::string& name);

/// Points (n, 3) in LPS mm: where they are now, and for each its PlaceKind by name.
pybind11::tuple send_points(const PointMotion& motion, const PointArray& points,
                            const pybind11::object& callback);

/// For each voxel of the grid the label at the place that the motion leads to; 0 outside of it.
pybind11::array send_labels(const PointMotion& motion, const StoredLabels& labels,
                            const Geometry& grid, const pybind11::object& callback);
/// The same at x + o(x), 0 in the void.
pybind11::array send_labels(const OffsetField& offsets, const StoredLabels& labels,
                            const Geometry& grid, const pybind11::object& callback);

/// Densities of slices in a type of numpy, rounded and clamped as files of it have them.
pybind11::array densities_of(const ScalarSliceSource& slices, const Geometry& grid,
                             const std::string& type, const pybind11::object& callback);

/// The summary, those of labels where there are any, and maps by name where they are asked for.
pybind11::tuple measures_of(const DeformationMaps& maps, const Geometry& grid,
                            const BrickValues& labels, bool has_maps);

}  // namespace supple::python
