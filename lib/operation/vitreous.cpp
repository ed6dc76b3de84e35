#include "lib/operation/vitreous.h"

#include <algorithm>
#include <cmath>

#include "lib/instruments/round_cone.h"
#include "lib/operation/one_sided_push.h"
#include "lib/operation/vitreous_body.h"
#include "volumes/base/parallel.h"

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

/// Space that the port of a tool reaches in a step.
struct PortReach {
  RoundCone swept;
  Vec3d outward;
  bool holds(const Vec3d& place_mm) const {
    const Vec3d centre = swept.a_mm + (swept.b_mm - swept.a_mm) * nearest_part(place_mm, swept);
    const Vec3d from = place_mm - centre;
    return from.dot(outward) >= 0 && from.length() <= swept.a_radius_mm;
  }
};

std::vector<PortReach> ports_of(const std::vector<ToolMotion>& tools,
                                const std::vector<Instrument>& instruments) {
  std::vector<PortReach> ports;
  for (const ToolMotion& tool : tools) {
    const auto& port = instruments[std::size_t(tool.tool)].port;
    if (!port || !(tool.to.active > 0)) continue;
    const ToolFrame from = frame_of(tool.from), to = frame_of(tool.to);
    ports.push_back(
        {{from.place(port->centre_mm), to.place(port->centre_mm), port->reach_mm, port->reach_mm},
         to.direction(port->outward)});
  }
  return ports;
}

}  // namespace

struct Vitreous::Impl {
  Impl(const VitreousSetup& setup, const Vec3d& centre_mm, std::uint64_t seed,
       const std::vector<Obstacle>& outside);

  Vec3d place_mm(std::size_t b, int offset) const;
  bool is_near(std::size_t b, const RoundCone& cone) const {
    return approach(balls[b].middle_mm, cone).distance_mm <= balls[b].radius_mm;
  }
  std::vector<std::size_t> bricks_near(const std::vector<RoundCone>& cones) const;
  std::vector<Entered> entered(const std::vector<RoundCone>& cones) const;
  void push_out(const std::vector<Entered>& list);
  void remove(const std::vector<PortReach>& ports);
  void cut_links(Slot slot);

  double spacing_mm;
  DensityGrid all_density;
  Body body;
  std::unique_ptr<OneSidedPush> pusher;
  std::vector<BrickMask> left;  // per brick of the elements
  std::int64_t left_count = 0;
  /// Ball around all elements that are left in a brick.
  struct Ball {
    Vec3d middle_mm;
    double radius_mm;
  };
  std::vector<Ball> balls;
  std::vector<SlotSet::Brick> moved;
  std::vector<Slot> removed;
  std::int64_t steps = 0;
  std::vector<std::int64_t> changed;  // per brick: the last step that did
  mutable DensityGrid density;
  mutable bool is_density_old = false;

  void find_ball(std::size_t b);
};

Vitreous::Impl::Impl(const VitreousSetup& setup, const Vec3d& centre_mm, std::uint64_t seed,
                     const std::vector<Obstacle>& outside)
    : spacing_mm(setup.spacing_mm) {
  VitreousAtRest start = make_vitreous(setup, centre_mm, seed, outside);
  body = std::move(start.body);
  density = all_density = start.density;
  pusher = std::make_unique<OneSidedPush>(body, start.shell);
  const BrickTopology& elements = body.elements;
  for (std::size_t b = 0; b < elements.brick_count(); ++b) left.push_back(elements.mask(b));
  left_count = elements.active_count();
  changed.assign(elements.brick_count(), 0);
  balls.resize(elements.brick_count());
  parallel_for(balls.size(), [&](std::size_t b) { find_ball(b); });
}

Vec3d Vitreous::Impl::place_mm(std::size_t b, int offset) const {
  const Vec3i voxel = body.elements.origin(b) + brick_local(offset);
  Vec3d place = body.geometry.origin_lps_mm();
  for (int c = 0; c < 3; ++c) {
    const std::int32_t q = body.q[std::size_t(c)].brick_or_zero(b)[offset];
    place[c] += (voxel[c] + q / kFixedOne) * spacing_mm;
  }
  return place;
}

void Vitreous::Impl::find_ball(std::size_t b) {
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
  balls[b] = {body.geometry.origin_lps_mm() + (lo + hi) * (spacing_mm / 2),
              (hi - lo).length() * spacing_mm / 2};
}

std::vector<std::size_t> Vitreous::Impl::bricks_near(const std::vector<RoundCone>& cones) const {
  std::vector<std::size_t> near;
  for (std::size_t b = 0; b < balls.size(); ++b) {
    const bool is_wanted = std::any_of(cones.begin(), cones.end(),
                                       [&](const RoundCone& cone) { return is_near(b, cone); });
    if (is_wanted) near.push_back(b);
  }
  return near;
}

/// Elements in the cones, in the order of their slots.
std::vector<Entered> Vitreous::Impl::entered(const std::vector<RoundCone>& cones) const {
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
      Vec3d normal;
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
      const Vec3d out = normal * (deepest / spacing_mm - kSkinVoxels);
      found[n].push_back({Slot(b * kBrickVoxels + std::size_t(offset)), out, deepest});
    });
  });
  std::vector<Entered> all;
  for (const auto& list : found) all.insert(all.end(), list.begin(), list.end());
  return all;
}

void Vitreous::Impl::push_out(const std::vector<Entered>& list) {
  OneSidedAsks asks;
  for (const Entered& element : list) {
    for (std::size_t c = 0; c < 3; ++c) {
      const auto by = std::int32_t(std::lround(element.out[int(c)] * kFixedOne));
      if (by == 0) continue;
      auto& side = by > 0 ? asks.at_least[c] : asks.at_most[c];
      side.push_back({element.slot, body.q[c].at(element.slot) + by});
    }
  }
  const std::vector<std::size_t> touched = pusher->push(std::move(asks));
  parallel_for(touched.size(), Grain{8}, [&](std::size_t n) { find_ball(touched[n]); });
}

void Vitreous::Impl::cut_links(Slot slot) {
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

void Vitreous::Impl::remove(const std::vector<PortReach>& ports) {
  removed.clear();
  if (ports.empty()) return;
  std::vector<RoundCone> reaches;
  for (const PortReach& port : ports) reaches.push_back(port.swept);
  for (const std::size_t b : bricks_near(reaches)) {
    BrickMask kept = left[b];
    for_each_active(left[b], [&](int offset) {
      const Vec3d place = place_mm(b, offset);
      const bool is_taken = std::any_of(ports.begin(), ports.end(),
                                        [&](const PortReach& port) { return port.holds(place); });
      if (!is_taken) return;
      kept[std::size_t(offset) / 64] &= ~(std::uint64_t(1) << (offset % 64));
      removed.push_back(Slot(b * kBrickVoxels + std::size_t(offset)));
    });
    if (kept == left[b]) continue;
    left[b] = kept;
    find_ball(b);
  }
  for (const Slot slot : removed) cut_links(slot);
  left_count -= std::int64_t(removed.size());
  is_density_old = is_density_old || !removed.empty();
}

Vitreous::Vitreous(const VitreousSetup& setup, const Vec3d& centre_mm, std::uint64_t seed,
                   const std::vector<Obstacle>& outside)
    : m_impl(std::make_unique<Impl>(setup, centre_mm, seed, outside)) {}
Vitreous::~Vitreous() = default;
Vitreous::Vitreous(Vitreous&&) noexcept = default;

VitreousReport Vitreous::step(const std::vector<ToolMotion>& tools,
                              const std::vector<Instrument>& instruments) {
  Impl& impl = *m_impl;
  impl.pusher->clear_changes();
  std::vector<MovingPart> parts;
  double way = 0;
  for (const ToolMotion& tool : tools) {
    for (const MovingPart& part : tool.parts) {
      parts.push_back(part);
      way = std::max(way, way_in_radii(part, impl.spacing_mm / 2));
    }
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

  VitreousReport report;
  for (const Entered& element : list) {
    report.deepest_mm = std::max(report.deepest_mm, element.depth_mm);
  }
  report.stopped = report.deepest_mm > impl.spacing_mm;
  impl.moved = impl.pusher->changes();
  for (const SlotSet::Brick& brick : impl.moved) report.moved += mask_count(brick.mask);
  impl.remove(ports_of(tools, instruments));
  ++impl.steps;
  for (const SlotSet::Brick& brick : impl.moved) impl.changed[brick.brick] = impl.steps;
  for (const Slot slot : impl.removed) impl.changed[slot / kBrickVoxels] = impl.steps;
  report.removed = std::int64_t(impl.removed.size());
  return report;
}

const Geometry& Vitreous::geometry() const {
  return m_impl->body.geometry;
}

const DensityGrid& Vitreous::density() const {
  const Impl& impl = *m_impl;
  if (std::exchange(impl.is_density_old, false)) {
    impl.density = restrict_to(impl.all_density,
                               BrickTopology(impl.body.elements.index().origins(), impl.left));
  }
  return impl.density;
}

const Body& Vitreous::body() const {
  return m_impl->body;
}

bool Vitreous::is_left(Slot slot) const {
  return mask_test(m_impl->left[slot / kBrickVoxels], int(slot % kBrickVoxels));
}

double Vitreous::left_part() const {
  return double(m_impl->left_count) / double(m_impl->body.elements.active_count());
}

const std::vector<SlotSet::Brick>& Vitreous::moved() const {
  return m_impl->moved;
}

const std::vector<Slot>& Vitreous::removed() const {
  return m_impl->removed;
}

const BrickMask& Vitreous::left(std::size_t brick) const {
  return m_impl->left[brick];
}

std::int64_t Vitreous::steps() const {
  return m_impl->steps;
}

std::vector<std::size_t> Vitreous::changed_since(std::int64_t step) const {
  std::vector<std::size_t> list;
  for (std::size_t b = 0; b < m_impl->changed.size(); ++b) {
    if (m_impl->changed[b] > step) list.push_back(b);
  }
  return list;
}

std::string Vitreous::state_bytes() const {
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

}  // namespace supple
