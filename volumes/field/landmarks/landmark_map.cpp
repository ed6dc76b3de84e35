#include "volumes/field/landmarks/landmark_map.h"

#include <algorithm>
#include <cmath>

#include "volumes/base/parallel.h"
#include "volumes/field/landmarks/point_spline.h"

namespace supple {

LandmarkMap::LandmarkMap(const Landmarks& landmarks, std::shared_ptr<const RigidRegions> regions,
                         double stiffness_mm)
    : m_regions(std::move(regions)) {
  if (!m_regions) {
    m_spline = fit_spline(landmarks.points, landmarks.vectors, stiffness_mm);
  } else {
    std::vector<Vec3d> points, vectors;
    for (const std::size_t n : m_regions->outside()) {
      const RigidRegions::Motion motion = m_regions->at(landmarks.points[n]);
      points.push_back(landmarks.points[n]);
      vectors.push_back((landmarks.vectors[n] - motion.vector) / motion.give);
    }
    m_has_spline = !points.empty();
    if (m_has_spline) m_spline = fit_spline(points, vectors, stiffness_mm);
  }
  double squares = 0;
  for (std::size_t n = 0; n < landmarks.points.size(); ++n) {
    const double misfit = (at(landmarks.points[n]) - landmarks.vectors[n]).length();
    squares += misfit * misfit;
    m_misfit.largest_mm = std::max(m_misfit.largest_mm, misfit);
  }
  m_misfit.rms_mm = std::sqrt(squares / double(landmarks.points.size()));
}

void LandmarkMap::finish(const RigidRegions::Motion& motion, Vec3d& vector) const {
  vector = motion.vector + (m_has_spline ? vector * motion.give : Vec3d(0));
}

Vec3d LandmarkMap::at(const Vec3d& x) const {
  Vec3d vector = m_has_spline ? m_spline.at(x) : Vec3d(0);
  if (m_regions) finish(m_regions->at(x), vector);
  return vector;
}

VectorSliceSource LandmarkMap::slices(const Geometry& grid) const {
  return [this, grid](int k, Vec3f* out) {
    const Vec3i& dims = grid.dims();
    parallel_for(dims.y, [&](int j) {
      const Vec3d first = grid.world_from_index(Vec3d(0, j, k));
      const Vec3d step = grid.axes_mm()[0];
      thread_local std::vector<Vec3d> row;
      row.assign(std::size_t(dims.x), Vec3d(0));
      if (m_has_spline) m_spline.row(first, step, dims.x, row.data());
      for (int i = 0; i < dims.x; ++i) {
        Vec3d& vector = row[std::size_t(i)];
        if (m_regions) finish(m_regions->at(first + step * double(i)), vector);
        out[std::size_t(j) * std::size_t(dims.x) + std::size_t(i)] = Vec3f(vector);
      }
    });
  };
}

}  // namespace supple
