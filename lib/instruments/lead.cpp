// An instrument goes on as long as all of the way is known to be free; what stops it bends the rest
// of the way along the surface, and so on for some rounds; along sampled surfaces as long as that
// leads nearer to what is asked.
#include <algorithm>
#include <cmath>

#include "lib/contact/mesh_surface.h"
#include "lib/instruments/tool_contact.h"
#include "lib/instruments/tool_path.h"
#include "lib/instruments/track.h"
#include "volumes/base/units.h"

namespace supple {

namespace {

constexpr int kRounds = 6;
constexpr int kBends = 6;            // of one way along surfaces
constexpr double kUnseenMm = 4e-3;   // a part may enter a surface that far between two free poses
constexpr double kLiftMm = 2e-7;     // kept off a surface along which it slides
constexpr double kStopMm = 2e-5;     // a stop is found to this
constexpr double kTouchMm = 1e-4;    // what is nearer touches
constexpr double kPressedMm = 0.02;  // what slides under pressure may be so far off
constexpr int kMaxPoses = 4000;      // of one way

double thinnest(const RoundCone& cone) {
  return std::min(cone.a_radius_mm, cone.b_radius_mm);
}

/// Depth of a round cone behind a plane; negative before it.
double behind(const RoundCone& cone, const Vec3d& place_mm, const Vec3d& normal) {
  return -std::min(normal.dot(cone.a_mm - place_mm) - cone.a_radius_mm,
                   normal.dot(cone.b_mm - place_mm) - cone.b_radius_mm);
}

/// The ball at a part of the axis, as a round cone.
RoundCone between_ends(const RoundCone& cone, double part) {
  const Vec3d centre = cone.a_mm + (cone.b_mm - cone.a_mm) * part;
  const double radius = cone.a_radius_mm + (cone.b_radius_mm - cone.a_radius_mm) * part;
  return {centre, centre, radius, radius};
}

/// A pose, its parts and their distances, by obstacle and part.
struct PlacedTool {
  InstrumentPose pose;
  std::vector<RoundCone> parts;
  std::vector<double> rooms_mm;
};

class Leader {
 public:
  Leader(const Instrument& instrument, const InstrumentPose& from, const InstrumentPose& asked,
         const std::vector<Obstacle>& obstacles, const Vec3d* pivot)
      : m_tool(instrument), m_obstacles(obstacles), m_pivot(pivot), m_asked(led(asked)) {
    m_near_mm = 2 * ToolPath(from, m_asked, pivot).longest_mm(instrument) + 1;
    m_now = placed(from);
    // Parts that begin within a surface may stay as deep as they are.
    for (const double room : m_now.rooms_mm) m_least_mm.push_back(std::min(room, 0.0));
  }

  StoppedTool go() {
    bool is_sampled = false;
    for (int round = 0; round < kRounds; ++round) {
      const InstrumentPose before = m_now.pose;
      if (advance(m_asked)) break;
      const PlacedTool stopped = m_now;
      is_sampled = is_stopped_by_samples();
      advance(bent());
      if (is_sampled && left_mm(m_now.pose) > left_mm(stopped.pose)) {
        m_now = stopped;
        break;
      }
      m_along_mm += (m_now.pose.tip_mm - stopped.pose.tip_mm).length();
      if (is_same(before, m_now.pose)) break;
    }
    if (is_sampled) advance(m_asked);  // since such a slide may end off the surface
    m_now.pose.active = m_asked.active;
    return {m_now.pose, touches()};
  }

 private:
  struct Stop {
    std::size_t obstacle, part;
    Vec3d place_mm, normal;
  };

  InstrumentPose led(const InstrumentPose& pose) const {
    return m_pivot == nullptr ? pose : through_pivot(pose, *m_pivot);
  }

  double left_mm(const InstrumentPose& pose) const {
    return (m_asked.tip_mm - pose.tip_mm).length();
  }

  /// True where slides may lead astray, since samples have no normals but those between them.
  bool is_stopped_by_samples() const {
    return std::any_of(m_stops.begin(), m_stops.end(), [&](const Stop& stop) {
      return std::holds_alternative<VoxelSolid>(m_obstacles[stop.obstacle].surface);
    });
  }

  static bool is_same(const InstrumentPose& a, const InstrumentPose& b) {
    constexpr double kSame = 1e-3;  // mm and degrees
    return (a.tip_mm - b.tip_mm).length() < kSame &&
           (a.axis - b.axis).length() < kSame * kRadiansPerDegree &&
           std::abs(a.roll_degrees - b.roll_degrees) < kSame &&
           std::abs(a.opening_degrees - b.opening_degrees) < kSame;
  }

  /// Distance of a part, for meshes that are far away a lower bound beyond all ways of this step.
  double room_mm(const RoundCone& part, const RigidSurface& surface) const {
    if (const auto* mesh = std::get_if<MeshShape>(&surface)) {
      const Vec3d middle = (part.a_mm + part.b_mm) * 0.5 - mesh->offset_mm;
      const double around =
          (part.b_mm - part.a_mm).length() / 2 + std::max(part.a_radius_mm, part.b_radius_mm);
      if (mesh->surface->is_farther(middle, around + m_near_mm)) return m_near_mm;
    }
    return approach(part, surface).distance_mm;
  }

  PlacedTool placed(const InstrumentPose& pose) const {
    PlacedTool tool{pose, parts_at(m_tool, pose), {}};
    tool.rooms_mm.reserve(m_obstacles.size() * tool.parts.size());
    for (const Obstacle& obstacle : m_obstacles) {
      for (const RoundCone& part : tool.parts) {
        tool.rooms_mm.push_back(room_mm(part, obstacle.surface));
      }
    }
    return tool;
  }

  /// Pairs that are deeper at a pose than they may be.
  std::vector<std::size_t> entered(const PlacedTool& tool) const {
    std::vector<std::size_t> pairs;
    for (std::size_t n = 0; n < tool.rooms_mm.size(); ++n) {
      if (tool.rooms_mm[n] < m_least_mm[n]) pairs.push_back(n);
    }
    return pairs;
  }

  /// True if nothing enters a surface by more than kUnseenMm between the pose and the next one,
  /// both free.
  bool is_free(const PlacedTool& next, const ToolPath& path, double share) const {
    const std::size_t count = m_tool.parts.size();
    for (std::size_t p = 0; p < count; ++p) {
      const RoundCone &a = m_now.parts[p], &b = next.parts[p];
      const double way = std::max((b.a_mm - a.a_mm).length(), (b.b_mm - a.b_mm).length());
      const double unseen = kUnseenMm - path.sag_mm(m_tool, m_tool.parts[p], share);
      for (std::size_t o = 0; o < m_obstacles.size(); ++o) {
        const std::size_t n = o * count + p;
        const double first = m_now.rooms_mm[n], second = next.rooms_mm[n];
        if ((first + second - way) / 2 - m_least_mm[n] >= -unseen) continue;
        if (unseen < 0 || !is_passage(a, b, m_obstacles[o].surface, m_least_mm[n] - unseen)) {
          return false;
        }
      }
    }
    return true;
  }

  /// True if a part has a room of at least `least` while its ends go straight from one free place
  /// to another.
  static bool is_passage(const RoundCone& from, const RoundCone& to, const RigidSurface& surface,
                         double least_mm) {
    // Rooms in a ball and before a plane are concave along straight ways: least at an end.
    if (std::holds_alternative<HollowSphere>(surface)) return true;
    if (std::holds_alternative<PlaneShape>(surface)) return true;
    // A plane that touches something convex has all of it behind.
    const bool is_convex =
        !std::holds_alternative<MeshShape>(surface) && !std::holds_alternative<VoxelSolid>(surface);
    if (is_convex) {
      const Approach first = approach(from, surface), second = approach(to, surface);
      if (-behind(to, first.place_mm, first.normal) >= least_mm) return true;
      if (-behind(from, second.place_mm, second.normal) >= least_mm) return true;
    }
    // Rooms shrink no faster than balls go: half of each ball's way is taken off at both places.
    const double a_mm = (to.a_mm - from.a_mm).length(), b_mm = (to.b_mm - from.b_mm).length();
    const auto room = [&](const RoundCone& cone, double a_more_mm, double b_more_mm) {
      return approach(
                 {cone.a_mm, cone.b_mm, cone.a_radius_mm + a_more_mm, cone.b_radius_mm + b_more_mm},
                 surface)
          .distance_mm;
    };
    if (room(from, a_mm / 2, b_mm / 2) + room(to, a_mm / 2, b_mm / 2) >= 2 * least_mm) return true;
    // They are the least of distances from points, which dip below a chord by way² / 8 distance.
    const double dip = 1 / (8 * std::max(thinnest(from), 1e-3));
    const double a_dip = a_mm * a_mm * dip, b_dip = b_mm * b_mm * dip;
    return std::min(room(from, a_dip, b_dip), room(to, a_dip, b_dip)) >= least_mm;
  }

  /// Goes as far as the way is free; true at its end. Else it tells what stopped it.
  bool advance(const InstrumentPose& target) {
    const ToolPath path(m_now.pose, target, m_pivot);
    const double longest = path.longest_mm(m_tool);
    double done = 0, step = 1;
    m_stops.clear();
    for (int n = 0; n < kMaxPoses && done < 1; ++n) {
      const double to = std::min(1.0, done + step);
      PlacedTool next = placed(path.at(to));
      const std::vector<std::size_t> in = entered(next);
      if (in.empty() && is_free(next, path, to - done)) {
        m_now = std::move(next);
        done = to;
        step *= 2;
        continue;
      }
      if (step * longest < kStopMm) {
        for (const std::size_t pair : in) add_stop(pair);
        return false;
      }
      step = (to - done) * (in.empty() ? 0.5 : share_left(next, in));
    }
    return done >= 1;
  }

  /// Part of a way that is left by its end where rooms shrink evenly.
  double share_left(const PlacedTool& next, const std::vector<std::size_t>& in) const {
    double share = 0.9;
    for (const std::size_t n : in) {
      const double room = m_now.rooms_mm[n] - m_least_mm[n];
      share = std::min(share, room / (m_now.rooms_mm[n] - next.rooms_mm[n]));
    }
    return std::max(share, 1e-9);
  }

  void add_stop(std::size_t pair) {
    const std::size_t obstacle = pair / m_tool.parts.size(), part = pair % m_tool.parts.size();
    const Approach found = approach(m_now.parts[part], m_obstacles[obstacle].surface);
    m_stops.push_back({obstacle, part, found.place_mm, found.normal});
  }

  /// The way of a place that goes with the tip, along a normal, per way of the tip: all of it, but
  /// where a pivot turns the shaft the less the nearer the place is to the pivot.
  Vec3d response(const InstrumentPose& pose, const Vec3d& place_mm, const Vec3d& normal) const {
    if (m_pivot == nullptr) return normal;
    const double depth = (*m_pivot - pose.tip_mm).dot(pose.axis);
    if (std::abs(depth) < 1e-3) return normal;
    const Vec3d along = pose.axis * normal.dot(pose.axis);
    return along + (normal - along) * (1 - (place_mm - pose.tip_mm).dot(pose.axis) / depth);
  }

  /// Moves the tip of a pose so that a depth along the normal is left; a negative one is reached.
  void leave(InstrumentPose& pose, const Vec3d& place_mm, const Vec3d& normal, double depth_mm) {
    const Vec3d answer = response(pose, place_mm, normal);
    if (answer.length2() < 1e-2) return;
    pose.tip_mm += answer * (depth_mm / answer.length2());
    pose = led(pose);
  }

  /// The asked pose, out of what stopped it: first onto the planes that touch and that it is
  /// behind, to and fro since the shaft turns with the tip; then off the surfaces that bend away
  /// from these.
  InstrumentPose bent() {
    InstrumentPose pose = m_asked;
    std::vector<char> is_behind(m_stops.size(), 0);
    for (int n = 0; n < kBends; ++n) {
      for (std::size_t s = 0; s < m_stops.size(); ++s) {
        const Stop& stop = m_stops[s];
        const double depth = behind(parts_at(m_tool, pose)[stop.part], stop.place_mm, stop.normal) +
                             least_of(stop) + kLiftMm;
        if (depth > 0) is_behind[s] = 1;
        if (is_behind[s]) leave(pose, stop.place_mm, stop.normal, depth);
      }
    }
    for (int n = 0; n < kBends; ++n) {
      for (const Stop& stop : m_stops) {
        const Approach found =
            approach(parts_at(m_tool, pose)[stop.part], m_obstacles[stop.obstacle].surface);
        const double depth = least_of(stop) + kLiftMm - found.distance_mm;
        if (depth > 0) leave(pose, found.place_mm, found.normal, depth);
      }
    }
    return pose;
  }

  double least_of(const Stop& stop) const {
    return m_least_mm[stop.obstacle * m_tool.parts.size() + stop.part];
  }

  /// One touch for each obstacle: that of the part that is pressed deepest.
  std::vector<ToolTouch> touches() const {
    const std::vector<RoundCone> asked = parts_at(m_tool, m_asked);
    std::vector<ToolTouch> all;
    for (std::size_t o = 0; o < m_obstacles.size(); ++o) {
      ToolTouch deepest{int(o), 0, {}, {}, 0, 0, m_along_mm};
      for (std::size_t p = 0; p < asked.size(); ++p) {
        if (m_now.rooms_mm[o * asked.size() + p] >= kPressedMm) continue;
        const RigidSurface& surface = m_obstacles[o].surface;
        const Approach here = approach(m_now.parts[p], surface);
        // A part that a hand has led through a thin wall is beyond it: the ball that touches tells
        // how far.
        const double t = nearest_part(here.place_mm, m_now.parts[p]);
        const RoundCone ball = between_ends(asked[p], t);
        const double depth = std::max(-approach(asked[p], surface).distance_mm,
                                      behind(ball, here.place_mm, here.normal) - kTouchMm);
        if (depth <= deepest.asked_mm) continue;
        deepest.part = int(p);
        deepest.place_mm = here.place_mm;
        deepest.normal = here.normal;
        deepest.asked_mm = depth;
      }
      if (deepest.asked_mm <= 0) continue;
      deepest.force_n = deepest.asked_mm * kMPerMm * m_tool.stiffness_n_m;
      all.push_back(deepest);
    }
    return all;
  }

  const Instrument& m_tool;
  const std::vector<Obstacle>& m_obstacles;
  const Vec3d* m_pivot;
  InstrumentPose m_asked;
  double m_near_mm = 0;
  PlacedTool m_now;
  std::vector<double> m_least_mm;  // by obstacle and part
  std::vector<Stop> m_stops;       // of the last way
  double m_along_mm = 0;
};

}  // namespace

StoppedTool lead(const Instrument& instrument, const InstrumentPose& from,
                 const InstrumentPose& asked, const std::vector<Obstacle>& obstacles,
                 const Vec3d* pivot) {
  return Leader(instrument, from, asked, obstacles, pivot).go();
}

}  // namespace supple
