#include "lib/model/spring_models.h"

#include <cmath>

#include "lib/chainmail/held_voxels.h"
#include "lib/chainmail/node_owners.h"
#include "lib/model/quasi_static.h"
#include "volumes/base/error.h"

namespace supple {

namespace {

[[noreturn]] void throw_push(const std::string& found, const std::string& expected) {
  throw InputError({"", "springs", found, expected});
}

std::vector<int> indices(const std::vector<Slot>& nodes) {
  return {nodes.begin(), nodes.end()};
}

}  // namespace

VoxelSpringModel::VoxelSpringModel(const HeldBody& held, const LatticeSpringParams& springs,
                                   const MotionParams& params, const Progress* progress)
    : m_held(held),
      m_springs(make_springs(held.body, springs, progress)),
      m_motion(m_springs.system, params) {
  move({}, 1, nullptr);
}

std::vector<int> VoxelSpringModel::nodes_of(const SlotSet& slots) const {
  std::vector<int> nodes;
  slots.for_each([&](Slot slot) { nodes.push_back(m_springs.node_of(slot)); });
  return nodes;
}

void VoxelSpringModel::move(const std::vector<Handle>& handles, int steps, Progress*) {
  const Body& body = m_held.body;
  const FixedElements fixed = fix(body, m_held.anchors);
  const HeldVoxels found = hold(body, handles, fixed, m_held.holds);
  Holds holds = without_sides(found.rest, "springs");
  std::vector<DrivenNodes> driven;
  for (const HeldHandle& handle : found.handles) {
    if (handle.is_push()) throw_push("a push handle", "handles that hold what they grab");
    driven.push_back({nodes_of(handle.slots), {}});
    for (std::size_t n = 0; n < driven.back().nodes.size(); ++n) {
      const std::array<std::int32_t, 3>& by = handle.by(n);
      driven.back().by_mm.push_back(
          body.geometry.world_vector_from_index(Vec3d(by[0], by[1], by[2]) / kFixedOne));
    }
    holds.anchored.add(handle.slots);
  }
  std::vector<int> anchored = nodes_of(fixed.slots);
  const std::vector<int> earlier = nodes_of(found.rest.anchored);
  anchored.insert(anchored.end(), earlier.begin(), earlier.end());
  m_motion.move(anchored, std::move(driven), steps);
  m_held.holds = std::move(holds);
}

std::vector<Reaction> VoxelSpringModel::reactions(const std::vector<Handle>& handles) {
  return reactions(elements_of_handles(m_held.body, handles));
}

std::vector<Reaction> VoxelSpringModel::reactions(const std::vector<SlotSet>& elements) const {
  std::vector<std::vector<int>> sets;
  for (const SlotSet& slots : elements) sets.push_back(nodes_of(slots));
  return m_motion.reactions(sets);
}

MeshSpringModel::MeshSpringModel(const HeldMesh& held, const MeshSpringParams& springs,
                                 const MotionParams& params)
    : m_held(held), m_system(make_springs(held.body, springs)), m_motion(m_system, params) {
  move({}, 1, nullptr);
}

void MeshSpringModel::move(const std::vector<MeshHandle>& handles, int steps, Progress*) {
  NodeOwners owners(m_system.node_count());
  std::vector<DrivenNodes> driven;
  NodeSet grabbed;
  for (std::size_t h = 0; h < handles.size(); ++h) {
    const std::string name = "handle " + std::to_string(h);
    if (handles[h].kind == HandleKind::push) {
      throw_push("a push handle", "handles that hold what they grab");
    }
    for (int c = 0; c < 3; ++c) {
      if (std::isfinite(handles[h].by_mm[c])) continue;
      throw InputError(
          {"", name, "a move by " + number_text(handles[h].by_mm[c]) + " mm", "a finite one"});
    }
    const std::vector<Slot> nodes = owners.claim(handles[h].nodes, name, false);
    driven.push_back({indices(nodes), std::vector<Vec3d>(nodes.size(), handles[h].by_mm)});
    grabbed.insert(grabbed.end(), nodes.begin(), nodes.end());
  }
  NodeSet fixed;
  for (std::size_t a = 0; a < m_held.anchors.size(); ++a) {
    const std::vector<Slot> nodes =
        owners.claim(m_held.anchors[a], "anchor " + std::to_string(a), true);
    fixed.insert(fixed.end(), nodes.begin(), nodes.end());
  }
  for (const int node : m_held.anchored) {
    if (node >= 0 && std::size_t(node) < m_system.node_count()) continue;
    throw InputError({"", "held nodes", "node " + std::to_string(node),
                      "an index below " + std::to_string(m_system.node_count())});
  }
  fixed.insert(fixed.end(), m_held.anchored.begin(), m_held.anchored.end());
  m_motion.move(fixed, std::move(driven), steps);
  add_nodes(m_held.anchored, grabbed);
}

std::vector<Reaction> MeshSpringModel::reactions(const std::vector<MeshHandle>& handles) {
  std::vector<std::vector<int>> sets;
  NodeOwners owners(m_system.node_count());
  for (std::size_t h = 0; h < handles.size(); ++h) {
    sets.push_back(indices(owners.claim(handles[h].nodes, "handle " + std::to_string(h), false)));
  }
  return m_motion.reactions(sets);
}

}  // namespace supple
