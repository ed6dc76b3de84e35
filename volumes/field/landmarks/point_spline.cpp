#include "volumes/field/landmarks/point_spline.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Dense>

#include "volumes/base/error.h"

namespace supple {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr double kAlike = 1e-9;  // of the extent of all points
constexpr std::size_t kMostPoints = 20000;

struct Frame {
  Vec3d middle{0, 0, 0};
  double extent = 1;  // the largest distance from it
};

Frame frame_of(const std::vector<Vec3d>& points) {
  Frame frame;
  for (const Vec3d& point : points) frame.middle += point / double(points.size());
  double extent = 0;
  for (const Vec3d& point : points) extent = std::max(extent, (point - frame.middle).length());
  if (extent > 0) frame.extent = extent;
  return frame;
}

/// Points are compared with those that are near them along x.
void require_apart(const std::vector<Vec3d>& points, double least) {
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return points[a].x < points[b].x; });
  for (std::size_t n = 0; n < order.size(); ++n) {
    for (std::size_t m = n + 1; m < order.size(); ++m) {
      const Vec3d apart = points[order[m]] - points[order[n]];
      if (apart.x > least) break;
      if (apart.length() > least) continue;
      const auto [first, second] = std::minmax(order[n], order[m]);
      throw InputError({"", "points",
                        "number " + std::to_string(second + 1) + " at the place of number " +
                            std::to_string(first + 1),
                        "another place, or a stiffness above 0"});
    }
  }
}

}  // namespace

SplineSum fit_spline(const std::vector<Vec3d>& points, const std::vector<Vec3d>& vectors,
                     double stiffness_mm) {
  const auto count = Index(points.size());
  require(points.size() <= kMostPoints, "points", double(points.size()), "at most 20,000");
  const Frame frame = frame_of(points);
  if (stiffness_mm == 0) require_apart(points, kAlike * frame.extent);

  // In units of the extent: polynomials P, distances, vectors.
  MatrixXd polynomials(count, 4), data(count, 3), energy(count, count);
  for (Index n = 0; n < count; ++n) {
    const Vec3d place = (points[std::size_t(n)] - frame.middle) / frame.extent;
    const Vec3d& vector = vectors[std::size_t(n)];
    polynomials.row(n) << 1, place.x, place.y, place.z;
    data.row(n) << vector.x, vector.y, vector.z;
  }
  for (Index n = 0; n < count; ++n) {
    for (Index m = 0; m < count; ++m) {
      energy(m, n) = -(polynomials.row(m) - polynomials.row(n)).norm();
    }
    energy(n, n) += stiffness_mm / frame.extent;
  }

  // Weights without moments are w = N z, N an orthonormal complement of P's columns, on which the
  // energy is positive definite.
  Eigen::ColPivHouseholderQR<MatrixXd> split(polynomials);
  split.setThreshold(kAlike);
  const Index rank = split.rank();
  MatrixXd weights = MatrixXd::Zero(count, 3);
  if (count > rank) {
    const auto q = split.householderQ();
    MatrixXd turned = energy;
    turned.applyOnTheLeft(q.adjoint());
    turned.applyOnTheRight(q);
    MatrixXd right = data;
    right.applyOnTheLeft(q.adjoint());
    weights.bottomRows(count - rank) = turned.bottomRightCorner(count - rank, count - rank)
                                           .selfadjointView<Eigen::Lower>()
                                           .llt()
                                           .solve(right.bottomRows(count - rank));
    weights.applyOnTheLeft(q);
  }
  Eigen::CompleteOrthogonalDecomposition<MatrixXd> least(count, polynomials.cols());
  least.setThreshold(kAlike);  // which it needs before it computes
  least.compute(polynomials);
  const MatrixXd affine = least.solve(data - energy * weights);

  const auto row = [](const MatrixXd& of, Index n) { return Vec3d(of(n, 0), of(n, 1), of(n, 2)); };
  SplineSum::Affine linear{frame.middle, row(affine, 0), {}};
  for (Index a = 0; a < 3; ++a) linear.along[std::size_t(a)] = row(affine, a + 1) / frame.extent;
  std::vector<SplineSum::Centre> centres;
  for (Index n = 0; n < count; ++n) {
    centres.push_back({points[std::size_t(n)], row(weights, n) * (-1 / frame.extent)});
  }
  return SplineSum(std::move(centres), linear);
}

}  // namespace supple
