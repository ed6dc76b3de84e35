#include "lib/model/refined_shape.h"

#include <stdexcept>

namespace supple {

namespace {

Vec3i halved(const Vec3i& fine, int halvings) {
  return {fine.x >> halvings, fine.y >> halvings, fine.z >> halvings};
}

Geometry refined_geometry(const Geometry& coarse, int parts) {
  std::array<Vec3d, 3> axes = coarse.axes_mm();
  for (Vec3d& axis : axes) axis /= parts;
  return Geometry(coarse.dims() * parts, coarse.world_from_index(Vec3d(0.5 / parts - 0.5)), axes);
}

BrickTopology refined_elements(const BrickTopology& coarse, int halvings) {
  const int parts = 1 << halvings;
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  for (std::size_t b = 0; b < coarse.brick_count(); ++b) {
    for (int n = 0; n < parts * parts * parts; ++n) {
      const Vec3i place(n / (parts * parts), n / parts % parts, n % parts);
      const Vec3i origin = coarse.origin(b) * parts + place * kBrickDim;
      BrickMask mask{};
      for (int offset = 0; offset < kBrickVoxels; ++offset) {
        const Vec3i voxel = halved(origin + brick_local(offset), halvings);
        if (mask_test(coarse.mask(b), brick_offset(voxel))) mask_set(mask, offset);
      }
      origins.push_back(origin);
      masks.push_back(mask);
    }
  }
  return BrickTopology(std::move(origins), std::move(masks));
}

}  // namespace

RefinedShape::RefinedShape(const Body& coarse, int halvings) : m_parts(1 << halvings) {
  if (halvings < 1 || halvings > kMostHalvings) throw std::logic_error("halvings of voxels");
  m_fine.geometry = refined_geometry(coarse.geometry, m_parts);
  m_fine.elements = refined_elements(coarse.elements, halvings);
  m_fine.classes.resize(slot_count(m_fine.elements));
  for_each_element(m_fine.elements, [&](Slot slot) {
    const Vec3i fine = voxel_of(m_fine.elements, slot);
    Slot of = 0;
    slot_of(coarse.elements, halved(fine, halvings), of);
    m_fine.classes[slot] = coarse.classes[of];
    if (coarse.cuts.empty()) return;
    for (int axis = 0; axis < 3; ++axis) {
      const bool is_outer = (fine[axis] & (m_parts - 1)) == m_parts - 1;
      if (!is_outer || !coarse.cuts.is_cut(of / kBrickVoxels, int(of % kBrickVoxels), axis))
        continue;
      m_fine.cuts.cut(slot / kBrickVoxels, int(slot % kBrickVoxels), axis);
    }
  });
}

SlotSet RefinedShape::parts_of(const SlotSet& set, const BrickTopology& coarse) const {
  std::vector<Slot> slots;
  set.for_each([&](Slot slot) {
    const Vec3i first = voxel_of(coarse, slot) * m_parts;
    for (int n = 0; n < m_parts * m_parts * m_parts; ++n) {
      Slot part = 0;
      slot_of(m_fine.elements,
              first + Vec3i(n / (m_parts * m_parts), n / m_parts % m_parts, n % m_parts), part);
      slots.push_back(part);
    }
  });
  return SlotSet(std::move(slots));
}

std::int32_t RefinedShape::element_of(const HexMesh& mesh, const Vec3i& fine) const {
  Slot slot;
  if (!slot_of(m_fine.elements, fine, slot)) throw std::logic_error("a part of no element");
  return element_at(mesh, slot / kBrickVoxels, int(slot % kBrickVoxels));
}

std::vector<std::int32_t> RefinedShape::parts_of(const HexMesh& mesh, const Vec3i& voxel) const {
  std::vector<std::int32_t> parts;
  for (int n = 0; n < m_parts * m_parts * m_parts; ++n) {
    const Vec3i place(n / (m_parts * m_parts), n / m_parts % m_parts, n % m_parts);
    parts.push_back(element_of(mesh, voxel * m_parts + place));
  }
  return parts;
}

Vec3d RefinedShape::at_centre(const HexMesh& mesh, const std::vector<double>& values,
                              const Vec3i& voxel) const {
  // The middle is the last corner of the part before it.
  const std::int32_t e = element_of(mesh, voxel * m_parts + Vec3i(m_parts / 2 - 1));
  const double* value = &values[3 * std::size_t(mesh.corners(e)[7])];
  return {value[0], value[1], value[2]};
}

}  // namespace supple
