// Loads on a body of voxels: prescribed displacements, forces, pressures and gravity, and the nodal
// values that these become (nodal_loads.h). Forces of pressures are the integrals of the shape
// functions, exact for the constant fields that they are; that of gravity is an eighth per corner,
// likewise.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "lib/body/slot_set.h"
#include "lib/fem/elastic_law.h"
#include "lib/fem/nodal_loads.h"
#include "lib/fem/voxel/hex_mesh.h"
#include "lib/fem/voxel/voxel_material.h"

namespace supple {

/// A node that is prescribed a displacement of its own.
struct NodeGrip {
  NodeIndex node;
  Vec3d u_mm;
  double share = 1;  // of the force on the node, others that hold it have the rest
};

/// Elements whose corners are prescribed a displacement, as a handle or an anchor does.
struct HeldElements {
  SlotSet elements;
  /// Displacement of a node at rest at a position in LPS mm; null: none, that is an anchor.
  std::function<Vec3d(const Vec3d& rest_mm)> displacement_mm;
  /// The components of LPS that are prescribed; the others move freely.
  std::array<bool, 3> axes{true, true, true};
  /// Chooses corners of the elements; null: all eight.
  std::function<bool(const Vec3d& rest_mm)> holds_node;
  /// Nodes of the elements that are held in all components, ascending, in place of the above.
  std::optional<std::vector<NodeGrip>> nodes = {};
};

/// A force that the elements share by their volume, and each of them by its corners.
struct ForceOnElements {
  SlotSet elements;
  Vec3d force_n{0, 0, 0};  // in all, LPS
};

/// Pressure on faces of elements behind which there is no element, or a cut link.
struct PressureOnFaces {
  SlotSet elements;
  double pressure_kpa = 0;  // pushes inwards when positive
  /// Chooses faces by their centre at rest and their outward unit normal, LPS; null: all.
  std::function<bool(const Vec3d& centre_mm, const Vec3d& normal)> includes;
};

/// An isotropic stress inside elements that pushes their neighbours away, as a swelling does.
struct PressureInElements {
  SlotSet elements;
  double pressure_kpa = 0;
};

struct FemLoads {
  /// A node that several hold obeys the first. Those that share it have it where they agree.
  std::vector<HeldElements> held;
  std::vector<ForceOnElements> forces;
  std::vector<PressureOnFaces> face_pressures;
  std::vector<PressureInElements> inner_pressures;
  Vec3d gravity_m_s2{0, 0, 0};  // LPS
  /// kg/m^3 per class; only with gravity.
  std::array<double, kLastClass + 1> mass_density{};
  /// Force in mN/mm^3 at rest positions, LPS, by one point per node; null: none. For manufactured
  /// solutions and fields of force.
  std::function<Vec3d(const Vec3d& rest_mm)> body_force;
};

/// Throws InputError: an element that the mesh does not have, a value that is not finite.
NodalLoads nodal_loads(const HexMesh& voxels, const VoxelMaterial& material, const FemLoads& loads,
                       StrainTheory strain = StrainTheory::linear);

/// The held components alone.
HeldBits held_bits(const HexMesh& voxels, const std::vector<HeldElements>& held);

/// NodalLoads::within_held_mn in linear theory.
std::vector<double> forces_within_held(const HexMesh& voxels, const VoxelMaterial& material,
                                       const NodalLoads& loads);

}  // namespace supple
