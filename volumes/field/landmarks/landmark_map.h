// From pairs of landmarks to vectors everywhere: a spline (point_spline.h), and where labels are to
// stay rigid their motion there, the mean of these outside, and the spline of what is left of the
// other landmarks, which fades towards the rigid labels (rigid_regions.h).
#pragma once

#include <memory>
#include <vector>

#include "volumes/field/dense/resample.h"
#include "volumes/field/landmarks/rigid_regions.h"
#include "volumes/field/landmarks/spline_sum.h"

namespace supple {

struct Landmarks {
  std::vector<Vec3d> points;   // mm, LPS
  std::vector<Vec3d> vectors;  // mm: from each to its partner
};

/// How far landmarks are from where a map takes them, mm.
struct LandmarkMisfit {
  double rms_mm = 0, largest_mm = 0;
};

class LandmarkMap {
 public:
  /// `regions`: of these landmarks; null: none. Throws InputError as fit_spline.
  LandmarkMap(const Landmarks& landmarks, std::shared_ptr<const RigidRegions> regions,
              double stiffness_mm);

  Vec3d at(const Vec3d& x) const;
  LandmarkMisfit misfit() const { return m_misfit; }

  /// The vectors at the points of a grid, mm. The map must outlive it. Cost: as SplineSum::row(),
  /// on all threads.
  VectorSliceSource slices(const Geometry& grid) const;

 private:
  void finish(const RigidRegions::Motion& motion, Vec3d& vector) const;

  std::shared_ptr<const RigidRegions> m_regions;
  bool m_has_spline = true;
  SplineSum m_spline;
  LandmarkMisfit m_misfit;
};

}  // namespace supple
