#include "tools/scene/augment/random_motion.h"

#include <algorithm>
#include <limits>

#include "lib/body/slot_set.h"
#include "volumes/base/error.h"

namespace supple::tools {

namespace {

double between(RandomNumbers& random, double lo, double hi) {
  return lo + (hi - lo) * random.next();
}

/// A whole number from 0 to below `count`, which is above 0.
std::size_t below(RandomNumbers& random, std::size_t count) {
  return std::size_t(between(random, 0, double(count)));
}

/// A direction of length 1, without functions that differ between machines.
Vec3d direction(RandomNumbers& random) {
  for (;;) {
    const double x = between(random, -1, 1), y = between(random, -1, 1), z = between(random, -1, 1);
    const Vec3d way(x, y, z);
    const double length = way.length();
    if (length > 0.1 && length <= 1) return way / length;
  }
}

struct DrawnHandle {
  Vec3i centre;
  double radius_mm;
  Vec3d by_mm;
};

bool is_apart(const DrawnHandle& a, const DrawnHandle& b, const Geometry& geometry) {
  const double distance_mm = geometry.world_vector_from_index(Vec3d(a.centre - b.centre)).length();
  return distance_mm > a.radius_mm + b.radius_mm + a.by_mm.length() + b.by_mm.length();
}

/// Distance from an element to the nearest rigid one, where that is below `most_mm`.
double distance_to_bone(const Body& body, const Vec3i& centre, double most_mm) {
  const Vec3d spacing = body.geometry.spacing_mm();
  Vec3i reach;
  for (int a = 0; a < 3; ++a) reach[a] = int(most_mm / spacing[a]);
  double nearest = most_mm;
  for (int i = -reach.x; i <= reach.x; ++i) {
    for (int j = -reach.y; j <= reach.y; ++j) {
      for (int k = -reach.z; k <= reach.z; ++k) {
        const Vec3i step(i, j, k);
        const double distance = body.geometry.world_vector_from_index(Vec3d(step)).length();
        Slot slot = 0;
        if (distance >= nearest || !slot_of(body.elements, centre + step, slot)) continue;
        if (body.rigid.at(slot) >= 0) nearest = distance;
      }
    }
  }
  return nearest;
}

/// The number of the rigid piece with the most elements; 0 where there is none.
std::size_t largest_piece(const Body& body) {
  const auto is_smaller = [](const RigidPiece& a, const RigidPiece& b) {
    return a.elements->size() < b.elements->size();
  };
  const std::vector<RigidPiece>& pieces = body.rigid.list;
  return std::size_t(std::max_element(pieces.begin(), pieces.end(), is_smaller) - pieces.begin());
}

/// A voxel of the largest piece as the list of what a step holds; null where there is no piece.
Value fixed_piece(const Body& body) {
  Value fixed;
  if (body.rigid.list.empty()) return fixed;
  const RigidPiece& piece = body.rigid.list[largest_piece(body)];
  fixed.push_back(voxel_of(body.elements, piece.elements->first()));
  return fixed;
}

/// Balls of soft tissue that are dragged apart from each other, each by its own way.
DrawnMotion draw_drag(const DrawnBody& body, const DrawnLimits& limits, RandomNumbers& random) {
  if (body.free.empty()) {
    throw InputError({"", "body", "no element that is free to move", "soft tissue"});
  }
  const Geometry& geometry = body.session.geometry();
  const BrickTopology& elements = body.session.body().elements;
  const Vec3d spacing = geometry.spacing_mm();
  const double least_mm = std::min({spacing.x, spacing.y, spacing.z});
  const std::size_t wanted = 1 + below(random, std::size_t(limits.handles));
  std::vector<DrawnHandle> handles;
  constexpr int kMostTries = 50;
  for (int tries = 0; tries < kMostTries && handles.size() < wanted; ++tries) {
    const Slot slot = body.free[below(random, body.free.size())];
    const double drawn_mm = std::max(between(random, 0.5, 1) * limits.radius_mm, least_mm);
    const Vec3i centre = voxel_of(elements, slot);
    // Short of the bone, which tissue may take along, but no handle; and less far than half the
    // ball is wide, since tissue would fold in front of it, and not so little that nobody sees it.
    const double radius_mm =
        std::max(distance_to_bone(body.session.body(), centre, drawn_mm) - least_mm / 2, 0.0);
    const double way_mm =
        between(random, 0.4, 1) * std::min(limits.reach_mm, std::max(0.6 * radius_mm, least_mm));
    const DrawnHandle handle{centre, radius_mm, direction(random) * way_mm};
    const bool fits = std::all_of(handles.begin(), handles.end(), [&](const DrawnHandle& other) {
      return is_apart(handle, other, geometry);
    });
    if (fits) handles.push_back(handle);
  }
  return [handles, fixed = fixed_piece(body.session.body())](double part) {
    Value keys;
    if (!fixed.is_null()) keys["fix"] = fixed;
    for (const DrawnHandle& handle : handles) {
      keys["handles"].push_back({{"grab_ball", Vec3d(handle.centre)},
                                 {"radius", handle.radius_mm},
                                 {"by", handle.by_mm * part},
                                 {"spare_fixed", true}});
    }
    return keys;
  };
}

/// Some voxels of a piece, evenly among its elements.
std::vector<Vec3i> some_voxels(const RigidPiece& piece, const BrickTopology& elements) {
  constexpr std::size_t kMost = 1500;
  const std::size_t step = piece.elements->size() / kMost + 1;
  std::vector<Vec3i> voxels;
  std::size_t n = 0;
  piece.elements->for_each([&](Slot slot) {
    if (n++ % step == 0) voxels.push_back(voxel_of(elements, slot));
  });
  return voxels;
}

/// The place of a piece that is nearest to another one, about which it turns.
Vec3i joint_of(const std::vector<Vec3i>& piece, const std::vector<std::vector<Vec3i>>& others,
               const Geometry& geometry) {
  double nearest = std::numeric_limits<double>::infinity();
  Vec3i joint = piece.front();
  for (const std::vector<Vec3i>& other : others) {
    for (const Vec3i& a : piece) {
      for (const Vec3i& b : other) {
        const double distance = geometry.world_vector_from_index(Vec3d(a - b)).length2();
        if (distance >= nearest) continue;
        nearest = distance;
        joint = a;
      }
    }
  }
  return joint;
}

/// A rigid piece that turns about its joint while the largest one is held.
DrawnMotion draw_joint(const DrawnBody& body, const DrawnLimits& limits, RandomNumbers& random) {
  const Body& solid = body.session.body();
  const std::vector<RigidPiece>& pieces = solid.rigid.list;
  if (pieces.empty()) {
    throw InputError({"", "rigid pieces", "none",
                      "bones that move, such as --material ct-head has, or --rigid"});
  }
  const std::size_t largest = largest_piece(solid);
  std::size_t turned = below(random, std::max<std::size_t>(pieces.size() - 1, 1));
  if (pieces.size() > 1 && turned >= largest) ++turned;

  std::vector<std::vector<Vec3i>> others;
  for (std::size_t n = 0; n < pieces.size(); ++n) {
    if (n != turned) others.push_back(some_voxels(pieces[n], solid.elements));
  }
  const std::vector<Vec3i> own = some_voxels(pieces[turned], solid.elements);
  const Vec3i joint = joint_of(own, others, body.session.geometry());
  const Vec3d axis = direction(random);
  const double angle_deg = between(random, -limits.turn_deg, limits.turn_deg);
  const Value fixed = pieces.size() > 1 ? fixed_piece(solid) : Value();
  return [=, grabbed = own.front()](double part) {
    Value keys;
    keys["handles"].push_back(
        {{"grab", grabbed}, {"rotate", angle_deg * part}, {"axis", axis}, {"about", Vec3d(joint)}});
    if (!fixed.is_null()) keys["fix"] = fixed;
    return keys;
  };
}

}  // namespace

Fields fields(DrawnLimits& limits) {
  return {
      Field("handles", limits.handles, "Handles of a drag, 1 to so many").range(1, 20),
      Field("reach", limits.reach_mm, "Way of a handle at most, less where tissue would fold")
          .unit("mm")
          .range(0, 1000),
      Field("radius", limits.radius_mm,
            "Radius of what a handle grabs, half of it to so much, less near bone")
          .unit("mm")
          .range(0, 1000),
      Field("turn", limits.turn_deg, "Turn of a joint either way, 0 to so much")
          .unit("degrees")
          .range(0, 90),
  };
}

DrawnBody::DrawnBody(const Session& of) : session(of) {
  const SlotSet held = of.held();
  const Body& body = of.body();
  for_each_element(body.elements, [&](Slot slot) {
    if (body.rigid.at(slot) < 0 && !held.contains(slot)) free.push_back(slot);
  });
}

const std::deque<RandomMotion>& random_motions() {
  static const std::deque<RandomMotion> motions{
      {"drag", "balls of soft tissue, each its own way", draw_drag},
      {"joint", "a rigid piece turns about the place nearest to another one", draw_joint},
  };
  return motions;
}

}  // namespace supple::tools
