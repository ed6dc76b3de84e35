#include "lib/operation/vitreous.h"

#include <algorithm>
#include <cmath>

#include "lib/instruments/round_cone.h"
#include "lib/operation/pushed_body.h"
#include "lib/operation/vitreous_body.h"

namespace supple {

namespace {

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
       const std::vector<Obstacle>& outside)
      : Impl(make_vitreous(setup, centre_mm, seed, outside)) {}
  explicit Impl(VitreousAtRest start)
      : all_density(start.density),
        body(std::move(start.body)),
        pushed(body, start.shell),
        left_count(body.elements.active_count()),
        changed(body.elements.brick_count(), 0),
        density(all_density) {}

  void remove(const std::vector<PortReach>& ports);

  DensityGrid all_density;
  Body body;
  PushedBody pushed;
  std::int64_t left_count;
  std::vector<Slot> removed;
  std::int64_t steps = 0;
  std::vector<std::int64_t> changed;  // per brick: the last step that did
  mutable DensityGrid density;
  mutable bool is_density_old = false;
};

void Vitreous::Impl::remove(const std::vector<PortReach>& ports) {
  std::vector<RoundCone> reaches;
  for (const PortReach& port : ports) reaches.push_back(port.swept);
  removed = pushed.remove(reaches, [&](const Vec3d& place_mm) {
    return std::any_of(ports.begin(), ports.end(),
                       [&](const PortReach& port) { return port.holds(place_mm); });
  });
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
  const PushReport pushed = impl.pushed.push(parts_of(tools));
  impl.remove(ports_of(tools, instruments));
  ++impl.steps;
  for (const SlotSet::Brick& brick : moved()) impl.changed[brick.brick] = impl.steps;
  for (const Slot slot : impl.removed) impl.changed[slot / kBrickVoxels] = impl.steps;
  return {pushed.moved, std::int64_t(impl.removed.size()), pushed.stopped, pushed.deepest_mm};
}

const Geometry& Vitreous::geometry() const {
  return m_impl->body.geometry;
}

const DensityGrid& Vitreous::density() const {
  const Impl& impl = *m_impl;
  if (std::exchange(impl.is_density_old, false)) {
    impl.density = restrict_to(
        impl.all_density, BrickTopology(impl.body.elements.index().origins(), impl.pushed.left()));
  }
  return impl.density;
}

const Body& Vitreous::body() const {
  return m_impl->body;
}

bool Vitreous::is_left(Slot slot) const {
  return mask_test(m_impl->pushed.left()[slot / kBrickVoxels], int(slot % kBrickVoxels));
}

double Vitreous::left_part() const {
  return double(m_impl->left_count) / double(m_impl->body.elements.active_count());
}

const std::vector<SlotSet::Brick>& Vitreous::moved() const {
  return m_impl->pushed.moved();
}

const std::vector<Slot>& Vitreous::removed() const {
  return m_impl->removed;
}

const BrickMask& Vitreous::left(std::size_t brick) const {
  return m_impl->pushed.left()[brick];
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
  return m_impl->pushed.state_bytes();
}

}  // namespace supple
