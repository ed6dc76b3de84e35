// Transforms of registration programs, one after the other: where each point of the fixed image is
// taken from in the moving one, both LPS mm. A warp of resample direction moves points this way.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "volumes/geometry/geometry.h"

namespace supple {

/// A transform of points, LPS mm.
class PointMap {
 public:
  virtual ~PointMap() = default;
  virtual Vec3d at(const Vec3d& lps_mm) const = 0;
};

/// An affine map of LPS mm (linear_transform.h).
std::unique_ptr<PointMap> affine_map(const Geometry& map);

/// A point plus the vector there: trilinear between grid points, the nearest within half a step
/// beyond the outer ones, and none further out (itk::DisplacementFieldTransform).
std::unique_ptr<PointMap> field_map(const Geometry& grid, std::vector<Vec3d> vectors_mm);

/// A point plus a tensor product of B-splines of order 1 to 3 whose coefficients lie on a grid;
/// none outside of where all coefficients of a point are there (itk::BSplineTransform).
/// Cost: (order + 1)^3 coefficients per point, 0.1 µs for order 3.
std::unique_ptr<PointMap> bspline_map(const Geometry& grid, int order,
                                      std::vector<Vec3d> coefficients_mm);

struct TransformChain {
  struct Link {
    std::unique_ptr<PointMap> map;
    bool adds = false;  // its displacement is that of the original point (elastix, "Add")
  };
  std::vector<Link> links;       // the first to be applied first
  std::optional<Geometry> grid;  // where the file says that it is to be evaluated

  Vec3d at(const Vec3d& lps_mm) const;
};

/// Several as one, the last applied first, as ITK's CompositeTransform and the options -t of ANTs
/// say it: x goes to first(second(... last(x))). The grid is that of the last with one.
TransformChain compose(std::vector<TransformChain> chains);

/// "#Insight Transform File V1.0": identity, translation, affine, Euler, versor, similarity,
/// displacement fields and B-splines; several only in a CompositeTransform, which applies the last
/// first. The grid is that of the only displacement field among linear transforms, else none.
TransformChain read_itk_transform(const std::string& path);

/// TransformParameters.N.txt of elastix: translation, Euler, similarity, affine, B-spline. Initial
/// transforms are looked for by name in the folder of the file.
TransformChain read_elastix_transform(const std::string& path);

}  // namespace supple
