// Thin-plate spline in space through vectors at points, or near them: the field v that has the
// least sum of
//   |v(x_i) - v_i|^2   over the points, and
//   stiffness * 8 pi * (integral of the squared second derivatives of v)
// (Duchon 1977; Wahba, "Spline Models for Observational Data", SIAM 1990, chapter 2.4). Its form is
// an affine part and a sum of -w_i |x - x_i| with weights of which no affine field has a moment;
// stiffness 0 meets all points. As `RBFInterpolator(kernel="linear", degree=1, smoothing=…)` of
// scipy, and as the thin-plate splines of ITK and of 3D Slicer's landmark registration.
//
// Points that do not span space leave the affine part without slope across their plane or line, so
// that three points, or one, are enough for a field.
// Cost: with n points n^3 / 3 products and 8 n^2 bytes: 0.2 s and 8 MB for 1,000 points.
#pragma once

#include <vector>

#include "volumes/field/landmarks/spline_sum.h"

namespace supple {

/// `points` and `vectors` in mm, as many of both and at least one. `stiffness_mm`: 0 or more.
/// Throws InputError, with the numbers of both from 1, where two points lie within 1e-9 of the
/// extent of all and stiffness is 0, and for more than 20,000 points.
SplineSum fit_spline(const std::vector<Vec3d>& points, const std::vector<Vec3d>& vectors,
                     double stiffness_mm = 0);

}  // namespace supple
