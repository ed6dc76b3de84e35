#include "lib/instruments/track.h"

#include <algorithm>
#include <cmath>

#include "volumes/base/error.h"
#include "volumes/base/text.h"

namespace supple {

namespace {

void check(const TrackKey& key, const TrackKey* before, const std::string& file, std::size_t n) {
  const auto fail = [&](const std::string& found, const std::string& expected) {
    throw InputError({file, "key " + std::to_string(n + 1), found, expected});
  };
  const InstrumentPose& pose = key.pose;
  if (!std::isfinite(key.time_s)) fail("a time that is not finite", "seconds");
  if (before != nullptr && !(key.time_s > before->time_s)) {
    fail("the time " + exact_text(key.time_s) + " s after " + exact_text(before->time_s) + " s",
         "times that ascend");
  }
  if (!is_finite(pose.tip_mm) || !is_finite(pose.axis) || !std::isfinite(pose.roll_degrees) ||
      !std::isfinite(pose.opening_degrees) || !std::isfinite(pose.active)) {
    fail("a number that is not finite", "finite numbers");
  }
  if (!(pose.axis.length() > 1e-9)) fail("an axis of length 0", "a direction");
}

}  // namespace

InstrumentTrack::InstrumentTrack(std::vector<TrackKey> keys, const std::string& file)
    : m_keys(std::move(keys)) {
  if (m_keys.empty()) throw InputError({file, "track", "no key", "one key at least"});
  for (std::size_t n = 0; n < m_keys.size(); ++n) {
    check(m_keys[n], n > 0 ? &m_keys[n - 1] : nullptr, file, n);
    // A unit vector keeps its bits, so that a track that was written is read as the same.
    Vec3d& axis = m_keys[n].pose.axis;
    if (std::abs(axis.length2() - 1) > 1e-12) axis.normalize();
  }
}

InstrumentPose InstrumentTrack::at(double time_s) const {
  if (m_keys.empty()) return {};
  const auto after =
      std::upper_bound(m_keys.begin(), m_keys.end(), time_s,
                       [](double time, const TrackKey& key) { return time < key.time_s; });
  if (after == m_keys.begin()) return m_keys.front().pose;
  if (after == m_keys.end()) return m_keys.back().pose;
  const TrackKey &a = after[-1], &b = *after;
  const double part = (time_s - a.time_s) / (b.time_s - a.time_s);
  if (part <= 0) return a.pose;
  return pose_between(a.pose, b.pose, part);
}

InstrumentPose through_pivot(const InstrumentPose& pose, const Vec3d& pivot_mm) {
  const Vec3d to_pivot = pivot_mm - pose.tip_mm;
  const double length = to_pivot.length();
  if (length < 1e-9) return pose;
  // A tip that has been drawn out of the incision still has the hand behind it.
  InstrumentPose turned = pose;
  turned.axis = to_pivot / (to_pivot.dot(pose.axis) < 0 ? -length : length);
  return turned;
}

}  // namespace supple
