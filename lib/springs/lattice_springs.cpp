#include "lib/springs/lattice_springs.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "lib/body/node_offsets.h"
#include "volumes/base/error.h"
#include "volumes/base/units.h"

namespace supple {

namespace {

Vec3d position_of(const Body& body, Slot slot) {
  const Vec3i voxel = voxel_of(body.elements, slot);
  Vec3d index(voxel);
  for (int c = 0; c < 3; ++c) {
    index[c] += offset_with_fraction(body, c, slot);
  }
  return body.geometry.world_from_index(index);
}

double class_value(const std::vector<double>& table, std::uint8_t cls, double without) {
  return table.empty() ? without : table[cls];
}

/// Finds the springs of one body, element by element.
class Builder {
 public:
  Builder(const Body& body, const LatticeSpringParams& params, LatticeSprings& result)
      : m_body(body), m_params(params), m_result(result), m_node(slot_count(body.elements), -1) {}

  void add_nodes() {
    const double voxel_mm3 = std::abs(m_body.geometry.determinant());
    for_each_element(m_body.elements, [&](Slot slot) {
      m_node[slot] = int(m_result.slots.size());
      const double density =
          m_params.density_kg_m3 * class_value(m_params.class_density, m_body.classes[slot], 1);
      const double mass = density * voxel_mm3 * kM3PerMm3;
      if (!(mass > 0)) {
        throw InputError({"", "density of class " + std::to_string(m_body.classes[slot]),
                          number_text(density) + " kg/m3", "above 0"});
      }
      m_result.slots.push_back(slot);
      m_result.system.mass_kg.push_back(mass);
    });
  }

  void add_springs(const Progress* progress) {
    constexpr std::size_t kElementsPerPoll = 65536;
    m_cell_nodes.reserve(m_result.slots.size());
    m_result.system.springs.reserve(m_result.slots.size() * most_springs());
    for (std::size_t n = 0; n < m_result.slots.size(); ++n) {
      if (n % kElementsPerPoll == 0) poll(progress);
      const Slot slot = m_result.slots[n];
      CellBarrier::Node& node = m_cell_nodes.emplace_back();
      node.next = {-1, -1, -1};
      const double factor = class_value(m_params.class_stiffness, m_body.classes[slot], 1);
      node.stiffness_n_m = float(m_params.structural_n_m * factor);
      for (int axis = 0; axis < 3; ++axis) {
        Slot next, beyond;
        if (!link(slot, axis, next)) continue;
        node.next[std::size_t(axis)] = m_node[next];
        const Vec3d rest = rest_of(slot, axis);
        add(slot, next, rest, m_params.structural_n_m);
        if (link(next, axis, beyond)) {
          add(slot, beyond, rest + rest_of(next, axis), m_params.bending_n_m);
        }
        for (int other = axis + 1; other < 3; ++other) add_diagonals(slot, next, axis, other);
      }
    }
  }

  /// Adds the barrier, after add_springs(); none where more than one axis has a single slice.
  void add_barrier() {
    const Vec3i& dims = m_body.geometry.dims();
    int flat_axis = -1, flat_axes = 0;
    for (int axis = 0; axis < 3; ++axis) {
      if (dims[axis] > 1) continue;
      flat_axis = axis;
      ++flat_axes;
    }
    if (flat_axes > 1) return;
    m_result.system.barrier =
        CellBarrier(m_body.geometry.axes_mm(), flat_axis, std::move(m_cell_nodes));
  }

 private:
  /// Rest vector in mm of the link to the next voxel along the axis, with what plastic flow left.
  Vec3d rest_of(Slot low, int axis) const {
    const auto& axes = m_body.geometry.axes_mm();
    Vec3d rest = axes[std::size_t(axis)];
    for (std::size_t c = 0; c < 3; ++c) {
      rest += axes[c] * (m_body.rest[std::size_t(axis)][c].at(low) / kFixedOne);
    }
    return rest;
  }
  bool link(Slot from, int axis, Slot& to) const {
    return neighbour_slot(m_body.elements, m_body.cuts, from, axis, true, to);
  }

  /// Adds both diagonals of the square between the axes; `next` lies one step along `axis`. Their
  /// rest is the mean of both ways round.
  void add_diagonals(Slot slot, Slot next, int axis, int other) {
    Slot side, corner, same_corner;
    if (!link(slot, other, side) || !link(next, other, corner) || !link(side, axis, same_corner)) {
      return;
    }
    const Vec3d along = (rest_of(slot, axis) + rest_of(side, axis)) * 0.5;
    const Vec3d across = (rest_of(slot, other) + rest_of(next, other)) * 0.5;
    add(slot, corner, along + across, m_params.shear_n_m);
    add(next, side, along - across, m_params.shear_n_m);
  }

  /// The most springs of an element, those to elements below it left out.
  std::size_t most_springs() const {
    constexpr std::size_t kLinks = 3, kDiagonals = 6, kBends = 3;
    return (m_params.structural_n_m > 0 ? kLinks : 0) + (m_params.shear_n_m > 0 ? kDiagonals : 0) +
           (m_params.bending_n_m > 0 ? kBends : 0);
  }

  void add(Slot a, Slot b, const Vec3d& between, double stiffness) {
    const double k = stiffness * mean(m_params.class_stiffness, a, b, 1);
    if (k == 0) return;
    const double beta = m_params.stiffness_damping_s + mean(m_params.class_damping_s, a, b, 0);
    const double damping = m_params.damping_n_s_m + beta * k;
    m_result.system.springs.push_back({m_node[a], m_node[b], between.length(), k, damping});
  }

  /// The mean of the table's values at both ends.
  double mean(const std::vector<double>& table, Slot a, Slot b, double without) const {
    return 0.5 * (class_value(table, m_body.classes[a], without) +
                  class_value(table, m_body.classes[b], without));
  }

  const Body& m_body;
  const LatticeSpringParams& m_params;
  LatticeSprings& m_result;
  std::vector<int> m_node;  // per slot
  std::vector<CellBarrier::Node> m_cell_nodes;
};

}  // namespace

void LatticeSpringParams::validate() const {
  const auto check = [](double value) {
    if (value >= 0 && std::isfinite(value)) return;
    throw InputError({"", "springs of voxels", number_text(value), "finite values of at least 0"});
  };
  for (const double value : {structural_n_m, shear_n_m, bending_n_m, damping_n_s_m,
                             stiffness_damping_s, mass_damping_per_s, density_kg_m3}) {
    check(value);
  }
  for (const std::vector<double>* table : {&class_stiffness, &class_density, &class_damping_s}) {
    if (!table->empty() && table->size() != 256) {
      throw InputError({"", "springs of voxels", std::to_string(table->size()) + " factors",
                        "256, one per material class"});
    }
    for (const double value : *table) check(value);
  }
}

// A lattice whose springs along the axes have k1 and whose diagonals of squares have k2 is a Cauchy
// solid with h C_1111 = k1 + 2 k2 and h C_1122 = h C_1212 = k2. It is isotropic, C_1111 = C_1122 +
// 2 C_1212, for k1 = k2 = k: then both of Lame's constants are k / h, so that E = 5/2 k / h and
// Poisson's ratio is 1/4.
LatticeSpringParams material_springs(const Body& body) {
  LatticeSpringParams params;
  const double h_m = std::cbrt(std::abs(body.geometry.determinant())) * kMPerMm;
  params.structural_n_m = params.shear_n_m = 0.4 * kPaPerKpa * h_m;
  params.bending_n_m = 0;
  params.density_kg_m3 = 1;
  const MaterialClasses classes(body.material);
  for (int c = 0; c <= kLastClass; ++c) {
    const LinkPhysics physics = classes.physics(c, c);
    params.class_stiffness.push_back(physics.stiffness_kpa);
    params.class_density.push_back(classes.mass_density_of_class(c));
    params.class_damping_s.push_back(physics.rayleigh_beta_ms * kSPerMs);
  }
  return params;
}

int LatticeSprings::node_of(Slot slot) const {
  const auto at = std::lower_bound(slots.begin(), slots.end(), slot);
  return at != slots.end() && *at == slot ? int(at - slots.begin()) : -1;
}

LatticeSprings make_springs(const Body& body, const LatticeSpringParams& params,
                            const Progress* progress) {
  params.validate();
  LatticeSprings result;
  result.system.mass_damping_per_s = params.mass_damping_per_s;
  Builder builder(body, params, result);
  builder.add_nodes();
  builder.add_springs(progress);
  builder.add_barrier();
  result.system.springs.shrink_to_fit();
  take_state(body, result);
  return result;
}

void take_state(const Body& body, LatticeSprings& springs) {
  SpringSystem& system = springs.system;
  system.pos_mm.resize(springs.slots.size());
  system.velocity_mm_s.resize(springs.slots.size());
  for (std::size_t n = 0; n < springs.slots.size(); ++n) {
    const Slot slot = springs.slots[n];
    system.pos_mm[n] = position_of(body, slot);
    for (int c = 0; c < 3; ++c) system.velocity_mm_s[n][c] = body.velocity_mm_s[c].at(slot);
  }
}

double give_state(const LatticeSprings& springs, Body& body) {
  NodeOffsets state(body);
  double rounding = 0;
  for (std::size_t n = 0; n < springs.slots.size(); ++n) {
    const Slot slot = springs.slots[n];
    const Vec3i voxel = voxel_of(body.elements, slot);
    const Vec3d index = body.geometry.index_from_world(springs.system.pos_mm[n]);
    for (int c = 0; c < 3; ++c) {
      rounding = std::max(rounding, state.set_offset(c, slot, index[c] - voxel[c]));
      state.set_velocity(c, slot, springs.system.velocity_mm_s[n][c]);
    }
  }
  state.give(body);
  return rounding;
}

}  // namespace supple
