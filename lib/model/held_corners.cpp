#include "lib/model/held_corners.h"

#include <algorithm>
#include <map>

#include "lib/model/field_steps.h"

namespace supple {

namespace {

GridSteps one_after(const GridSteps& first, const GridSteps& then) {
  return {moved(then, first[0]), moved(then, first[1]), moved(then, first[2])};
}

GridSteps steps_of_pose(const Geometry& geometry, const RigidPiece& piece) {
  GridSteps steps;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    steps[axis] = geometry.index_vector_from_world(piece.pose.turn(geometry.axes_mm()[axis]));
  }
  return steps;
}

/// Interpolates trilinearly between the corners of a voxel.
Vec3d between(const std::array<Vec3d, 8>& corners, const Vec3d& part) {
  Vec3d more(0.0);
  for (std::size_t c = 1; c < 8; ++c) {
    const double weight = (c & 4 ? part.x : 1 - part.x) * (c & 2 ? part.y : 1 - part.y) *
                          (c & 1 ? part.z : 1 - part.z);
    more += (corners[c] - corners[0]) * weight;
  }
  return corners[0] + more;
}

}  // namespace

void CornerOffsets::say(NodeIndex node, const Vec3d& offset, int rank, std::int32_t grip) {
  std::int32_t& place = m_place[std::size_t(node)];
  if (place < 0) {
    place = std::int32_t(m_sums.size());
    m_sums.push_back({offset, 1, grip, std::int16_t(rank), true});
    return;
  }
  CornerSum& sum = m_sums[std::size_t(place)];
  if (rank > sum.rank) return;
  if (rank < sum.rank) {
    sum = {offset, 1, grip, std::int16_t(rank), true};
    return;
  }
  if (sum.is_one && !(offset == sum.sum)) {
    sum.sum *= double(sum.elements);
    sum.is_one = false;
  }
  if (!sum.is_one) sum.sum += offset;
  ++sum.elements;
  if (sum.owner != grip) sum.owner = -1;
}

Vec3d CornerOffsets::offset(NodeIndex node) const {
  const CornerSum& sum = at(node);
  return sum.is_one ? sum.sum : sum.sum / double(sum.elements);
}

HeldCorners::HeldCorners(const VoxelCorners& corners, const std::vector<FemGrip>& grips,
                         bool is_end)
    : m_corners(corners), m_grips(grips), m_at_corners(corners.mesh()) {
  std::map<int, std::vector<std::size_t>> fields;
  for (std::size_t g = 0; g < grips.size(); ++g) fields[grips[g].field].push_back(g);
  for (const auto& [number, members] : fields) say_field(members, is_end);
  if (corners.is_refined()) refine();
}

void HeldCorners::say_field(const std::vector<std::size_t>& members, bool is_end) {
  const Body& body = m_corners.body();
  std::vector<Slot> slots;
  std::vector<Vec3d> offsets, from;
  bool stays = true;
  for (const std::size_t g : members) {
    const FemGrip& grip = m_grips[g];
    grip.slots.for_each([&](Slot slot) { slots.push_back(slot); });
    const std::vector<Vec3d>& there = is_end ? grip.offsets : grip.start;
    offsets.insert(offsets.end(), there.begin(), there.end());
    const std::vector<Vec3d>& begin =
        grip.motion && !grip.motion->from.empty() ? grip.motion->from : grip.start;
    from.insert(from.end(), begin.begin(), begin.end());
    stays = stays && !grip.motion;
  }
  m_at_corners.reserve(slots.size());
  const auto is_zero = [](const Vec3d& offset) { return offset == Vec3d(0.0); };
  if (stays && std::all_of(offsets.begin(), offsets.end(), is_zero)) {
    stay(members);
    return;
  }
  const FieldSteps field(m_corners, slots, offsets);
  std::optional<FieldSteps> other;
  if (from != offsets) other.emplace(m_corners, slots, std::move(from));
  const FieldSteps& before = other ? *other : field;
  std::size_t n = 0;
  for (const std::size_t g : members) {
    const FemGrip& grip = m_grips[g];
    for (std::size_t own = 0; own < grip.start.size(); ++own, ++n) {
      const int piece = body.rigid.at(slots[n]);
      GridSteps steps;
      if (!grip.motion) {
        steps = field.steps(n);
      } else {
        const GridSteps& by = is_end ? grip.motion->after : grip.motion->before;
        steps =
            piece < 0
                ? field.steps(n, one_after(before.steps(n), by))
                : one_after(steps_of_pose(body.geometry, body.rigid.list[std::size_t(piece)]), by);
      }
      const Corners nodes = m_corners(slots[n]);
      for (std::size_t c = 0; c < 8; ++c) {
        const Vec3d way = place_of_corner(c) - Vec3d(0.5);
        m_at_corners.say(nodes[c], offsets[n] + moved(steps, way) - way, grip.rank(piece >= 0),
                         std::int32_t(g));
      }
    }
  }
}

/// Says what say_field() says where all is at rest: all corners stay.
void HeldCorners::stay(const std::vector<std::size_t>& members) {
  for (const std::size_t g : members) {
    m_grips[g].slots.for_each([&](Slot slot) {
      const int rank = m_grips[g].rank(m_corners.body().rigid.at(slot) >= 0);
      for (const NodeIndex node : m_corners(slot)) {
        m_at_corners.say(node, Vec3d(0.0), rank, std::int32_t(g));
      }
    });
  }
}

/// Lets all nodes of the parts of voxels follow the corners of these.
void HeldCorners::refine() {
  m_at_nodes.emplace(m_corners.mesh());
  for (std::size_t g = 0; g < m_grips.size(); ++g) {
    m_grips[g].slots.for_each([&](Slot slot) {
      const Corners nodes = m_corners(slot);
      std::array<Vec3d, 8> at;
      for (std::size_t c = 0; c < 8; ++c) at[c] = m_at_corners.offset(nodes[c]);
      const int rank = m_grips[g].rank(m_corners.body().rigid.at(slot) >= 0);
      m_corners.for_each_node(slot, [&](NodeIndex node, const Vec3d& part) {
        m_at_nodes->say(node, between(at, part), rank, std::int32_t(g));
      });
    });
  }
}

HeldElements HeldCorners::held_by(std::int32_t number) const {
  const FemGrip& grip = m_grips[std::size_t(number)];
  const Geometry& geometry = m_corners.body().geometry;
  const CornerOffsets& held = nodes();
  const auto for_each_node = [&](auto&& visit) {
    grip.slots.for_each([&](Slot slot) {
      const int rank = grip.rank(m_corners.body().rigid.at(slot) >= 0);
      m_corners.for_each_node(slot, [&](NodeIndex node, const Vec3d&) { visit(node, rank); });
    });
  };
  HeldElements out;
  out.elements = grip.slots;
  const Vec3d first = held.offset(m_corners(grip.slots.first())[0]);
  bool goes_as_one = true;
  for_each_node([&](NodeIndex node, int) {
    goes_as_one = goes_as_one && held.owner(node) == number && held.offset(node) == first;
  });
  if (goes_as_one) {
    if (first == Vec3d(0.0)) return out;
    const Vec3d u_mm = geometry.world_vector_from_index(first);
    out.displacement_mm = [u_mm](const Vec3d&) { return u_mm; };
    return out;
  }
  std::vector<NodeIndex> own;  // once for each of its elements
  for_each_node([&](NodeIndex node, int rank) {
    if (held.rank(node) == rank) own.push_back(node);
  });
  std::sort(own.begin(), own.end());
  out.nodes.emplace();
  for (auto begin = own.begin(); begin != own.end();) {
    const auto end = std::upper_bound(begin, own.end(), *begin);
    out.nodes->push_back({*begin, geometry.world_vector_from_index(held.offset(*begin)),
                          double(end - begin) / held.elements(*begin)});
    begin = end;
  }
  return out;
}

std::vector<HeldElements> HeldCorners::elements() const {
  std::vector<HeldElements> all;
  for (std::size_t g = 0; g < m_grips.size(); ++g) all.push_back(held_by(std::int32_t(g)));
  return all;
}

std::vector<GripReach> HeldCorners::reaches() const {
  constexpr double kToldVoxels = 1e-3;
  std::vector<GripReach> told;
  for (std::size_t g = 0; g < m_grips.size(); ++g) {
    const FemGrip& grip = m_grips[g];
    GripReach reach{g, Vec3d(0.0), Vec3d(0.0), 0};
    std::size_t n = 0;
    grip.slots.for_each([&](Slot slot) {
      Vec3d mean(0.0);
      bool is_shared = false;
      for (const NodeIndex node : m_corners(slot)) {
        mean += m_at_corners.offset(node) / 8;
        is_shared = is_shared || m_at_corners.owner(node) != std::int32_t(g);
      }
      const Vec3d& asked = grip.offsets[n++];
      if (!is_shared) mean = asked;
      reach.asked += asked / double(grip.offsets.size());
      reach.reached += mean / double(grip.offsets.size());
      reach.off_voxels = std::max(reach.off_voxels, (mean - asked).length());
    });
    if (reach.off_voxels > kToldVoxels) told.push_back(reach);
  }
  return told;
}

}  // namespace supple
