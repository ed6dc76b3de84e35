// Contact of nodes with rigid shapes: nodes are projected onto the surface, with Coulomb friction.
//
// A node that ends a step inside a shape goes to the nearest point of its surface. Friction takes
// back up to mu times the depth of its motion along that surface. In one step of dt a force F into
// the surface makes the depth F dt^2 / m, so that this is Coulomb's law (Mueller et al., Position
// based dynamics, 2007). A node that is inside already when a step begins is put onto the surface
// first, without a velocity from that. Shapes are solid and looked at where they are at the end of
// a step: one that moves further than it is thick in one step may pass a node by.
//
// Cost: 3 to 22 ns per node and analytic shape, 2 to 4 us per node that is near a triangle mesh.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <variant>
#include <vector>

#include "volumes/base/vec.h"

namespace supple {

class MeshSurface;

struct SphereShape {
  Vec3d centre_mm;
  double radius_mm;
};
/// Solid behind the plane, free where the normal points.
struct PlaneShape {
  Vec3d point_mm;
  Vec3d normal;  // of length 1
};
/// All points within the radius of the segment a b.
struct CapsuleShape {
  Vec3d a_mm, b_mm;
  double radius_mm;
};
struct BoxShape {
  Vec3d centre_mm;
  std::array<Vec3d, 3> half_axes_mm;  // perpendicular to each other
};
/// A triangle mesh, moved by an offset; closed ones are solid, open ones are solid behind their
/// triangles' backs.
struct MeshShape {
  std::shared_ptr<const MeshSurface> surface;
  Vec3d offset_mm{0, 0, 0};
};
using Shape = std::variant<SphereShape, PlaneShape, CapsuleShape, BoxShape, MeshShape>;

struct Collider {
  Shape shape;
  double thickness_mm = 0;       // nodes keep this distance
  double friction = 0;           // Coulomb's mu
  Vec3d velocity_mm_s{0, 0, 0};  // of the shape, for friction; nothing moves it
};

/// Throws InputError: a radius or half axis that is not positive, a normal that is not of length 1,
/// half axes that are not perpendicular, a mesh that is missing, negative friction or thickness.
void validate(const Collider& collider);

Shape shifted(Shape shape, const Vec3d& by_mm);

/// Signed distance of a point, negative inside, and the direction in which it grows.
struct SurfaceDistance {
  double distance_mm;
  Vec3d normal;  // of length 1
};
SurfaceDistance distance_to(const Shape& shape, const Vec3d& pos_mm);

/// Depth of a point in the shape and the distance that it keeps, and the direction out; below 0
/// outside, where it stands for anything farther than `reach_mm`.
double depth_in(const Collider& collider, const Vec3d& pos_mm, double reach_mm, Vec3d& normal);

/// A point after friction took back its slip along the surface, up to mu times the depth to which
/// nothing but the surface kept it from going.
Vec3d after_friction(const Collider& collider, const Vec3d& normal, double depth_mm,
                     const Vec3d& start_mm, double dt_s, const Vec3d& pos_mm);

/// A node on the surface of a shape, and the force with which something presses it in.
struct PressedNode {
  int node, collider;
  Vec3d normal;  // out of the shape
  double force_mn;
};
/// Finds the free nodes that touch a shape and whose force points into it; the force loses that
/// part.
std::vector<PressedNode> take_pressure(const std::vector<Collider>& colliders,
                                       const std::vector<char>& is_held,
                                       const std::vector<Vec3d>& pos_mm,
                                       std::vector<Vec3d>& force_mn);

struct ContactReport {
  int contacts = 0;           // nodes that were moved out
  double penetration_mm = 0;  // deepest that is left, where shapes overlap
};

/// Moves one node out of all shapes; where several meet it takes up to 16 rounds. `start` is where
/// it began the step of dt_s, for friction. Returns the depth that is left.
double push_out(const std::vector<Collider>& colliders, const Vec3d& start_mm, double dt_s,
                Vec3d& pos_mm, bool& touched);

/// Takes every node that is not held out of the shapes, with neither friction nor velocity.
ContactReport leave_shapes(const std::vector<Collider>& colliders, const std::vector<char>& is_held,
                           std::vector<Vec3d>& pos_mm);

/// Ends a step: takes nodes out of the shapes, and sets the velocities of those that touch to
/// (pos - start) / dt.
ContactReport resolve_contacts(const std::vector<Collider>& colliders,
                               const std::vector<char>& is_held, const std::vector<Vec3d>& start_mm,
                               double dt_s, std::vector<Vec3d>& pos_mm,
                               std::vector<Vec3d>& velocity_mm_s);

// Contact of the sides of cuts in a step.

/// Drags that have no room are shortened to a multiple of this part.
constexpr int kContactParts = 1024;

struct SidesReport {
  std::int64_t overlapping = 0;  // points of lips that were behind the other lip
  double deepest_voxels = 0;     // of those that overlapped
  double max_move_voxels = 0;    // that took them apart
  std::int64_t left = 0;         // points that still are too deep behind it
  std::int64_t deepened = 0;     // of these, deeper than before the move
  double left_voxels = 0;        // the deepest of those that are left
  /// Voxel of a side at rest where the deepest point is, of those that are left if any are.
  Vec3i voxel{0, 0, 0};
  /// Part of the drag, in 1/kContactParts, for which elements held on both sides leave room.
  int parts = kContactParts;
  /// True where bones have moved and left no room: points that are left were pressed between them.
  bool is_crushed = false;
};

}  // namespace supple
