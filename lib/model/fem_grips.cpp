#include "lib/model/fem_grips.h"

#include <array>

#include "lib/body/node_offsets.h"
#include "lib/fem/voxel/fem_results.h"
#include "volumes/base/error.h"
#include "volumes/base/parallel.h"

namespace supple {

namespace {

void require_two_sided(const HeldVoxels& found) {
  for (const HeldHandle& handle : found.handles) {
    if (!handle.is_push()) continue;
    throw InputError({"", "finite elements", "a push handle", "handles that hold what they grab"});
  }
}

/// Sums reactions, about the mean of all nodes.
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

/// A grip that holds elements where they are.
FemGrip grip_of(const Body& body, const SlotSet& slots) {
  FemGrip grip;
  grip.slots = slots;
  slots.for_each([&](Slot slot) {
    Vec3d& offset = grip.start.emplace_back(0.0);
    for (int c = 0; c < 3; ++c) offset[c] = offset_with_fraction(body, c, slot);
  });
  grip.offsets = grip.start;
  return grip;
}

/// Numbers of fields.
constexpr Grain kBlocks{16};
constexpr int kAnchors = 0, kHeld = 1, kPoints = 2, kFirstHandle = 3;

Vec3d in_voxels(const std::array<std::int32_t, 3>& q) {
  return Vec3d(q[0], q[1], q[2]) / kFixedOne;
}

/// Moves a grip as its handle asks. A single voxel that only shifts says where its centre goes;
/// other points beside it say how it turns.
void move_by(const Body& body, const HeldHandle& handle, FemGrip& grip) {
  for (std::size_t n = 0; n < grip.offsets.size(); ++n) grip.offsets[n] += in_voxels(handle.by(n));
  if (const std::optional<StepMotion>& steps = handle.source->steps) {
    grip.motion = GripMotion{steps->before, steps->after, {}};
    for (const auto& q : steps->start_q) grip.motion->from.push_back(in_voxels(q));
  } else if (handle.moves_as_one()) {
    const bool is_point = grip.offsets.size() == 1 && body.rigid.at(grip.slots.first()) < 0;
    if (is_point) {
      grip.field = kPoints;
    } else {
      grip.motion.emplace();
    }
  }
}

/// The elements of a mesh by their slots in the body.
class ElementOfSlot {
 public:
  ElementOfSlot(const HexMesh& mesh, const Body& body) : m_mesh(mesh), m_elements(body.elements) {}

  /// The element beside another one, across a face; -1 where none is joined.
  std::int32_t beside(std::int32_t block, std::int32_t e, int axis, bool is_high) const {
    Vec3i voxel = m_mesh.origin[std::size_t(block)] + brick_local(m_mesh.offset[std::size_t(e)]);
    voxel[axis] += is_high ? 1 : -1;
    Slot slot;
    if (!slot_of(m_elements, voxel, slot)) return -1;
    const std::int32_t other = element_at(m_mesh, slot / kBrickVoxels, int(slot % kBrickVoxels));
    const std::size_t bit = 4u >> axis, own = is_high ? bit : 0;
    const Corners corners = m_mesh.corners_in(std::size_t(block), e);
    const Corners there = m_mesh.corners_in(slot / kBrickVoxels, other);
    return corners[own] == there[own ^ bit] ? other : -1;
  }

 private:
  const HexMesh& m_mesh;
  const BrickTopology& m_elements;
};

template <class Visit>
void for_each_of_mesh(const HexMesh& mesh, Visit&& visit) {
  for (std::size_t b = 0; b < mesh.block_count(); ++b) {
    for (std::int32_t e = mesh.element_begin[b]; e < mesh.element_begin[b + 1]; ++e) {
      visit(std::int32_t(b), e, Slot(b * kBrickVoxels + mesh.offset[std::size_t(e)]));
    }
  }
}

}  // namespace

std::vector<FemGrip> fem_grips(const Body& body, HeldVoxels& found,
                               const std::vector<SlotSet>& told) {
  require_two_sided(found);
  found.rest = without_sides(found.rest, "finite elements");
  std::vector<FemGrip> grips;
  const auto add = [&](const SlotSet& slots, GripKind kind, int field) -> FemGrip& {
    FemGrip& grip = grips.emplace_back(grip_of(body, slots));
    grip.kind = kind;
    grip.field = field;
    if (kind <= GripKind::held) grip.motion.emplace();
    return grip;
  };
  const auto add_handles = [&](bool edges) {
    for (std::size_t n = 0; n < found.handles.size(); ++n) {
      if (found.handles[n].source->is_edge != edges) continue;
      add(found.handles[n].slots, edges ? GripKind::edge : GripKind::handle, kFirstHandle + int(n));
      move_by(body, found.handles[n], grips.back());
      grips.back().handle = n;
    }
  };
  add_handles(false);
  if (!found.fixed->empty()) add(*found.fixed, GripKind::anchor, kAnchors);
  add_handles(true);
  SlotSet rest = found.rest.anchored;
  rest.remove(*found.fixed);
  for (const SlotSet& set : told) {
    std::vector<Slot> slots;
    set.for_each([&](Slot slot) {
      if (rest.contains(slot)) slots.push_back(slot);
    });
    if (slots.empty()) continue;
    add(SlotSet(std::move(slots)), GripKind::held, kHeld);
    rest.remove(grips.back().slots);
  }
  if (!rest.empty()) add(rest, GripKind::held, kHeld);
  return grips;
}

std::vector<FemReaction> sums_over(const std::vector<SlotSet>& elements,
                                   const std::vector<FemGrip>& grips,
                                   const std::vector<FemReaction>& of_grip) {
  std::vector<FemReaction> sums;
  for (const SlotSet& set : elements) {
    std::vector<FemReaction> parts;
    for (std::size_t n = 0; n < grips.size(); ++n) {
      if (set.contains(grips[n].slots.first())) parts.push_back(of_grip[n]);
    }
    sums.push_back(sum_of(parts));
  }
  return sums;
}

std::vector<double> at_nodes(const HexMesh& mesh, const Body& body,
                             const std::vector<Vec3d>& of_element) {
  std::vector<double> sums(3 * std::size_t(mesh.node_count()), 0.0);
  std::vector<std::uint8_t> counts(std::size_t(mesh.node_count()), 0);
  const ElementOfSlot elements(mesh, body);
  for_each_of_mesh(mesh, [&](std::int32_t block, std::int32_t e, Slot) {
    const Vec3d& own = of_element[std::size_t(e)];
    Vec3d slopes[3];
    for (int axis = 0; axis < 3; ++axis) {
      const std::int32_t low = elements.beside(block, e, axis, false);
      const std::int32_t high = elements.beside(block, e, axis, true);
      const Vec3d& before = low < 0 ? own : of_element[std::size_t(low)];
      const Vec3d& after = high < 0 ? own : of_element[std::size_t(high)];
      slopes[axis] = low < 0 && high < 0 ? Vec3d(0) : (after - before) / ((low >= 0) + (high >= 0));
    }
    const Corners corners = mesh.corners_in(std::size_t(block), e);
    for (int corner = 0; corner < 8; ++corner) {
      Vec3d value = own;
      for (int axis = 0; axis < 3; ++axis) {
        value += slopes[axis] * ((corner >> (2 - axis) & 1) != 0 ? 0.5 : -0.5);
      }
      const auto node = std::size_t(corners[std::size_t(corner)]);
      for (int c = 0; c < 3; ++c) sums[3 * node + std::size_t(c)] += value[c];
      ++counts[node];
    }
  });
  for (std::size_t n = 0; n < sums.size(); ++n) sums[n] /= counts[n / 3];
  return sums;
}

std::vector<Vec3d> element_displacements(const HexMesh& mesh, const Body& body) {
  std::vector<Vec3d> values(std::size_t(mesh.element_count()));
  for_each_of_mesh(mesh, [&](std::int32_t, std::int32_t e, Slot slot) {
    Vec3d offset;
    for (int c = 0; c < 3; ++c) offset[c] = offset_with_fraction(body, c, slot);
    values[std::size_t(e)] = body.geometry.world_vector_from_index(offset);
  });
  return values;
}

std::vector<Vec3d> element_velocities(const HexMesh& mesh, const Body& body) {
  std::vector<Vec3d> values(std::size_t(mesh.element_count()), Vec3d(0));
  for_each_of_mesh(mesh, [&](std::int32_t, std::int32_t e, Slot slot) {
    for (std::size_t c = 0; c < 3; ++c) {
      values[std::size_t(e)][int(c)] = body.velocity_mm_s[c].at(slot);
    }
  });
  return values;
}

std::vector<Vec3d> at_centres(const HexMesh& mesh, const std::vector<double>& nodes) {
  std::vector<Vec3d> values(std::size_t(mesh.element_count()));
  parallel_for(mesh.block_count(), kBlocks, [&](std::size_t b) {
    for (std::int32_t e = mesh.element_begin[b]; e < mesh.element_begin[b + 1]; ++e) {
      values[std::size_t(e)] = centre_displacement(mesh.corners_in(b, e), nodes);
    }
  });
  return values;
}

void give_to_body(const std::vector<Vec3d>& u_mm, const std::vector<Vec3d>& v_mm_s,
                  const std::vector<FemGrip>& grips, bool are_at_end, Body& body) {
  NodeOffsets state(body);
  std::size_t e = 0;
  for_each_element(body.elements, [&](Slot slot) {
    const Vec3d offset = body.geometry.index_vector_from_world(u_mm[e]);
    for (int c = 0; c < 3; ++c) state.set_offset(c, slot, offset[c]);
    for (int c = 0; c < 3; ++c) state.set_velocity(c, slot, v_mm_s.empty() ? 0 : v_mm_s[e][c]);
    ++e;
  });
  for (auto grip = grips.rbegin(); are_at_end && grip != grips.rend(); ++grip) {
    std::size_t n = 0;
    grip->slots.for_each([&](Slot slot) {
      for (int c = 0; c < 3; ++c) state.set_offset(c, slot, grip->offsets[n][c]);
      ++n;
    });
  }
  state.give(body);
}

}  // namespace supple
