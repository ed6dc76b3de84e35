#include "lib/session/handles/handle_path.h"

#include <algorithm>
#include <cmath>

#include "volumes/base/units.h"
#include "volumes/geometry/pose_path.h"

namespace supple {

namespace {

constexpr double kMostStrayVoxels = 0.25;
/// Voxels from the point of a turn or scale at which its way counts.
constexpr double kReachVoxels = 100;
/// Between two keys there are no more than 2^12 poses.
constexpr int kMostHalvings = 12;

/// The paths of all handles of a step.
class JointPath {
 public:
  JointPath(const std::vector<Drag>& handles, const Geometry& geometry)
      : m_spacing_mm(geometry.spacing_mm()) {
    for (const Drag& handle : handles) {
      if (!handle.is_animated()) continue;
      m_paths.push_back(path_of(*handle.placed, geometry));
      for (const PlacedPose& pose : handle.placed->path) m_times.push_back(pose.time);
    }
    std::sort(m_times.begin(), m_times.end());
    m_times.erase(std::unique(m_times.begin(), m_times.end()), m_times.end());
  }

  /// Times of the poses, in order; nothing without a path. Poses that differ from the one before in
  /// nothing are left out, but for the last.
  std::vector<double> times() const {
    std::vector<double> all;
    for (std::size_t n = 0; n < m_times.size(); ++n) {
      if (n > 0) add_between(m_times[n - 1], m_times[n], kMostHalvings, all);
      all.push_back(m_times[n]);
    }
    std::vector<double> changes;
    std::vector<double> before = rest();
    for (const double time : all) {
      const std::vector<double> now = place_at(time);
      if (now == before && time != all.back()) continue;
      changes.push_back(time);
      before = now;
    }
    return changes;
  }

 private:
  static constexpr std::size_t kPerPath = 9;

  std::vector<double> rest() const {
    std::vector<double> place(kPerPath * m_paths.size(), 0);
    for (std::size_t n = 0; n < place.size(); ++n) {
      if (n % kPerPath >= 6) place[n] = kReachVoxels;
    }
    return place;
  }

  /// Shift, turn and scale of every path, as voxels.
  std::vector<double> place_at(double time) const {
    std::vector<double> place;
    for (const PosePath& path : m_paths) {
      const PathPose pose = path.at(time);
      const Vec3d shift = pose.shift_mm / m_spacing_mm;
      const Vec3d turn = pose.axis * (pose.angle_deg * kRadiansPerDegree * kReachVoxels);
      for (const Vec3d& part : {shift, turn, pose.scale * kReachVoxels}) {
        for (int c = 0; c < 3; ++c) place.push_back(part[c]);
      }
    }
    return place;
  }

  bool turns_far(double from, double to) const {
    return std::any_of(m_paths.begin(), m_paths.end(), [&](const PosePath& path) {
      const PathPose a = path.at(from), b = path.at(to);
      const bool is_about_one_axis = a.axis.cross(b.axis).length() < 1e-9;
      const double angle_deg =
          is_about_one_axis
              ? std::abs(b.angle_deg - a.angle_deg * a.axis.dot(b.axis))
              : (turn_about(b.axis, b.angle_deg) * turn_about(a.axis, a.angle_deg).inverse())
                    .angle_deg();
      return angle_deg > kMostTurnDeg * (1 + 1e-9);
    });
  }

  /// Distance of the pose at `time` from the straight way between two others.
  double stray(const std::vector<double>& a, const std::vector<double>& b, double time) const {
    const std::vector<double> place = place_at(time);
    double along = 0, square = 0;
    for (std::size_t n = 0; n < place.size(); ++n) {
      along += (place[n] - a[n]) * (b[n] - a[n]);
      square += (b[n] - a[n]) * (b[n] - a[n]);
    }
    const double part = square > 0 ? std::clamp(along / square, 0.0, 1.0) : 0;
    double sum = 0;
    for (std::size_t n = 0; n < place.size(); ++n) {
      const double miss = place[n] - (a[n] + part * (b[n] - a[n]));
      sum += miss * miss;
    }
    return std::sqrt(sum);
  }

  bool is_straight(double from, double to) const {
    const std::vector<double> a = place_at(from), b = place_at(to);
    for (const double part : {0.25, 0.5, 0.75}) {
      if (stray(a, b, from + part * (to - from)) > kMostStrayVoxels) return false;
    }
    return true;
  }

  void add_between(double from, double to, int halvings, std::vector<double>& times) const {
    if (halvings == 0 || (is_straight(from, to) && !turns_far(from, to))) return;
    const double middle = from + (to - from) / 2;
    add_between(from, middle, halvings - 1, times);
    times.push_back(middle);
    add_between(middle, to, halvings - 1, times);
  }

  Vec3d m_spacing_mm;
  std::vector<PosePath> m_paths;
  std::vector<double> m_times;  // of keys
};

}  // namespace

DragPose pose_of(const PathPose& pose, HandleMotion motion) {
  motion.axis_lps = pose.axis;
  motion.angle_deg = pose.angle_deg;
  motion.scale = pose.scale;
  return {pose.shift_mm, motion};
}

std::vector<Drag> drags_along_paths(const std::vector<Drag>& handles, const Geometry& geometry) {
  const std::vector<double> times = JointPath(handles, geometry).times();
  std::vector<Drag> drags;
  for (const Drag& handle : handles) {
    std::vector<Drag> own = to_drags(handle, geometry);
    if (handle.is_animated()) {
      const PosePath path = path_of(*handle.placed, geometry);
      for (std::size_t n = 0; n + 1 < times.size(); ++n) {
        own.front().way.push_back(pose_of(path.at(times[n]), own.front().motion));
      }
    }
    drags.insert(drags.end(), std::make_move_iterator(own.begin()),
                 std::make_move_iterator(own.end()));
  }
  return drags;
}

}  // namespace supple
