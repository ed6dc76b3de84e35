// The tube around a curve as a straight box: "curved planar reformation". The box lies on a grid of
// its own with i along the curve, j beside it and k up, and touches the curve at its middle, where
// nothing moves. Vectors of its points lead to the places of the tube that they show (resample
// direction). With the curvature k (1/mm, towards the centre) and the way r from the curve,
//   det F = 1 - k . r
// so the map folds where r reaches the radius of curvature.
#pragma once

#include "volumes/base/fields.h"
#include "volumes/field/centreline/centreline.h"
#include "volumes/field/dense/resample.h"
#include "volumes/field/landmarks/grid_folds.h"

namespace supple {

struct Straightening {
  double radius_mm = 20;
  std::optional<double> height_mm, spacing_mm;
  std::optional<Vec3d> up;
  bool has_no_folds = false;
};
Fields fields(Straightening& settings);

class StraightGrid {
 public:
  /// `points`: LPS mm; `spacing_mm`: where the settings have none. Throws InputError as Centreline,
  /// for values that are no lengths, for a grid that Geometry refuses, and where nothing shall fold
  /// but does at the curve itself.
  StraightGrid(const std::vector<Vec3d>& points, const Straightening& settings, double spacing_mm);

  const Geometry& grid() const { return m_grid; }
  const Centreline& curve() const { return m_curve; }
  /// Half the box beside the curve; smaller than asked for where nothing shall fold.
  double radius_mm() const { return m_radius_mm; }
  /// The largest radius of a box of this shape in which nothing folds; infinite for a straight
  /// line.
  double unfolded_radius_mm() const { return m_unfolded_radius_mm; }
  /// The curve's least radius of curvature; infinite for a straight line.
  double curve_radius_mm() const { return m_curve_radius_mm; }

  /// From each point of the grid to its place in the tube, mm. This must outlive it.
  VectorSliceSource slices() const;

 private:
  void find_radii();

  Straightening m_settings;
  Centreline m_curve;
  double m_radius_mm = 0, m_unfolded_radius_mm = 0, m_curve_radius_mm = 0;
  Geometry m_grid;
  std::vector<CurveFrame> m_frames;  // one per i
};

/// Report of a box whose vectors were counted on their grid: lengths in mm, folds.
Value to_value(const StraightGrid& straight, const GridFolds& folds);
/// The line that warns of folds; empty where there are none.
std::string folds_text(const StraightGrid& straight, const GridFolds& folds);

}  // namespace supple
