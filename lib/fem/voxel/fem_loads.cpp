#include "lib/fem/voxel/fem_loads.h"

#include <algorithm>

#include "lib/fem/voxel/cell_classes.h"
#include "lib/fem/voxel/voxel_nodes.h"
#include "volumes/base/error.h"
#include "volumes/base/parallel.h"
#include "volumes/base/units.h"
#include "volumes/grid/brick_topology.h"

namespace supple {

namespace {

/// (kg/m^3) (m/s^2) mm^3 in mN.
constexpr double kWeightMn = 1e-6;
constexpr Grain kBlocks{16};

template <class Visit>
void for_each_element(const HexMesh& mesh, const SlotSet& slots, Visit&& visit) {
  slots.for_each([&](Slot slot) {
    const std::size_t block = slot / kBrickVoxels;
    const std::int32_t element = element_at(mesh, block, int(slot % kBrickVoxels));
    if (element < 0) {
      throw InputError({"", "finite elements", "a load on a voxel that is no element", "elements"});
    }
    visit(std::int32_t(block), element);
  });
}

void require_finite(const Vec3d& value, const char* what) {
  if (is_finite(value)) return;
  throw InputError({"", what, "a value that is not finite", "numbers"});
}

/// Nodes of the elements, ascending, each once; with positions where `where` asks for them.
std::vector<NodeIndex> nodes_of_elements(const HexMesh& mesh, const SlotSet& elements,
                                         const std::function<bool(const Vec3d&)>& where) {
  std::vector<bool> is_of(std::size_t(mesh.node_count()));
  std::size_t count = 0;
  for_each_element(mesh, elements, [&](std::int32_t block, std::int32_t e) {
    const Corners corners = mesh.corners_in(std::size_t(block), e);
    for (int c = 0; c < 8; ++c) {
      const auto node = std::size_t(corners[c]);
      if (is_of[node]) continue;
      if (where && !where(corner_position(mesh, block, mesh.offset[e], c))) continue;
      is_of[node] = true;
      ++count;
    }
  });
  std::vector<NodeIndex> nodes;
  nodes.reserve(count);
  for (std::size_t node = 0; nodes.size() < count; ++node) {
    if (is_of[node]) nodes.push_back(NodeIndex(node));
  }
  return nodes;
}

/// Nodes with displacements of their own.
void hold(const std::vector<NodeGrip>& held, NodalLoads& out) {
  std::vector<NodeIndex> nodes;
  std::vector<double> shares;
  for (const NodeGrip& own : held) {
    const bool is_shared = own.share < 1;
    if (!is_shared && out.held[own.node] != 0) continue;
    require_finite(own.u_mm, "displacement");
    for (int a = 0; a < 3; ++a) out.u_mm[3 * std::size_t(own.node) + a] = own.u_mm[a];
    nodes.push_back(own.node);
    if (is_shared && shares.empty()) shares.assign(nodes.size() - 1, 1);
    if (is_shared || !shares.empty()) shares.push_back(own.share);
  }
  for (const NodeIndex node : nodes) out.held[node] = 7;
  out.nodes_of.push_back(std::move(nodes));
  out.shares_of.push_back(std::move(shares));
}

void hold(const HexMesh& mesh, const HeldElements& held, NodalLoads& out) {
  if (held.nodes) {
    hold(*held.nodes, out);
    return;
  }
  std::vector<NodeIndex> nodes = nodes_of_elements(mesh, held.elements, held.holds_node);
  std::uint8_t bits = 0;
  for (int a = 0; a < 3; ++a) bits = std::uint8_t(bits | (held.axes[a] ? 1 << a : 0));
  // Nodes that an earlier load holds already are not this one's.
  nodes.erase(std::remove_if(nodes.begin(), nodes.end(),
                             [&](NodeIndex n) { return (out.held[n] & bits) != 0; }),
              nodes.end());
  if (held.displacement_mm) {
    for_each_element(mesh, held.elements, [&](std::int32_t block, std::int32_t e) {
      const Corners corners = mesh.corners_in(std::size_t(block), e);
      for (int c = 0; c < 8; ++c) {
        const NodeIndex node = corners[c];
        if (!std::binary_search(nodes.begin(), nodes.end(), node)) continue;
        const Vec3d u = held.displacement_mm(corner_position(mesh, block, mesh.offset[e], c));
        require_finite(u, "displacement");
        for (int a = 0; a < 3; ++a) {
          if (held.axes[a]) out.u_mm[3 * std::size_t(node) + a] = u[a];
        }
      }
    });
  }
  for (const NodeIndex node : nodes) out.held[node] = std::uint8_t(out.held[node] | bits);
  out.nodes_of.push_back(std::move(nodes));
  out.shares_of.emplace_back();
}

void add_to_node(const Vec3d& force, NodeIndex node, std::vector<double>& sum) {
  for (int a = 0; a < 3; ++a) sum[3 * std::size_t(node) + a] += force[a];
}

constexpr int kAxisBits[3] = {4, 2, 1};

void press_faces(const HexMesh& mesh, const PressureOnFaces& pressure, std::vector<double>& force) {
  const BrickIndex index(mesh.origin);
  const std::array<Vec3d, 3> axes = mesh.geometry.axes_mm();
  const double hand = mesh.geometry.determinant() > 0 ? 1 : -1;
  for_each_element(mesh, pressure.elements, [&](std::int32_t block, std::int32_t e) {
    const Corners corners = mesh.corners_in(std::size_t(block), e);
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3d area = axes[(axis + 1) % 3].cross(axes[(axis + 2) % 3]) * hand;
      for (const bool is_high : {false, true}) {
        if (element_across(mesh, index, std::size_t(block), e, axis, is_high) >= 0) continue;
        const Vec3d outward = is_high ? area : -area;
        const Vec3d centre =
            (corner_position(mesh, block, mesh.offset[e], is_high ? kAxisBits[axis] : 0) +
             corner_position(mesh, block, mesh.offset[e], is_high ? 7 : 7 ^ kAxisBits[axis])) *
            0.5;
        if (pressure.includes && !pressure.includes(centre, outward.normalized())) continue;
        for (int c = 0; c < 8; ++c) {
          if (((c & kAxisBits[axis]) != 0) != is_high) continue;
          add_to_node(outward * (-pressure.pressure_kpa / 4), corners[c], force);
        }
      }
    }
  });
}

/// f = integral p div N: an isotropic stress -p that the stiffness has to balance.
void press_inside(const HexMesh& mesh, const VoxelMaterial& material,
                  const PressureInElements& pressure, std::vector<double>& force) {
  for_each_element(mesh, pressure.elements, [&](std::int32_t block, std::int32_t e) {
    const Corners corners = mesh.corners_in(std::size_t(block), e);
    for (int n = 0; n < 24; ++n) {
      force[3 * std::size_t(corners[n / 3]) + n % 3] +=
          pressure.pressure_kpa * material.matrix.volume_mm3 * material.matrix.gradient[n];
    }
  });
}

void add_volume_forces(const HexMesh& mesh, const VoxelMaterial& material, const FemLoads& loads,
                       std::vector<double>& force) {
  const double share = material.matrix.volume_mm3 / 8;
  for (std::size_t block = 0; block < mesh.block_count(); ++block) {
    for (std::int32_t e = mesh.element_begin[block]; e < mesh.element_begin[block + 1]; ++e) {
      const Vec3d weight =
          loads.gravity_m_s2 * (loads.mass_density[material.classes[e]] * share * kWeightMn);
      const Corners corners = mesh.corners_in(block, e);
      for (int c = 0; c < 8; ++c) {
        Vec3d sum = weight;
        if (loads.body_force) {
          sum += loads.body_force(corner_position(mesh, std::int32_t(block), mesh.offset[e], c)) *
                 share;
        }
        add_to_node(sum, corners[c], force);
      }
    }
  }
}

}  // namespace

NodalLoads nodal_loads(const HexMesh& voxels, const VoxelMaterial& material, const FemLoads& loads,
                       StrainTheory strain) {
  NodalLoads out;
  const std::size_t unknowns = 3 * std::size_t(voxels.node_count());
  out.held.assign(voxels.node_count(), 0);
  out.u_mm.assign(unknowns, 0);
  for (const HeldElements& held : loads.held) hold(voxels, held, out);
  const bool has_volume_force = loads.gravity_m_s2 != Vec3d(0) || loads.body_force;
  if (loads.forces.empty() && loads.face_pressures.empty() && loads.inner_pressures.empty() &&
      !has_volume_force) {
    return out;
  }
  out.force_mn.assign(unknowns, 0);
  for (const ForceOnElements& force : loads.forces) {
    require_finite(force.force_n, "force");
    std::int64_t elements = 0;
    for_each_element(voxels, force.elements, [&](std::int32_t, std::int32_t) { ++elements; });
    const Vec3d share = force.force_n * (kMnPerN / double(8 * elements));
    for_each_element(voxels, force.elements, [&](std::int32_t block, std::int32_t e) {
      const Corners corners = voxels.corners_in(std::size_t(block), e);
      for (int c = 0; c < 8; ++c) add_to_node(share, corners[c], out.force_mn);
    });
  }
  for (const PressureOnFaces& pressure : loads.face_pressures) {
    require_finite(Vec3d(pressure.pressure_kpa), "pressure");
    press_faces(voxels, pressure, out.force_mn);
  }
  for (const PressureInElements& pressure : loads.inner_pressures) {
    require_finite(Vec3d(pressure.pressure_kpa), "pressure");
    if (strain == StrainTheory::linear) press_inside(voxels, material, pressure, out.force_mn);
    out.swelling_kpa.resize(std::size_t(voxels.element_count()));
    for_each_element(voxels, pressure.elements, [&](std::int32_t, std::int32_t e) {
      out.swelling_kpa[std::size_t(e)] += pressure.pressure_kpa;
    });
  }
  if (has_volume_force) add_volume_forces(voxels, material, loads, out.force_mn);
  return out;
}

HeldBits held_bits(const HexMesh& voxels, const std::vector<HeldElements>& held) {
  FemLoads loads;
  loads.held = held;
  return nodal_loads(voxels, {}, loads).held;
}

std::vector<double> forces_within_held(const HexMesh& voxels, const VoxelMaterial& material,
                                       const NodalLoads& loads) {
  // Calls visit(element, corners, u) for the elements that are held and strained, until it is
  // false.
  const auto for_strained = [&](std::size_t block, auto&& visit) {
    for (std::int32_t e = voxels.element_begin[block]; e < voxels.element_begin[block + 1]; ++e) {
      const Corners corners = voxels.corners_in(block, e);
      if (held_corners(corners, loads.held) != kAllCornersHeld) continue;
      Vector24 u;
      bool is_shifted = true;
      for (std::size_t n = 0; n < 24; ++n) {
        u[n] = loads.u_mm[3 * std::size_t(corners[n / 3]) + n % 3];
        is_shifted = is_shifted && u[n] == u[n % 3];
      }
      if (!is_shifted && !visit(e, corners, u)) return;
    }
  };
  std::vector<std::uint8_t> is_strained(voxels.block_count());
  parallel_for(voxels.block_count(), kBlocks, [&](std::size_t block) {
    for_strained(block, [&](std::int32_t, const Corners&, const Vector24&) {
      is_strained[block] = 1;
      return false;
    });
  });
  std::vector<double> forces;
  for (std::size_t block = 0; block < voxels.block_count(); ++block) {
    if (is_strained[block] == 0) continue;
    if (forces.empty()) forces.assign(loads.u_mm.size(), 0.0);
    for_strained(block, [&](std::int32_t e, const Corners& corners, const Vector24& u) {
      const std::uint8_t of_class = material.classes[std::size_t(e)];
      const double shear = material.moduli.shear[of_class], bulk = material.moduli.bulk[of_class];
      for (std::size_t row = 0; row < 24; ++row) {
        double& force = forces[3 * std::size_t(corners[row / 3]) + row % 3];
        for (std::size_t n = 0; n < 24; ++n) {
          force +=
              (shear * material.matrix.shear[row][n] + bulk * material.matrix.bulk[row][n]) * u[n];
        }
      }
      return true;
    });
  }
  return forces;
}

}  // namespace supple
