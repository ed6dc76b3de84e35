#include "lib/model/field_steps.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace supple {

namespace {

/// Offsets are rounded to 2^-16 voxel. An affine motion that misses them by more than this is not
/// theirs.
constexpr double kMisfitVoxels = 1e-3;
constexpr double kFlat = 1e-9;

/// The smallest turn from one direction to another.
Turn smallest_turn(const Vec3d& from, const Vec3d& to) {
  const double cosine = from.dot(to);
  const Vec3d axis = from.cross(to);
  if (1 + cosine < kFlat) return {};  // straight back: about no axis more than another
  return Turn{1 + cosine, axis}.unit();
}

Vec3d any_perpendicular(const Vec3d& direction) {
  const Vec3d least = std::abs(direction.x) < 0.6 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0);
  return direction.cross(least).normalized();
}

}  // namespace

GridSteps completed_steps(const Geometry& geometry, const std::vector<Vec3d>& directions,
                          const std::vector<Vec3d>& images) {
  std::vector<Vec3d> of, to;  // perpendicular, of unit length in mm, and where they go
  for (std::size_t n = 0; n < directions.size(); ++n) {
    Vec3d direction = geometry.world_vector_from_index(directions[n]);
    Vec3d image = geometry.world_vector_from_index(images[n]);
    for (std::size_t m = 0; m < of.size(); ++m) {
      const double part = direction.dot(of[m]);
      direction -= of[m] * part;
      image -= to[m] * part;
    }
    const double length = direction.length();
    of.push_back(direction / length);
    to.push_back(image / length);
  }
  if (of.empty()) return kUnitSteps;
  if (of.size() == 1) {
    const double length = to[0].length();
    const Turn turn = length > kFlat ? smallest_turn(of[0], to[0] / length) : Turn();
    of.push_back(any_perpendicular(of[0]));
    to.push_back(turn(of[1]));
  }
  if (of.size() == 2) {
    const Vec3d normal = to[0].cross(to[1]);
    of.push_back(of[0].cross(of[1]));
    to.push_back(normal.length() > kFlat ? normal.normalized() : of[2]);
  }
  GridSteps steps;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Vec3d image(0.0);
    for (std::size_t n = 0; n < 3; ++n) image += to[n] * of[n].dot(geometry.axes_mm()[axis]);
    steps[axis] = geometry.index_vector_from_world(image);
  }
  return steps;
}

FieldSteps::FieldSteps(const VoxelCorners& corners, std::vector<Slot> slots,
                       std::vector<Vec3d> offsets)
    : m_body(corners.body()), m_slots(std::move(slots)), m_offsets(std::move(offsets)) {
  const auto is_first = [&](const Vec3d& offset) { return offset == m_offsets.front(); };
  if (std::all_of(m_offsets.begin(), m_offsets.end(), is_first)) return;
  find_neighbours(corners);
  find_motions();
}

GridSteps FieldSteps::steps(std::size_t n, const GridSteps& across) const {
  if (m_beside.empty()) return across;
  GridSteps found = across;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int32_t low = m_beside[n][2 * axis], high = m_beside[n][2 * axis + 1];
    if (low < 0 && high < 0) continue;
    const Vec3d& before = m_offsets[std::size_t(low < 0 ? std::int32_t(n) : low)];
    const Vec3d& after = m_offsets[std::size_t(high < 0 ? std::int32_t(n) : high)];
    found[axis] = kUnitSteps[axis] + (after - before) / ((low >= 0) + (high >= 0));
  }
  return found;
}

GridSteps FieldSteps::steps(std::size_t n) const {
  if (m_beside.empty()) return kUnitSteps;
  if (m_motion_of[n] >= 0) return steps(n, m_motions[std::size_t(m_motion_of[n])]);
  const GridSteps known = steps(n, kUnitSteps);
  std::vector<Vec3d> directions, images;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!has_neighbour(n, axis)) continue;
    directions.push_back(kUnitSteps[axis]);
    images.push_back(known[axis]);
  }
  return steps(n, completed_steps(m_body.geometry, directions, images));
}

/// Finds neighbours across faces whose four nodes are those of both; pieces have their own.
void FieldSteps::find_neighbours(const VoxelCorners& corners) {
  std::unordered_map<Slot, std::int32_t> number;
  for (std::size_t n = 0; n < m_slots.size(); ++n) number[m_slots[n]] = std::int32_t(n);
  m_beside.assign(m_slots.size(), {-1, -1, -1, -1, -1, -1});
  for (std::size_t n = 0; n < m_slots.size(); ++n) {
    const Corners own = corners(m_slots[n]);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Vec3i voxel = voxel_of(m_body.elements, m_slots[n]);
      voxel[int(axis)] += 1;
      Slot slot;
      if (!slot_of(m_body.elements, voxel, slot)) continue;
      const auto found = number.find(slot);
      if (found == number.end() || m_body.rigid.at(slot) != m_body.rigid.at(m_slots[n])) continue;
      const Corners there = corners(slot);
      const std::size_t bit = 4u >> axis;
      bool is_joined = true;
      for (std::size_t c = 0; c < 8; ++c) {
        if ((c & bit) != 0) is_joined = is_joined && own[c] == there[c ^ bit];
      }
      if (!is_joined) continue;
      m_beside[n][2 * axis + 1] = found->second;
      m_beside[std::size_t(found->second)][2 * axis] = std::int32_t(n);
    }
  }
}

/// Finds the motions of connected elements, where one of them needs it.
void FieldSteps::find_motions() {
  m_motion_of.assign(m_slots.size(), -1);
  std::vector<char> is_seen(m_slots.size(), 0);
  for (std::size_t n = 0; n < m_slots.size(); ++n) {
    if (is_seen[n]) continue;
    std::vector<std::size_t> part{n};
    bool is_wanted = false;
    is_seen[n] = 1;
    for (std::size_t at = 0; at < part.size(); ++at) {
      for (const std::int32_t beside : m_beside[part[at]]) {
        if (beside < 0 || is_seen[std::size_t(beside)]) continue;
        is_seen[std::size_t(beside)] = 1;
        part.push_back(std::size_t(beside));
      }
      for (std::size_t axis = 0; axis < 3; ++axis) {
        is_wanted = is_wanted || !has_neighbour(part[at], axis);
      }
    }
    if (is_wanted) fit(part);
  }
}

/// Finds the affine motion of the elements furthest from each other; keeps it if it is that of all.
void FieldSteps::fit(const std::vector<std::size_t>& part) {
  const Vec3d origin = rest(part.front()), offset = m_offsets[part.front()];
  std::vector<Vec3d> basis, directions, images;
  while (basis.size() < 3) {
    double most = kFlat;
    Vec3d furthest;
    std::size_t of = 0;
    for (const std::size_t n : part) {
      Vec3d left = rest(n) - origin;
      for (const Vec3d& direction : basis) left -= direction * left.dot(direction);
      if (left.length2() <= most) continue;
      most = left.length2();
      furthest = left;
      of = n;
    }
    if (most == kFlat) break;
    basis.push_back(furthest.normalized());
    directions.push_back(rest(of) - origin);
    images.push_back(directions.back() + m_offsets[of] - offset);
  }
  const GridSteps motion = completed_steps(m_body.geometry, directions, images);
  for (const std::size_t n : part) {
    const Vec3d way = rest(n) - origin;
    if ((moved(motion, way) - way - (m_offsets[n] - offset)).length() > kMisfitVoxels) return;
  }
  for (const std::size_t n : part) m_motion_of[n] = std::int32_t(m_motions.size());
  m_motions.push_back(motion);
}

}  // namespace supple
