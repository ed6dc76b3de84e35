// Points and labels that a deformation carries along, and measures of it, of bodies and of warps
// alike.
#pragma once

#include "tools/python/python_arrays.h"
#include "volumes/field/inversion/deformation_metrics.h"
#include "volumes/field/points/point_motion.h"
#include "volumes/io/load/followed_labels.h"

namespace supple::python {

using PointArray = pybind11::array_t<double, pybind11::array::c_style | pybind11::array::forcecast>;

/// Throws InputError for any other name.
VoidMode void_of(const std::string& name);

/// Points (n, 3) in LPS mm. Throws InputError for another shape.
std::vector<Vec3d> places_of(const PointArray& points);
/// Points (n, 3) in LPS mm: where they are now, and for each its PlaceKind by name.
pybind11::tuple send_points(const PointMotion& motion, const PointArray& points,
                            const pybind11::object& callback);

/// Labels that a deformation sends to a grid, in the type of their file.
pybind11::array labels_of(const StoredLabels& labels, const Geometry& grid,
                          const LabelSliceSource& slices, const pybind11::object& callback);

/// The summary, those of labels where there are any, and maps by name where they are asked for.
pybind11::tuple measures_of(const DeformationMaps& maps, const Geometry& grid,
                            const BrickValues& labels, bool has_maps,
                            const pybind11::object& callback);

}  // namespace supple::python
