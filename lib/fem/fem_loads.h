// What acts on a body: prescribed displacements, forces, pressures and gravity, and the nodal
// values that these become. Forces of pressures are the integrals of the shape functions, exact for
// the constant fields that they are; that of gravity is an eighth per corner, likewise.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "lib/body/rigid_pieces.h"
#include "lib/body/slot_set.h"
#include "lib/fem/cell_classes.h"
#include "lib/fem/hex_mesh.h"

namespace supple {

/// Small displacements, of which forces are linear; or any (finite_strain.h).
enum class StrainTheory { linear, finite };

/// A node that is prescribed a displacement of its own.
struct NodeGrip {
  NodeIndex node;
  Vec3d u_mm;
  double share = 1;  // of the force on the node, others that hold it have the rest
};

/// Elements whose corners are prescribed a displacement, as a handle or an anchor does.
struct HeldElements {
  SlotSet elements;
  /// Of a node at rest at a position in LPS mm; null: none, that is an anchor.
  std::function<Vec3d(const Vec3d& rest_mm)> displacement_mm;
  /// The components of LPS that are prescribed; the others move freely.
  std::array<bool, 3> axes{true, true, true};
  /// Which corners of the elements; null: all eight.
  std::function<bool(const Vec3d& rest_mm)> holds_node;
  /// Instead of what stands above: these nodes of the elements, ascending, in all components.
  std::optional<std::vector<NodeGrip>> nodes = {};
};

/// A force that the elements share by their volume, and each of them by its corners.
struct ForceOnElements {
  SlotSet elements;
  Vec3d force_n{0, 0, 0};  // in all, LPS
};

/// On faces of elements behind which there is no element, or a cut link.
struct PressureOnFaces {
  SlotSet elements;
  double pressure_kpa = 0;  // pushes inwards when positive
  /// Which faces, by their centre at rest and their outward unit normal, LPS; null: all.
  std::function<bool(const Vec3d& centre_mm, const Vec3d& normal)> includes;
};

/// An isotropic stress inside elements that pushes their neighbours away, as a swelling does.
struct PressureInElements {
  SlotSet elements;
  double pressure_kpa = 0;
};

/// Displacements in mm, LPS, three per node: of an equilibrium from which another goes on.
using NodeStart = std::vector<float>;

struct FemLoads {
  /// A node that several hold obeys the first. Those that share it have it where they agree.
  std::vector<HeldElements> held;
  std::vector<ForceOnElements> forces;
  std::vector<PressureOnFaces> face_pressures;
  std::vector<PressureInElements> inner_pressures;
  Vec3d gravity_m_s2{0, 0, 0};  // LPS
  /// kg/m^3 per class; only with gravity.
  std::array<double, kLastClass + 1> mass_density{};
  /// In mN/mm^3 at rest positions, LPS, by one point per node; null: none. For manufactured
  /// solutions and fields of force.
  std::function<Vec3d(const Vec3d& rest_mm)> body_force;
};

/// The loads at the nodes, three values each.
struct NodalLoads {
  HeldBits held;
  std::vector<double> u_mm;                      // prescribed values, 0 where a component is free
  std::vector<double> force_mn;                  // empty where no force acts
  std::vector<double> swelling_kpa;              // per element; linear theory has forces for it
  std::vector<std::vector<NodeIndex>> nodes_of;  // per HeldElements: the nodes that it holds
  /// Shares of the forces on these; empty: the whole of all.
  std::vector<std::vector<double>> shares_of;
  /// Forces on nodes by elements that are held as a whole, three per node; empty where these have
  /// none. No unknown changes them, and they may be far above all that is solved for: bone beside a
  /// lip that is led away.
  std::vector<double> within_held_mn;

  /// Of the n-th node of nodes_of[of].
  double share(std::size_t of, std::size_t n) const {
    return of >= shares_of.size() || shares_of[of].empty() ? 1 : shares_of[of][n];
  }
};

/// Throws InputError: an element that the mesh does not have, a value that is not finite.
NodalLoads nodal_loads(const HexMesh& voxels, const VoxelMaterial& material, const FemLoads& loads,
                       StrainTheory strain = StrainTheory::linear);

/// NodalLoads::within_held_mn in linear theory.
std::vector<double> forces_within_held(const HexMesh& voxels, const VoxelMaterial& material,
                                       const NodalLoads& loads);

/// How loads grow from nothing to the whole, for problems that are solved in steps: forces in
/// proportion; what is held goes along its rigid motion, so that a turn stays one on the way.
class LoadPath {
 public:
  /// Keeps the prescribed displacements of `loads`, and `loads` itself for the rest, without
  /// u_mm: it must outlive this.
  LoadPath(const HexMesh& voxels, const NodalLoads& loads);

  /// Writes the prescribed displacements at a part 0 ... 1 of the loads, and nothing else.
  void prescribe(double part, std::vector<double>& u_mm) const;
  std::size_t bytes() const;

 private:
  struct Grip {
    const std::vector<NodeIndex>* nodes;
    const std::vector<double>* shares;   // null: the whole of all
    std::vector<Vec3d> rest_mm, end_mm;  // per node: where it rests, and its whole displacement
    bool is_rigid;                       // all three components are held
    RigidMotion motion;                  // nearest to the displacements

    /// Displacement of the n-th node on the way, of which the rigid motion is there.
    Vec3d at(double part, const RigidMotion& on_the_way, std::size_t n) const;
  };
  const NodalLoads* m_loads;
  std::vector<Grip> m_grips;
};

}  // namespace supple
