#include "lib/operation/operation.h"

#include <algorithm>
#include <cmath>

#include "lib/instruments/track.h"
#include "volumes/base/error.h"
#include "volumes/base/sha256.h"
#include "volumes/base/stopwatch.h"
#include "volumes/base/text.h"
#include "volumes/base/units.h"

namespace supple {

namespace {

constexpr double kSameTime_s = 1e-9;

const char* kind_name(MembraneEvent::Kind kind) {
  switch (kind) {
    case MembraneEvent::Kind::link_broken:
      return "link_broken";
    case MembraneEvent::Kind::edge_torn:
      return "edge_torn";
    case MembraneEvent::Kind::gripped:
      return "gripped";
    case MembraneEvent::Kind::released:
      return "released";
    case MembraneEvent::Kind::piece_lost:
      return "piece_lost";
  }
  return "";
}

}  // namespace

struct Operation::Impl {
  OperationSetup setup;
  std::vector<Instrument> instruments;
  std::vector<const Incision*> incisions;  // per instrument; null: none
  std::vector<Obstacle> obstacles;
  std::vector<Membrane> membranes;
  std::unique_ptr<Vitreous> vitreous;
  std::unique_ptr<PushedBody> volume;
  PushReport pushed;
  EyeTurn turn;
  std::vector<Bleeding> bleedings;
  OperationSample sample;
  OperationTimes times;
  std::int64_t steps = 0;

  explicit Impl(const OperationSetup& given);
  void require_substeps() const;
  void require_poses(const std::vector<InstrumentPose>& asked) const;
  const Incision* find_incision(const OperationTool& tool) const;
  void require_free(const InstrumentPose& pose, std::size_t n) const;
  void add_event(const std::string& kind, int tool, const std::string& at, const Vec3d& place_mm,
                 double value);
  InstrumentPose in_eye(const InstrumentPose& pose) const;
  void turn_eye(const std::vector<InstrumentPose>& asked);
  std::vector<ToolMotion> lead_instruments(const std::vector<InstrumentPose>& asked);
  void tell_touches(std::size_t n, const std::vector<ToolTouch>& touches);
  void bleed(const ToolTouch& touch, int tool);
  void grow_bleedings();
  void move_vitreous(const std::vector<ToolMotion>& motions);
  void move_membranes(const std::vector<ToolMotion>& motions);
};

const Incision* Operation::Impl::find_incision(const OperationTool& tool) const {
  if (tool.incision.empty()) return nullptr;
  std::string known;
  if (setup.eye) {
    for (const Incision& incision : setup.eye->incisions) {
      if (incision.name == tool.incision) return &incision;
      known += (known.empty() ? "" : ", ") + incision.name;
    }
  }
  throw InputError({"", "incision", tool.incision, known.empty() ? "a table [eye]" : known});
}

void Operation::Impl::require_free(const InstrumentPose& pose, std::size_t n) const {
  for (const RoundCone& part : parts_at(instruments[n], pose)) {
    for (const Obstacle& obstacle : obstacles) {
      const double distance_mm = approach(part, obstacle.surface).distance_mm;
      if (distance_mm >= -1e-6) continue;
      throw InputError({"", "start of " + instruments[n].name,
                        number_text(-distance_mm) + " mm within " + obstacle.name,
                        "a pose that is free of all surfaces"});
    }
  }
}

/// A step is a whole number of each membrane's substeps.
void Operation::Impl::require_substeps() const {
  for (const OperationMembrane& one : setup.membranes) {
    const double count = setup.step_s / one.params.substep_s;
    if (std::abs(count - std::round(count)) < 1e-6 && count > 0.5) continue;
    throw InputError({"", "substep of " + one.name, number_text(one.params.substep_s) + " s",
                      "a whole part of the step of " + number_text(setup.step_s) + " s"});
  }
}

void Operation::Impl::require_poses(const std::vector<InstrumentPose>& asked) const {
  if (asked.size() != instruments.size()) {
    throw InputError({"", "poses", std::to_string(asked.size()),
                      "one for each of " + std::to_string(instruments.size()) + " instruments"});
  }
  for (std::size_t n = 0; n < asked.size(); ++n) {
    const InstrumentPose& pose = asked[n];
    const double numbers = pose.roll_degrees + pose.opening_degrees + pose.active;
    const bool is_whole = is_finite(pose.tip_mm) && is_finite(pose.axis) &&
                          std::isfinite(numbers) && pose.axis.length() > 0;
    if (is_whole) continue;
    throw InputError({"", "pose of " + instruments[n].name,
                      "a number that is not finite, or no axis", "finite numbers and a direction"});
  }
}

Operation::Impl::Impl(const OperationSetup& given) : setup(given), obstacles(given.shapes) {
  if (setup.eye) {
    for (Incision& incision : setup.eye->incisions) {
      incision.place_mm *= setup.eye->radius_mm / incision.place_mm.length();
    }
    const std::vector<Obstacle> eye = obstacles_of(*setup.eye);
    obstacles.insert(obstacles.begin(), eye.begin(), eye.end());
  }
  for (const OperationTool& tool : setup.tools) {
    instruments.push_back(make_instrument(tool.shape));
    incisions.push_back(find_incision(tool));
    InstrumentPose start = tool.start;
    if (incisions.back() != nullptr) start = through_pivot(start, incisions.back()->place_mm);
    require_free(start, instruments.size() - 1);
    sample.instruments.push_back({start, start, 0});
  }
  require_substeps();
  for (const OperationMembrane& one : setup.membranes) {
    membranes.emplace_back(one.mesh, one.params, obstacles, one.name);
    sample.membranes.push_back({one.name, membranes.back().clinging_mm2()});
    sample.clinging_mm2 += membranes.back().clinging_mm2();
  }
  if (setup.vitreous) {
    vitreous = std::make_unique<Vitreous>(*setup.vitreous, Vec3d(0.0), setup.seed, obstacles);
  }
  if (setup.volume) {
    volume = std::make_unique<PushedBody>(*setup.volume->body, setup.volume->held);
  }
}

void Operation::Impl::add_event(const std::string& kind, int tool, const std::string& at,
                                const Vec3d& place_mm, double value) {
  sample.events.push_back({sample.time_s, kind,
                           tool < 0 ? std::string() : instruments[std::size_t(tool)].name, at,
                           place_mm, value});
}

InstrumentPose Operation::Impl::in_eye(const InstrumentPose& pose) const {
  InstrumentPose found = pose;
  found.tip_mm = turn.to_eye(pose.tip_mm);
  found.axis = turn.to_eye(pose.axis);
  return found;
}

void Operation::Impl::turn_eye(const std::vector<InstrumentPose>& asked) {
  if (!setup.eye) return;
  std::vector<Shaft> shafts;
  for (std::size_t n = 0; n < asked.size(); ++n) {
    if (incisions[n] == nullptr) continue;
    shafts.push_back({asked[n].tip_mm, asked[n].axis, incisions[n]->place_mm});
  }
  turn = next_turn(*setup.eye, turn, shafts, setup.step_s);
  sample.turn_degrees = turn.vector * kDegreesPerRadian;
}

/// A touch where a spot will grow to belongs to that spot.
void Operation::Impl::bleed(const ToolTouch& touch, int tool) {
  const double radius_mm = setup.eye->largest_spot_mm;
  const bool is_known = std::any_of(bleedings.begin(), bleedings.end(), [&](const Bleeding& spot) {
    return (spot.place_mm - touch.place_mm).length() < radius_mm;
  });
  if (is_known) return;
  bleedings.push_back({touch.place_mm, 0.05});
  add_event("bleeding", tool, kRetina, touch.place_mm, kPi * radius_mm * radius_mm);
}

void Operation::Impl::grow_bleedings() {
  for (Bleeding& spot : bleedings) {
    spot.radius_mm = std::min(spot.radius_mm + setup.eye->bleeding_mm_s * setup.step_s,
                              setup.eye->largest_spot_mm);
  }
}

/// One event per surface that is touched, with the force of all touches of it.
void Operation::Impl::tell_touches(std::size_t n, const std::vector<ToolTouch>& touches) {
  std::vector<double> force_n(obstacles.size(), 0);
  std::vector<const ToolTouch*> hardest(obstacles.size(), nullptr);
  for (const ToolTouch& touch : touches) {
    const std::size_t at = std::size_t(touch.obstacle);
    force_n[at] += touch.force_n;
    if (hardest[at] == nullptr || touch.force_n > hardest[at]->force_n) hardest[at] = &touch;
  }
  for (std::size_t at = 0; at < obstacles.size(); ++at) {
    if (hardest[at] == nullptr) continue;
    sample.instruments[n].force_n += force_n[at];
    add_event("touch", int(n), obstacles[at].name, hardest[at]->place_mm, force_n[at]);
    const bool bleeds =
        setup.eye && obstacles[at].name == kRetina && force_n[at] >= setup.eye->bleeds_from_n;
    if (bleeds) bleed(*hardest[at], int(n));
  }
}

std::vector<ToolMotion> Operation::Impl::lead_instruments(
    const std::vector<InstrumentPose>& asked) {
  std::vector<ToolMotion> motions;
  for (std::size_t n = 0; n < asked.size(); ++n) {
    InstrumentSample& one = sample.instruments[n];
    const InstrumentPose from = one.pose;
    one.asked = in_eye(asked[n]);
    one.force_n = one.pull_n = 0;
    const Vec3d* pivot = incisions[n] == nullptr ? nullptr : &incisions[n]->place_mm;
    const StoppedTool stopped = lead(instruments[n], from, one.asked, obstacles, pivot);
    one.pose = stopped.pose;
    tell_touches(n, stopped.touches);
    motions.push_back(motion_of(int(n), instruments[n], from, one.pose));
  }
  return motions;
}

void Operation::Impl::move_vitreous(const std::vector<ToolMotion>& motions) {
  if (!vitreous) return;
  const VitreousReport report = vitreous->step(motions, instruments);
  sample.vitreous_left = vitreous->left_part();
  if (report.removed == 0) return;
  for (const ToolMotion& motion : motions) {
    const std::optional<SuctionPort>& port = instruments[std::size_t(motion.tool)].port;
    if (!port || motion.to.active <= 0) continue;
    const Vec3d place = frame_of(motion.to).place(port->centre_mm);
    add_event("removed", motion.tool, "vitreous", place, double(report.removed));
    break;
  }
}

void Operation::Impl::move_membranes(const std::vector<ToolMotion>& motions) {
  sample.clinging_mm2 = 0;
  for (std::size_t n = 0; n < membranes.size(); ++n) {
    Membrane& membrane = membranes[n];
    for (const ModelChange& change : setup.membranes[n].changes) {
      const bool is_now = change.time_s <= sample.time_s + kSameTime_s &&
                          change.time_s > sample.time_s - setup.step_s + kSameTime_s;
      if (is_now) membrane.take_model(change.model);
    }
    const double clung_mm2 = membrane.clinging_mm2(), tore_mm = membrane.torn_mm();
    const MembraneReport report = membrane.step(setup.step_s, motions, instruments);
    const double clinging_mm2 = membrane.clinging_mm2();
    for (const MembraneEvent& event : report.events) {
      double value = double(event.count);
      if (event.kind == MembraneEvent::Kind::link_broken) value = clung_mm2 - clinging_mm2;
      if (event.kind == MembraneEvent::Kind::edge_torn) value = membrane.torn_mm() - tore_mm;
      add_event(kind_name(event.kind), event.tool, membrane.name(), event.place_mm, value);
    }
    for (std::size_t tool = 0; tool < report.tool_forces_n.size(); ++tool) {
      sample.instruments[tool].pull_n += report.tool_forces_n[tool].length();
    }
    sample.membranes[n] = {membrane.name(), clinging_mm2, report.inverted, report.longest_stretch,
                           report.pinched};
    sample.clinging_mm2 += clinging_mm2;
  }
}

Operation::Operation(const OperationSetup& setup) : m_impl(std::make_unique<Impl>(setup)) {}
Operation::~Operation() = default;
Operation::Operation(Operation&&) noexcept = default;

const OperationSample& Operation::step(const std::vector<InstrumentPose>& asked) {
  Impl& in = *m_impl;
  in.require_poses(asked);
  in.sample.events.clear();
  in.sample.time_s = double(++in.steps) * in.setup.step_s;
  const Stopwatch whole;
  in.turn_eye(asked);
  const std::vector<ToolMotion> motions = in.lead_instruments(asked);
  in.times.contact_ms = whole.ms();
  const Stopwatch vitreous;
  in.move_vitreous(motions);
  in.times.vitreous_ms = vitreous.ms();
  const Stopwatch volume;
  if (in.volume) in.pushed = in.volume->push(parts_of(motions));
  in.times.volume_ms = volume.ms();
  const Stopwatch membranes;
  in.move_membranes(motions);
  in.times.membranes_ms = membranes.ms();
  if (in.setup.eye) in.grow_bleedings();
  in.times.total_ms = whole.ms();
  return in.sample;
}

void Operation::take_model(std::size_t membrane, MembraneModel model) {
  const double next_s = double(m_impl->steps + 1) * m_impl->setup.step_s;
  m_impl->setup.membranes.at(membrane).changes.push_back({next_s, model});
}

const OperationSetup& Operation::setup() const {
  return m_impl->setup;
}
const OperationSample& Operation::sample() const {
  return m_impl->sample;
}
const OperationTimes& Operation::times() const {
  return m_impl->times;
}
const std::vector<Instrument>& Operation::instruments() const {
  return m_impl->instruments;
}
const std::vector<Obstacle>& Operation::obstacles() const {
  return m_impl->obstacles;
}
const std::vector<Membrane>& Operation::membranes() const {
  return m_impl->membranes;
}
const Vitreous* Operation::vitreous() const {
  return m_impl->vitreous.get();
}
const PushReport& Operation::pushed() const {
  return m_impl->pushed;
}
const EyeTurn& Operation::turn() const {
  return m_impl->turn;
}
const std::vector<Bleeding>& Operation::bleedings() const {
  return m_impl->bleedings;
}

std::string Operation::digest() const {
  const Impl& in = *m_impl;
  Sha256 digest;
  const auto feed = [&](double value) { digest.update(&value, sizeof value); };
  const auto feed_place = [&](const Vec3d& place) {
    for (int c = 0; c < 3; ++c) feed(place[c]);
  };
  for (const InstrumentSample& one : in.sample.instruments) {
    feed_place(one.pose.tip_mm);
    feed_place(one.pose.axis);
    feed(one.pose.roll_degrees);
    feed(one.pose.opening_degrees);
    feed(one.pose.active);
  }
  feed_place(in.turn.vector);
  for (const Bleeding& spot : in.bleedings) {
    feed_place(spot.place_mm);
    feed(spot.radius_mm);
  }
  for (const Membrane& membrane : in.membranes) {
    const std::string bytes = membrane.state_bytes();
    digest.update(bytes.data(), bytes.size());
  }
  if (in.vitreous) {
    const std::string bytes = in.vitreous->state_bytes();
    digest.update(bytes.data(), bytes.size());
  }
  if (in.volume) {
    const std::string bytes = in.volume->state_bytes();
    digest.update(bytes.data(), bytes.size());
  }
  return digest.hex();
}

}  // namespace supple
