#include "volumes/field/cuts/cut_planes.h"

#include <algorithm>
#include <cmath>

#include "volumes/base/parallel.h"

namespace supple {

namespace {

constexpr int kPlaneBlock = 6;
constexpr double kFarthest = 6;  // voxels from a crossing, at which sides are known
// How fast farther crossings count less, in voxels.
constexpr double kWidth = 1;

Vec3i plane_block_of(const Vec3d& X) {
  return {int(std::floor(X.x / kPlaneBlock)), int(std::floor(X.y / kPlaneBlock)),
          int(std::floor(X.z / kPlaneBlock))};
}

/// The direction in which a symmetric matrix stretches least, by inverse iteration.
Vec3d least_direction(const Vec3d (&m)[3], Vec3d start) {
  const Vec3d yz = m[1].cross(m[2]), zx = m[2].cross(m[0]), xy = m[0].cross(m[1]);
  for (int n = 0; n < 12; ++n) {
    start = (yz * start.x + zx * start.y + xy * start.z);
    if (start.length2() == 0) break;
    start.normalize();
  }
  return start;
}

}  // namespace

Vec3d plane_normal(const std::vector<Vec3d>& points, const Vec3d& guess) {
  Vec3d mean(0);
  for (const Vec3d& p : points) mean += p;
  mean /= double(points.size());
  Vec3d m[3] = {Vec3d(0), Vec3d(0), Vec3d(0)};
  double trace = 0;
  for (const Vec3d& p : points) {
    const Vec3d d = p - mean;
    for (int a = 0; a < 3; ++a) m[a] += d * d[a];
    trace += d.dot(d);
  }
  Vec3d normal = guess.normalized();
  if (points.size() > 2 && trace > 0) {
    for (int a = 0; a < 3; ++a) m[a][a] += 1e-3 * trace;
    normal = least_direction(m, normal);
  }
  return normal;
}

void CutPlanes::add(const Vec3d& at, int axis) {
  Vec3d along(0);
  along[axis] = 1;
  m_blocks[plane_block_of(at)].push_back(int(m_points.size()));
  m_points.push_back({at, along, axis});
}

/// True if both have the same crossings in a block, in the same order.
bool CutPlanes::has_same_block(const CutPlanes& other, const Vec3i& block) const {
  const auto own = m_blocks.find(block), theirs = other.m_blocks.find(block);
  if (own == m_blocks.end() || theirs == other.m_blocks.end()) {
    return own == m_blocks.end() && theirs == other.m_blocks.end();
  }
  return std::equal(own->second.begin(), own->second.end(), theirs->second.begin(),
                    theirs->second.end(), [&](int a, int b) {
                      const Point& one = m_points[std::size_t(a)];
                      const Point& same = other.m_points[std::size_t(b)];
                      return one.at == same.at && one.axis == same.axis;
                    });
}

/// A plane follows from the crossings of the blocks around.
void CutPlanes::fit(const CutPlanes& known) {
  std::vector<std::uint8_t> is_known(m_points.size());
  for (const auto& [block, points] : m_blocks) {
    bool is_same = true;
    for (int n = 0; n < 27 && is_same; ++n) {
      is_same = has_same_block(known, block + Vec3i(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1));
    }
    for (std::size_t n = 0; n < points.size() && is_same; ++n) {
      const int same = known.m_blocks.at(block)[n];
      m_points[std::size_t(points[n])].normal = known.m_points[std::size_t(same)].normal;
      is_known[std::size_t(points[n])] = 1;
    }
  }
  parallel_for(m_points.size(), [&](std::size_t n) {
    if (is_known[n]) return;
    Point& point = m_points[n];
    std::vector<Vec3d> near;
    for_near(point.at, [&](const Point& other) {
      const Vec3d step = other.at - point.at;
      if (step.length() <= kPlaneFitRadius) near.push_back(step);
    });
    point.normal = plane_normal(near, point.normal);
  });
}

template <class Visit>
void CutPlanes::for_near(const Vec3d& X, Visit&& visit) const {
  const Vec3i middle = plane_block_of(X);
  for (int n = 0; n < 27; ++n) {
    const auto found = m_blocks.find(middle + Vec3i(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1));
    if (found == m_blocks.end()) continue;
    for (const int point : found->second) visit(m_points[std::size_t(point)]);
  }
}

CutPlanes::Side CutPlanes::side_of(const Vec3d& X) const {
  const Point* nearest = nullptr;
  double shortest2 = kFarthest * kFarthest;
  for_near(X, [&](const Point& point) {
    const double distance2 = (X - point.at).length2();
    if (distance2 >= shortest2) return;
    shortest2 = distance2;
    nearest = &point;
  });
  if (nearest == nullptr) return {};
  Side side{true, 0, nearest->normal};
  double sum = 0, weights = 0;
  for_near(X, [&](const Point& point) {
    const Vec3d step = X - point.at;
    const double weight = std::exp((shortest2 - step.length2()) / (kWidth * kWidth));
    const double across = step.dot(point.normal);
    sum += weight * (point.normal.dot(nearest->normal) < 0 ? -across : across);
    weights += weight;
  });
  side.distance = sum / weights;
  return side;
}

}  // namespace supple
