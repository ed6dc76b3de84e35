#include "lib/model/fem_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <unordered_map>

#include "lib/body/node_offsets.h"
#include "lib/chainmail/held_voxels.h"
#include "lib/fem/fem_results.h"
#include "lib/model/quasi_static.h"
#include "volumes/base/error.h"

namespace supple {

namespace {

constexpr double kJoulePerMillijoule = 1e-3;

/// Of the corner of voxels at the lattice place nearest to an index position.
std::uint64_t corner_key(const Vec3d& index) {
  std::uint64_t key = 0;
  for (int c = 0; c < 3; ++c) {
    const std::int64_t place = std::llround(index[c] + 0.5) + (1 << 20);
    key = (key << 21) | (std::uint64_t(place) & ((1u << 21) - 1));
  }
  return key;
}

struct CornerSum {
  Vec3d sum{0, 0, 0};
  int count = 0;
};
using CornerOffsets = std::unordered_map<std::uint64_t, CornerSum>;

/// Offsets of elements at their corners.
class CornerField {
 public:
  CornerField(const Body& body, const SlotSet& slots, const std::vector<Vec3d>& offsets)
      : m_elements(body.elements), m_offsets(offsets) {
    std::size_t n = 0;
    slots.for_each([&](Slot slot) { m_number[slot] = n++; });
  }

  /// Per corner the mean of what its elements say.
  CornerOffsets at_corners() const {
    CornerOffsets corners;
    for (const auto& [slot, n] : m_number) {
      const Vec3i voxel = voxel_of(m_elements, slot);
      const std::array<Vec3d, 3> slopes = slopes_at(voxel, n);
      for (int corner = 0; corner < 8; ++corner) {
        const Vec3d way((corner & 4 ? 0.5 : -0.5), (corner & 2 ? 0.5 : -0.5),
                        (corner & 1 ? 0.5 : -0.5));
        CornerSum& sum = corners[corner_key(Vec3d(voxel) + way)];
        sum.sum += m_offsets[n] + slopes[0] * way.x + slopes[1] * way.y + slopes[2] * way.z;
        ++sum.count;
      }
    }
    return corners;
  }

 private:
  /// Along each axis, from the neighbours that there are.
  std::array<Vec3d, 3> slopes_at(const Vec3i& voxel, std::size_t n) const {
    std::array<Vec3d, 3> slopes;
    for (int axis = 0; axis < 3; ++axis) {
      Vec3d ends[2] = {m_offsets[n], m_offsets[n]};
      int steps = 0;
      for (const int side : {0, 1}) {
        Vec3i beside = voxel;
        beside[axis] += side == 1 ? 1 : -1;
        Slot slot;
        if (!slot_of(m_elements, beside, slot)) continue;
        const auto found = m_number.find(slot);
        if (found == m_number.end()) continue;
        ends[side] = m_offsets[found->second];
        ++steps;
      }
      slopes[std::size_t(axis)] = steps == 0 ? Vec3d(0.0) : (ends[1] - ends[0]) / steps;
    }
    return slopes;
  }

  const BrickTopology& m_elements;
  const std::vector<Vec3d>& m_offsets;
  std::unordered_map<Slot, std::size_t> m_number;
};

void require_two_sided(const HeldVoxels& found) {
  for (const auto* bounds : {&found.rest.at_least, &found.rest.at_most}) {
    for (const std::vector<Bound>& of_coordinate : *bounds) {
      if (of_coordinate.empty()) continue;
      throw InputError({"", "finite elements", "a push handle of an earlier drag, still held",
                        "its release, or a handle that holds"});
    }
  }
  for (const HeldHandle& handle : found.handles) {
    if (!handle.is_push()) continue;
    throw InputError({"", "finite elements", "a push handle", "handles that hold what they grab"});
  }
}

/// The sum, about the mean of all nodes.
FemReaction sum_of(const std::vector<FemReaction>& parts) {
  FemReaction sum;
  for (const FemReaction& part : parts) {
    sum.nodes += part.nodes;
    sum.centre_mm += part.centre_mm * double(part.nodes);
    sum.force_n += part.force_n;
  }
  if (sum.nodes > 0) sum.centre_mm /= double(sum.nodes);
  for (const FemReaction& part : parts) {
    sum.moment_nmm += part.moment_nmm + (part.centre_mm - sum.centre_mm).cross(part.force_n);
  }
  return sum;
}

}  // namespace

ElasticTable material_elasticity(const MaterialTable& material) {
  ElasticTable table;
  const MaterialClasses classes(material);
  for (int c = 0; c <= kLastClass; ++c) {
    table.young_kpa[std::size_t(c)] = classes.physics(c, c).stiffness_kpa;
    table.poisson[std::size_t(c)] = classes.poisson_of_class(c);
  }
  return table;
}

VoxelFemModel::VoxelFemModel(const HeldBody& held, const ElasticTable& elastic, FemLoads loads,
                             const FemParams& params, const Body* shape, Progress* progress)
    : m_held(held),
      m_model(shape != nullptr ? *shape : held.body, elastic, Dilatation::mean, progress),
      m_loads(std::move(loads)),
      m_params(params) {
  params.validate();
}

/// Where the elements are.
VoxelFemModel::Grip VoxelFemModel::grip_of(const SlotSet& slots) const {
  Grip grip;
  grip.slots = slots;
  slots.for_each([&](Slot slot) {
    Vec3d& offset = grip.offsets.emplace_back(0.0);
    for (int c = 0; c < 3; ++c) offset[c] = offset_with_fraction(m_held.body, c, slot);
  });
  return grip;
}

/// Handles, anchors, edges of handles, then what earlier moves left held: a corner of several obeys
/// the first.
void VoxelFemModel::add_grips(const HeldVoxels& found) {
  const auto add_handles = [&](bool edges) {
    for (const HeldHandle& handle : found.handles) {
      if (handle.source->is_edge != edges) continue;
      Grip& grip = m_grips.emplace_back(grip_of(handle.slots));
      for (std::size_t n = 0; n < grip.offsets.size(); ++n) {
        for (int c = 0; c < 3; ++c) {
          grip.offsets[n][c] += handle.by(n)[std::size_t(c)] / kFixedOne;
        }
      }
    }
  };
  add_handles(false);
  if (!found.fixed->empty()) {
    m_grips.push_back(grip_of(*found.fixed));
    m_grips.back().is_anchor = true;
  }
  add_handles(true);
  SlotSet rest = found.rest.anchored;
  rest.remove(*found.fixed);
  for (const SlotSet& told : m_told) {
    std::vector<Slot> slots;
    told.for_each([&](Slot slot) {
      if (rest.contains(slot)) slots.push_back(slot);
    });
    if (slots.empty()) continue;
    m_grips.push_back(grip_of(SlotSet(std::move(slots))));
    rest.remove(m_grips.back().slots);
  }
  if (!rest.empty()) m_grips.push_back(grip_of(rest));
}

HeldElements VoxelFemModel::held_elements(const Grip& grip) const {
  HeldElements held;
  held.elements = grip.slots;
  const Geometry& geometry = m_held.body.geometry;
  const Vec3d& first = grip.offsets.front();
  const bool is_one = std::all_of(grip.offsets.begin(), grip.offsets.end(),
                                  [&](const Vec3d& offset) { return offset == first; });
  if (is_one && first == Vec3d(0.0)) return held;
  if (is_one) {
    const Vec3d u_mm = geometry.world_vector_from_index(first);
    held.displacement_mm = [u_mm](const Vec3d&) { return u_mm; };
    return held;
  }
  const auto corners = std::make_shared<const CornerOffsets>(
      CornerField(m_held.body, grip.slots, grip.offsets).at_corners());
  held.displacement_mm = [corners, &geometry](const Vec3d& rest_mm) {
    const CornerSum& found = corners->at(corner_key(geometry.index_from_world(rest_mm)));
    return geometry.world_vector_from_index(found.sum / found.count);
  };
  return held;
}

void VoxelFemModel::move(const std::vector<Handle>& handles, int, Progress* progress) {
  const FixedElements fixed = fix(m_held.body, m_held.anchors);
  HeldVoxels found = hold(m_held.body, handles, fixed, m_held.holds);
  require_two_sided(found);
  m_grips.clear();
  add_grips(found);
  m_loads.held.clear();
  for (const Grip& grip : m_grips) m_loads.held.push_back(held_elements(grip));
  m_solution = m_model.solve(m_loads, m_params, progress);
  found.rest.anchored.add(found.grabbed);
  m_held.holds = std::move(found.rest);
}

ModelEnergy VoxelFemModel::energy() {
  return {m_solution.report.energy_mj * kJoulePerMillijoule, 0, 0};
}

std::vector<Reaction> VoxelFemModel::reactions(const std::vector<Handle>& handles) {
  std::vector<Reaction> found;
  for (const FemReaction& reaction : reactions(elements_of_handles(m_held.body, handles))) {
    found.push_back({reaction.force_n});
  }
  return found;
}

std::vector<FemReaction> VoxelFemModel::reactions(const std::vector<SlotSet>& elements) const {
  std::vector<FemReaction> sums;
  for (const SlotSet& set : elements) {
    std::vector<FemReaction> parts;
    for (std::size_t n = 0; n < m_grips.size(); ++n) {
      if (set.contains(m_grips[n].slots.first())) parts.push_back(m_solution.reactions[n]);
    }
    sums.push_back(sum_of(parts));
  }
  return sums;
}

FemReaction VoxelFemModel::anchor_reaction() const {
  for (std::size_t n = 0; n < m_grips.size(); ++n) {
    if (m_grips[n].is_anchor) return m_solution.reactions[n];
  }
  return {};
}

void VoxelFemModel::store() {
  if (m_solution.u_mm.empty()) return;
  const HexMesh& mesh = m_model.mesh();
  const Body& body = m_held.body;
  NodeOffsets state(body);
  for (std::size_t b = 0; b < mesh.block_count(); ++b) {
    for (std::int32_t e = mesh.element_begin[b]; e < mesh.element_begin[b + 1]; ++e) {
      const Vec3d offset =
          body.geometry.index_vector_from_world(centre_displacement(mesh, m_solution.u_mm, e));
      const Slot slot = Slot(b * kBrickVoxels + mesh.offset[std::size_t(e)]);
      for (int c = 0; c < 3; ++c) state.set_offset(c, slot, offset[c]);
    }
  }
  for (auto grip = m_grips.rbegin(); grip != m_grips.rend(); ++grip) {
    std::size_t n = 0;
    grip->slots.for_each([&](Slot slot) {
      for (int c = 0; c < 3; ++c) state.set_offset(c, slot, grip->offsets[n][c]);
      ++n;
    });
  }
  state.give(m_held.body);
}

}  // namespace supple
