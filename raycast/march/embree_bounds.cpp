#include "raycast/march/embree_bounds.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "raycast/march/embree_scene.h"

namespace supple {

namespace {

constexpr double kGrowth = 0.01;  // voxels; covers Embree's single precision

using ClusterBox = std::pair<Vec3d, Vec3d>;  // lowest and highest corner

/// Ray and results of one traversal; Embree hands the context to the callback.
struct CollectContext {
  RTCIntersectContext base;
  Vec3d origin;
  Vec3d per_voxel;  // mm along the ray per voxel along each axis; infinite across it
  Interval within;
  std::vector<Interval>* out;
};

void box_bounds(const RTCBoundsFunctionArguments* args) {
  const ClusterBox& box = static_cast<const ClusterBox*>(args->geometryUserPtr)[args->primID];
  RTCBounds& b = *args->bounds_o;
  b.lower_x = float(box.first.x), b.lower_y = float(box.first.y), b.lower_z = float(box.first.z);
  b.upper_x = float(box.second.x), b.upper_y = float(box.second.y), b.upper_z = float(box.second.z);
}

/// The part of the ray in a box, empty where it misses: as clip_to_box(), without a division per
/// side. In a side of the box, along it, 0 * infinity is not a number and may count as a miss;
/// boxes are kGrowth larger than what is seen.
Interval part_in(const ClusterBox& box, const CollectContext& ray) {
  Interval part = ray.within;
  for (int a = 0; a < 3; ++a) {
    const double t0 = (box.first[a] - ray.origin[a]) * ray.per_voxel[a];
    const double t1 = (box.second[a] - ray.origin[a]) * ray.per_voxel[a];
    part.begin = std::max(part.begin, std::min(t0, t1));
    part.end = std::min(part.end, std::max(t0, t1));
  }
  return part;
}

/// Notes the interval and reports no hit, so that the traversal goes on to the end.
void collect(const RTCIntersectFunctionNArguments* args) {
  if (args->valid[0] == 0) return;
  auto* context = reinterpret_cast<CollectContext*>(args->context);
  const ClusterBox& box = static_cast<const ClusterBox*>(args->geometryUserPtr)[args->primID];
  const Interval hit = part_in(box, *context);
  if (hit.begin <= hit.end) context->out->push_back(hit);
}

/// The box around the visible bricks of every 16^3 cluster.
std::vector<ClusterBox> cluster_boxes(const BrickIndex& bricks,
                                      const std::vector<std::uint8_t>& visible) {
  constexpr std::size_t kClusters = BrickIndex::kTableSize / 8;  // of a table
  std::vector<std::int32_t> box_of(bricks.place_count() / 8, -1);
  std::vector<ClusterBox> boxes;
  for (std::size_t b = 0; b < bricks.count(); ++b) {
    if (!visible[b]) continue;
    const Vec3i& origin = bricks.origin(b);
    const ClusterBox brick{Vec3d(origin) - Vec3d(kGrowth),
                           Vec3d(origin) + Vec3d(kBrickDim + kGrowth)};
    const auto part = [&](int axis) { return std::size_t(origin[axis] >> 4 & 7); };
    const std::size_t table = bricks.place(b) / BrickIndex::kTableSize;
    std::int32_t& box = box_of[table * kClusters + (part(0) << 6 | part(1) << 3 | part(2))];
    if (box < 0) {
      box = std::int32_t(boxes.size());
      boxes.push_back(brick);
      continue;
    }
    for (int a = 0; a < 3; ++a) {
      boxes[box].first[a] = std::min(boxes[box].first[a], brick.first[a]);
      boxes[box].second[a] = std::max(boxes[box].second[a], brick.second[a]);
    }
  }
  return boxes;
}

void sort_and_merge(std::vector<Interval>& intervals) {
  std::sort(intervals.begin(), intervals.end(),
            [](const Interval& a, const Interval& b) { return a.begin < b.begin; });
  std::size_t kept = 0;
  for (const Interval& next : intervals) {
    if (kept > 0 && next.begin <= intervals[kept - 1].end) {
      intervals[kept - 1].end = std::max(intervals[kept - 1].end, next.end);
    } else {
      intervals[kept++] = next;
    }
  }
  intervals.resize(kept);
}

}  // namespace

struct VisibleBounds::Impl {
  std::vector<ClusterBox> boxes;
  std::optional<EmbreeScene> scene;  // when there are boxes
};

VisibleBounds::VisibleBounds(const BrickIndex& bricks, const std::vector<std::uint8_t>& visible)
    : m_impl(std::make_unique<Impl>()) {
  m_impl->boxes = cluster_boxes(bricks, visible);
  if (m_impl->boxes.empty()) return;
  RTCGeometry geometry = m_impl->scene.emplace(RTC_GEOMETRY_TYPE_USER).geometry();
  rtcSetGeometryUserPrimitiveCount(geometry, unsigned(m_impl->boxes.size()));
  rtcSetGeometryUserData(geometry, m_impl->boxes.data());
  rtcSetGeometryBoundsFunction(
      geometry, [](const RTCBoundsFunctionArguments* args) { box_bounds(args); }, nullptr);
  rtcSetGeometryIntersectFunction(geometry, collect);
  m_impl->scene->build(RTC_BUILD_QUALITY_LOW);
}

VisibleBounds::~VisibleBounds() = default;

void VisibleBounds::intervals(const IndexRay& ray, Interval within,
                              std::vector<Interval>& out) const {
  out.clear();
  if (m_impl->boxes.empty()) return;
  CollectContext context;
  rtcInitIntersectContext(&context.base);
  context.origin = ray.origin;
  for (int a = 0; a < 3; ++a) context.per_voxel[a] = 1 / ray.direction[a];
  context.within = within;
  context.out = &out;

  // The float ray starts where the ray enters the box, so that far cameras lose no precision.
  const Vec3f start(ray.at(within.begin)), direction(ray.direction);
  m_impl->scene->traverse(&context.base, start.getValue(), direction.getValue(),
                          float(within.end - within.begin) * 1.0001f + 1e-3f);
  sort_and_merge(out);
}

std::size_t VisibleBounds::bytes() const {
  return m_impl->boxes.capacity() * sizeof(ClusterBox) * 2;
}

}  // namespace supple
