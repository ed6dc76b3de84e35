#include "lib/fem/voxel/cell_classes.h"

#include <map>
#include <tuple>

namespace supple {

GroupKind CellClasses::kind(std::size_t cell) const {
  if (present[cell] == 0) return GroupKind::held;
  if (constraint[cell] >= 0) return GroupKind::constrained;
  if (present[cell] != 0xff) return GroupKind::mixed;
  for (const std::uint8_t of : of_child[cell]) {
    if (of != of_child[cell][0]) return GroupKind::mixed;
  }
  return GroupKind::alike;
}

namespace {

/// Finds per class the first with its moduli: densities of one tissue have many classes.
std::array<std::uint8_t, 256> first_alike(const ModuliTable<double>& moduli) {
  std::array<std::uint8_t, 256> first;
  std::map<std::tuple<double, double, double>, std::uint8_t> known;
  for (int n = 0; n < 256; ++n) {
    first[n] =
        known.try_emplace({moduli.shear[n], moduli.bulk[n], moduli.inertia[n]}, std::uint8_t(n))
            .first->second;
  }
  return first;
}

}  // namespace

CellClasses cell_classes(const HexMesh& voxels, const Coarsening& coarsening,
                         const VoxelMaterial& material, const HeldBits& held, int cells) {
  const std::array<std::uint8_t, 256> alike = first_alike(material.moduli);
  CellClasses out;
  out.of_child.resize(cells);
  out.present.assign(cells, 0);
  out.constraint.assign(cells, -1);
  const auto note = [&](std::size_t block, std::int32_t e) {
    const std::uint32_t bits = held_corners(voxels.corners_in(block, e), held);
    if (bits == kAllCornersHeld) return;
    const std::int32_t cell = coarsening.parent_of(block, e);
    const Vec3i local = brick_local(voxels.offset[e]);
    const int child = (local.x & 1) * 4 + (local.y & 1) * 2 + (local.z & 1);
    out.of_child[cell][child] = alike[material.classes[e]];
    out.present[cell] = std::uint8_t(out.present[cell] | 1 << child);
    if (bits == 0) return;
    if (out.constraint[cell] < 0) {
      out.constraint[cell] = std::int32_t(out.held.size());
      out.held.push_back({});
    }
    out.held[out.constraint[cell]][child] = bits;
  };
  for (std::size_t b = 0; b < voxels.block_count(); ++b) {
    for (std::int32_t e = voxels.element_begin[b]; e < voxels.element_begin[b + 1]; ++e) note(b, e);
  }
  return out;
}

}  // namespace supple
