#include "lib/operation/pushed_body.h"

#include <algorithm>
#include <cmath>

#include "lib/instruments/round_cone.h"
#include "lib/operation/anchored_elements.h"
#include "lib/operation/one_sided_push.h"
#include "volumes/base/parallel.h"
#include "volumes/grid/mask_steps.h"

namespace supple {

namespace {

constexpr double kWay = 0.8;       // of a substep, in radii of the thinnest moving part
constexpr int kMostSubsteps = 16;  // of a step
/// Depth up to which elements stay in a tool: neighbours on both sides of a thin one then need not
/// be further apart than links let them.
constexpr double kSkinVoxels = 0.3;

/// Longest way of an end, in units of the radius there.
double way_in_radii(const MovingPart& part, double least_radius_mm) {
  const auto of = [&](const Vec3d& from, const Vec3d& to, double radius) {
    return (to - from).length() / std::max(radius, least_radius_mm);
  };
  return std::max(of(part.from.a_mm, part.to.a_mm, part.to.a_radius_mm),
                  of(part.from.b_mm, part.to.b_mm, part.to.b_radius_mm));
}

/// An element in a tool: its way out, in voxels, and how deep it is.
struct Entered {
  Slot slot;
  Vec3d out;
  double depth_mm;
};

/// True where a place is outside of a cone for sure; cheaper than approach().
bool is_clear_of(const Vec3d& place_mm, const RoundCone& cone) {
  const Vec3d axis = cone.b_mm - cone.a_mm, from = place_mm - cone.a_mm;
  const double along = from.dot(axis), square = axis.dot(axis);
  const double part = along <= 0 ? 0 : along >= square ? 1 : along / square;
  const Vec3d off = from - axis * part;
  const double radius = std::max(cone.a_radius_mm, cone.b_radius_mm);
  return off.dot(off) > radius * radius;
}

/// Box around cones: rules most bricks of a large body out.
struct ConeBox {
  Vec3d lo{HUGE_VAL}, hi{-HUGE_VAL};

  explicit ConeBox(const std::vector<RoundCone>& cones) {
    for (const RoundCone& cone : cones) {
      const double radius = std::max(cone.a_radius_mm, cone.b_radius_mm);
      for (int c = 0; c < 3; ++c) {
        lo[c] = std::min({lo[c], cone.a_mm[c] - radius, cone.b_mm[c] - radius});
        hi[c] = std::max({hi[c], cone.a_mm[c] + radius, cone.b_mm[c] + radius});
      }
    }
  }
  bool meets(const Vec3d& middle, double radius) const {
    for (int c = 0; c < 3; ++c) {
      if (middle[c] + radius < lo[c] || middle[c] - radius > hi[c]) return false;
    }
    return true;
  }
};

}  // namespace

struct PushedBody::Impl {
  Impl(Body& given, const SlotSet& fixed);

  Vec3d index_of(std::size_t b, int offset) const;
  Vec3d place_mm(std::size_t b, int offset) const {
    return body.geometry.world_from_index(index_of(b, offset));
  }
  bool is_near(std::size_t b, const RoundCone& cone) const {
    return approach(balls[b].middle_mm, cone).distance_mm <= balls[b].radius_mm;
  }
  std::vector<std::size_t> bricks_near(const std::vector<RoundCone>& cones) const;
  std::vector<Entered> entered(const std::vector<RoundCone>& cones) const;
  void push_out(const std::vector<Entered>& list);
  void cut_links(Slot slot);
  void find_adrift();
  void find_ball(std::size_t b);

  Body& body;
  double spacing_mm;  // the least
  OneSidedPush pusher;
  SlotSet held;
  std::vector<BrickMask> left;    // per brick of the elements
  std::vector<BrickMask> adrift;  // of those that are left, when something was removed
  /// Ball around all elements that are left in a brick.
  struct Ball {
    Vec3d middle_mm;
    double radius_mm;
  };
  std::vector<Ball> balls;
  std::vector<SlotSet::Brick> moved;
};

PushedBody::Impl::Impl(Body& given, const SlotSet& fixed)
    : body(given), pusher(given, fixed), held(fixed) {
  const Vec3d spacing = body.geometry.spacing_mm();
  spacing_mm = std::min({spacing.x, spacing.y, spacing.z});
  const BrickTopology& elements = body.elements;
  for (std::size_t b = 0; b < elements.brick_count(); ++b) left.push_back(elements.mask(b));
  balls.resize(elements.brick_count());
  parallel_for(balls.size(), [&](std::size_t b) { find_ball(b); });
}

Vec3d PushedBody::Impl::index_of(std::size_t b, int offset) const {
  Vec3d index(body.elements.origin(b) + brick_local(offset));
  for (int c = 0; c < 3; ++c) {
    index[c] += body.q[std::size_t(c)].brick_or_zero(b)[offset] / kFixedOne;
  }
  return index;
}

void PushedBody::Impl::find_ball(std::size_t b) {
  if (left[b] == BrickMask{}) {
    balls[b] = {Vec3d(0), -1e300};
    return;
  }
  Vec3d lo(body.elements.origin(b)), hi = lo + Vec3d(kBrickDim - 1);
  for (int c = 0; c < 3; ++c) {
    const std::int32_t* q = body.q[std::size_t(c)].brick_or_zero(b);
    std::int32_t least = q[0], most = q[0];
    for (int n = 1; n < kBrickVoxels; ++n) {
      least = std::min(least, q[n]);
      most = std::max(most, q[n]);
    }
    lo[c] += least / kFixedOne;
    hi[c] += most / kFixedOne;
  }
  const Vec3d half = (hi - lo) * 0.5;
  double radius_mm = 0;
  for (const double x : {-half.x, half.x}) {
    for (const double y : {-half.y, half.y}) {
      const Vec3d corner = body.geometry.world_vector_from_index({x, y, half.z});
      radius_mm = std::max(radius_mm, corner.length());
    }
  }
  balls[b] = {body.geometry.world_from_index((lo + hi) * 0.5), radius_mm};
}

std::vector<std::size_t> PushedBody::Impl::bricks_near(const std::vector<RoundCone>& cones) const {
  const ConeBox box(cones);
  std::vector<std::size_t> near;
  for (std::size_t b = 0; b < balls.size(); ++b) {
    if (!box.meets(balls[b].middle_mm, balls[b].radius_mm)) continue;
    const bool is_wanted = std::any_of(cones.begin(), cones.end(),
                                       [&](const RoundCone& cone) { return is_near(b, cone); });
    if (is_wanted) near.push_back(b);
  }
  return near;
}

/// Elements in the cones, in the order of their slots.
std::vector<Entered> PushedBody::Impl::entered(const std::vector<RoundCone>& cones) const {
  const std::vector<std::size_t> near = bricks_near(cones);
  std::vector<std::vector<Entered>> found(near.size());
  parallel_for(near.size(), Grain{2}, [&](std::size_t n) {
    const std::size_t b = near[n];
    std::vector<RoundCone> of_brick;
    for (const RoundCone& cone : cones) {
      if (is_near(b, cone)) of_brick.push_back(cone);
    }
    for_each_active(left[b], [&](int offset) {
      const Vec3d place = place_mm(b, offset);
      double deepest = kSkinVoxels * spacing_mm;
      Vec3d normal(0.0);
      bool is_in = false;
      for (const RoundCone& cone : of_brick) {
        if (is_clear_of(place, cone)) continue;
        const Approach to_cone = approach(place, cone);
        if (-to_cone.distance_mm <= deepest) continue;
        is_in = true;
        deepest = -to_cone.distance_mm;
        normal = to_cone.normal;
      }
      if (!is_in) return;
      const Vec3d out =
          body.geometry.index_vector_from_world(normal * (deepest - kSkinVoxels * spacing_mm));
      found[n].push_back({Slot(b * kBrickVoxels + std::size_t(offset)), out, deepest});
    });
  });
  std::vector<Entered> all;
  for (const auto& list : found) all.insert(all.end(), list.begin(), list.end());
  return all;
}

void PushedBody::Impl::push_out(const std::vector<Entered>& list) {
  OneSidedAsks asks;
  for (const Entered& element : list) {
    for (std::size_t c = 0; c < 3; ++c) {
      const auto by = std::int32_t(std::lround(element.out[int(c)] * kFixedOne));
      if (by == 0) continue;
      auto& side = by > 0 ? asks.at_least[c] : asks.at_most[c];
      side.push_back({element.slot, body.q[c].at(element.slot) + by});
    }
  }
  const std::vector<std::size_t> touched = pusher.push(std::move(asks));
  parallel_for(touched.size(), Grain{8}, [&](std::size_t n) { find_ball(touched[n]); });
}

void PushedBody::Impl::cut_links(Slot slot) {
  for (int axis = 0; axis < 3; ++axis) {
    Slot other;
    if (neighbour_slot(body.elements, body.cuts, slot, axis, true, other)) {
      body.cuts.cut(slot / kBrickVoxels, int(slot % kBrickVoxels), axis);
    }
    if (neighbour_slot(body.elements, body.cuts, slot, axis, false, other)) {
      body.cuts.cut(other / kBrickVoxels, int(other % kBrickVoxels), axis);
    }
  }
}

/// Looks for pieces that have lost their anchors.
void PushedBody::Impl::find_adrift() {
  const std::vector<BrickMask> anchored = anchored_elements(body.elements, body.cuts, left, held);
  adrift.resize(left.size());
  std::vector<SlotSet::Brick> lost;
  for (std::size_t b = 0; b < left.size(); ++b) {
    BrickMask now = left[b];
    take_out(anchored[b], now);
    BrickMask more = now;
    take_out(adrift[b], more);
    if (more != BrickMask{}) lost.push_back({std::uint32_t(b), more});
    adrift[b] = now;
  }
  pusher.set_adrift(SlotSet(std::move(lost)));
}

PushedBody::PushedBody(Body& body, const SlotSet& held)
    : m_impl(std::make_unique<Impl>(body, held)) {}
PushedBody::~PushedBody() = default;

PushReport PushedBody::push(const std::vector<MovingPart>& parts) {
  Impl& impl = *m_impl;
  impl.pusher.clear_changes();
  double way = 0;
  for (const MovingPart& part : parts) {
    way = std::max(way, way_in_radii(part, impl.spacing_mm / 2));
  }
  const int substeps = std::clamp(int(std::ceil(way / kWay)), 1, kMostSubsteps);
  std::vector<Entered> list;
  for (int n = 1; n <= substeps; ++n) {
    std::vector<RoundCone> cones;
    for (const MovingPart& part : parts) {
      cones.push_back(between(part.from, part.to, double(n) / substeps));
    }
    list = impl.entered(cones);
    if (list.empty()) continue;
    impl.push_out(list);
    if (n == substeps) list = impl.entered(cones);
  }

  PushReport report;
  for (const Entered& element : list) {
    report.deepest_mm = std::max(report.deepest_mm, element.depth_mm);
  }
  report.stopped = report.deepest_mm > impl.spacing_mm;
  impl.moved = impl.pusher.changes();
  for (const SlotSet::Brick& brick : impl.moved) report.moved += mask_count(brick.mask);
  return report;
}

const std::vector<SlotSet::Brick>& PushedBody::moved() const {
  return m_impl->moved;
}

std::vector<Slot> PushedBody::remove(
    const std::vector<RoundCone>& cones,
    const std::function<bool(const Vec3d& place_mm)>& is_asked_for) {
  Impl& impl = *m_impl;
  std::vector<Slot> removed;
  if (cones.empty()) return removed;
  for (const std::size_t b : impl.bricks_near(cones)) {
    BrickMask kept = impl.left[b];
    for_each_active(impl.left[b], [&](int offset) {
      if (!is_asked_for(impl.place_mm(b, offset))) return;
      kept[std::size_t(offset) / 64] &= ~(std::uint64_t(1) << (offset % 64));
      removed.push_back(Slot(b * kBrickVoxels + std::size_t(offset)));
    });
    if (kept == impl.left[b]) continue;
    impl.left[b] = kept;
    impl.find_ball(b);
  }
  for (const Slot slot : removed) impl.cut_links(slot);
  if (!removed.empty()) impl.find_adrift();
  return removed;
}

const std::vector<BrickMask>& PushedBody::left() const {
  return m_impl->left;
}

std::int64_t PushedBody::adrift() const {
  std::int64_t count = 0;
  for (const BrickMask& mask : m_impl->adrift) count += mask_count(mask);
  return count;
}

std::string PushedBody::state_bytes() const {
  const Impl& impl = *m_impl;
  std::string bytes(reinterpret_cast<const char*>(impl.left.data()),
                    impl.left.size() * sizeof(BrickMask));
  for (const BrickValues& coordinate : impl.body.q) {
    for (std::size_t b = 0; b < impl.left.size(); ++b) {
      bytes.append(reinterpret_cast<const char*>(coordinate.brick_or_zero(b)),
                   kBrickVoxels * sizeof(std::int32_t));
    }
  }
  return bytes;
}

std::optional<VoxelSolid> solid_of(const Body& body) {
  std::vector<Vec3i> voxels;
  for (const RigidPiece& piece : body.rigid.list) {
    piece.elements->for_each([&](Slot slot) {
      Vec3i voxel = voxel_of(body.elements, slot);
      for (int c = 0; c < 3; ++c) {
        voxel[c] += int(std::lround(body.q[std::size_t(c)].at(slot) / kFixedOne));
      }
      voxels.push_back(voxel);
    });
  }
  if (voxels.empty()) return std::nullopt;
  return VoxelSolid(body.geometry, voxels);
}

std::vector<MovingPart> parts_of(const std::vector<ToolMotion>& tools) {
  std::vector<MovingPart> parts;
  for (const ToolMotion& tool : tools) {
    parts.insert(parts.end(), tool.parts.begin(), tool.parts.end());
  }
  return parts;
}

}  // namespace supple
