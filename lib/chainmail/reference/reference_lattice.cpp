#include "lib/chainmail/reference/reference_lattice.h"

#include "lib/body/slot_set.h"
#include "volumes/base/error.h"

namespace supple::reference {

Offsets ReferenceLattice::at_rest() const {
  Offsets offsets;
  for (auto& coordinate : offsets) coordinate.assign(size(), 0);
  return offsets;
}

ReferenceLattice lattice_of(const Body& body) {
  ReferenceLattice lattice;
  if (body.slacks.links() != 6) throw Error("reference lattice: found diagonals, expected 6 links");
  if (body.elements.empty()) return lattice;
  const IndexBox& bounds = body.elements.active_bounds();
  lattice.origin = bounds.lo;
  lattice.dims = bounds.hi - bounds.lo + Vec3i(1);
  lattice.mask.assign(lattice.size(), 0);
  lattice.slacks.resize(lattice.size());
  const auto index_of = [&](Slot slot) {
    return lattice.index(voxel_of(body.elements, slot) - lattice.origin);
  };
  for_each_element(body.elements, [&](Slot slot) { lattice.mask[index_of(slot)] = 1; });
  for (std::size_t b = 0; b < body.elements.brick_count(); ++b) {
    for_each_link(body.elements, body.cuts, b, [&](int axis, Slot low, Slot high) {
      lattice.slacks[index_of(low)][axis] =
          body.slacks.slack(axis, body.classes[low], body.classes[high]);
    });
  }
  if (body.cuts.empty()) return lattice;
  lattice.cut.assign(lattice.size(), 0);
  for_each_element(body.elements, [&](Slot slot) {
    for (int axis = 0; axis < 3; ++axis) {
      const bool cut = body.cuts.is_cut(slot / kBrickVoxels, int(slot % kBrickVoxels), axis);
      lattice.cut[index_of(slot)] |= std::uint8_t(cut << axis);
    }
  });
  return lattice;
}

Offsets offsets_of(const Body& body, const ReferenceLattice& lattice) {
  Offsets offsets = lattice.at_rest();
  for_each_element(body.elements, [&](Slot slot) {
    const std::size_t index = lattice.index(voxel_of(body.elements, slot) - lattice.origin);
    for (int c = 0; c < 3; ++c) offsets[c][index] = body.q[c].at(slot);
  });
  return offsets;
}

Body with_offsets(const Body& body, const ReferenceLattice& lattice, const Offsets& offsets) {
  Body changed = body;
  changed.links_known_valid = false;
  for (auto& coordinate : changed.q) coordinate = BrickValues(body.elements.brick_count());
  for_each_element(body.elements, [&](Slot slot) {
    const std::size_t index = lattice.index(voxel_of(body.elements, slot) - lattice.origin);
    for (int c = 0; c < 3; ++c) {
      if (offsets[c][index] != 0) changed.q[c].set(slot, offsets[c][index]);
    }
  });
  return changed;
}

}  // namespace supple::reference
