#include "lib/springs/lattice_springs.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "volumes/base/error.h"

namespace supple {

namespace {

constexpr double kM3PerMm3 = 1e-9;
constexpr double kLargestOffset = 16383 * kFixedOne;

Vec3d position_of(const Body& body, Slot slot) {
  const Vec3i voxel = voxel_of(body.elements, slot);
  Vec3d index(voxel);
  for (int c = 0; c < 3; ++c) index[c] += body.q[c].at(slot) / kFixedOne;
  return body.geometry.world_from_index(index);
}

double class_factor(const std::vector<double>& table, std::uint8_t cls) {
  return table.empty() ? 1.0 : table[cls];
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
          m_params.density_kg_m3 * class_factor(m_params.class_density, m_body.classes[slot]);
      const double mass = density * voxel_mm3 * kM3PerMm3;
      if (!(mass > 0)) {
        throw InputError({"", "density of class " + std::to_string(m_body.classes[slot]),
                          number_text(density) + " kg/m3", "above 0"});
      }
      m_result.slots.push_back(slot);
      m_result.system.mass_kg.push_back(mass);
    });
  }

  void add_springs() {
    for (const Slot slot : m_result.slots) {
      for (int axis = 0; axis < 3; ++axis) {
        Slot next, beyond;
        if (!link(slot, axis, next)) continue;
        add(slot, next, step(axis), m_params.structural_n_m);
        if (link(next, axis, beyond)) add(slot, beyond, 2.0 * step(axis), m_params.bending_n_m);
        for (int other = axis + 1; other < 3; ++other) add_diagonals(slot, next, axis, other);
      }
    }
  }

 private:
  Vec3d step(int axis) const { return m_body.geometry.axes_mm()[axis]; }
  bool link(Slot from, int axis, Slot& to) const {
    return neighbour_slot(m_body.elements, m_body.cuts, from, axis, true, to);
  }

  /// Both diagonals of the square between the axes; `next` lies one step along `axis`.
  void add_diagonals(Slot slot, Slot next, int axis, int other) {
    Slot side, corner, same_corner;
    if (!link(slot, other, side) || !link(next, other, corner) || !link(side, axis, same_corner)) {
      return;
    }
    add(slot, corner, step(axis) + step(other), m_params.shear_n_m);
    add(next, side, step(axis) - step(other), m_params.shear_n_m);
  }

  void add(Slot a, Slot b, const Vec3d& between, double stiffness) {
    const auto& table = m_params.class_stiffness;
    const double k =
        stiffness * 0.5 *
        (class_factor(table, m_body.classes[a]) + class_factor(table, m_body.classes[b]));
    if (k == 0) return;
    const double damping = m_params.damping_n_s_m + m_params.stiffness_damping_s * k;
    m_result.system.springs.push_back({m_node[a], m_node[b], between.length(), k, damping});
  }

  const Body& m_body;
  const LatticeSpringParams& m_params;
  LatticeSprings& m_result;
  std::vector<int> m_node;  // per slot
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
  for (const std::vector<double>* table : {&class_stiffness, &class_density}) {
    if (!table->empty() && table->size() != 256) {
      throw InputError({"", "springs of voxels", std::to_string(table->size()) + " factors",
                        "256, one per material class"});
    }
    for (const double value : *table) check(value);
  }
}

int LatticeSprings::node_of(Slot slot) const {
  const auto at = std::lower_bound(slots.begin(), slots.end(), slot);
  return at != slots.end() && *at == slot ? int(at - slots.begin()) : -1;
}

LatticeSprings make_springs(const Body& body, const LatticeSpringParams& params) {
  params.validate();
  LatticeSprings result;
  result.system.mass_damping_per_s = params.mass_damping_per_s;
  Builder builder(body, params, result);
  builder.add_nodes();
  builder.add_springs();
  result.system.springs.shrink_to_fit();
  result.system.velocity_mm_s.assign(result.slots.size(), Vec3d(0.0));
  take_state(body, result);
  return result;
}

void take_state(const Body& body, LatticeSprings& springs) {
  springs.system.pos_mm.resize(springs.slots.size());
  for (std::size_t n = 0; n < springs.slots.size(); ++n) {
    springs.system.pos_mm[n] = position_of(body, springs.slots[n]);
  }
}

double give_state(const LatticeSprings& springs, Body& body) {
  std::array<BrickValues, 3> q = body.q;
  double rounding = 0;
  for (std::size_t n = 0; n < springs.slots.size(); ++n) {
    const Slot slot = springs.slots[n];
    const Vec3i voxel = voxel_of(body.elements, slot);
    const Vec3d index = body.geometry.index_from_world(springs.system.pos_mm[n]);
    for (int c = 0; c < 3; ++c) {
      const double exact = (index[c] - voxel[c]) * kFixedOne;
      if (!(std::abs(exact) <= kLargestOffset)) {
        throw InputError({"",
                          "voxel " + std::to_string(voxel.x) + "," + std::to_string(voxel.y) + "," +
                              std::to_string(voxel.z),
                          "an offset of " + number_text(exact / kFixedOne) + " voxels",
                          "at most 16383"});
      }
      const auto units = std::int32_t(std::lround(exact));
      rounding = std::max(rounding, std::abs(exact - units) / kFixedOne);
      if (units == q[c].at(slot)) continue;
      if (q[c].brick_count() == 0) q[c].resize(body.elements.brick_count());
      q[c].set(slot, units);
    }
  }
  body.q = std::move(q);
  body.links_known_valid = false;
  return rounding;
}

}  // namespace supple
