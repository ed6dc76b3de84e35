// Rigid instruments against rigid surfaces: continuous, so that nothing tunnels. The pose that a
// hand asks for becomes one that enters no surface; the tip slides along it.
#pragma once

#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "lib/contact/collider_contact.h"
#include "lib/instruments/instrument.h"
#include "lib/instruments/voxel_solid.h"

namespace supple {

/// Free space inside of a sphere, such as the eyeball; a part passes its wall at an incision, a
/// gate, where its axis goes by within `gate_mm`.
struct HollowSphere {
  Vec3d centre_mm;
  double radius_mm;
  std::vector<Vec3d> gates_mm = {};
  double gate_mm = 0;
};
/// Solid lens: the points in both balls.
struct LensShape {
  SphereShape front, back;
};
using RigidSurface =
    std::variant<HollowSphere, LensShape, SphereShape, PlaneShape, MeshShape, VoxelSolid>;

struct Obstacle {
  std::string name;
  RigidSurface surface;
};

/// Finds how near a round cone is to a surface, negative where it enters. Exact up to rounding, for
/// meshes and solids of voxels up to 1 um, and up to 2 % of what is beyond their neighbourhood of a
/// radius.
Approach approach(const RoundCone& part, const RigidSurface& surface);

struct ToolTouch {
  int obstacle;  // index
  int part;      // of the instrument
  Vec3d place_mm, normal;
  double asked_mm;  // depth to which the hand has led it
  double force_n;   // with which the hand presses: depth times the instrument's stiffness
  double along_mm;  // way along the surface in this step
};

struct StoppedTool {
  InstrumentPose pose;  // outside of all obstacles by at least 0, up to rounding of 1e-6 mm
  std::vector<ToolTouch> touches;
};
/// Leads an instrument from a free pose towards the pose that the hand asks for, and stops it at
/// obstacles. `pivot`: the shaft goes through it, where there is one. Never further into a surface
/// than `from` by more than 1e-6 mm.
StoppedTool lead(const Instrument& instrument, const InstrumentPose& from,
                 const InstrumentPose& asked, const std::vector<Obstacle>& obstacles,
                 const Vec3d* pivot = nullptr);

}  // namespace supple
