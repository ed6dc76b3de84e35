// The voxels of a body halved along each axis, once or more: the same shape, classes and cuts, for
// finite elements that are smaller than voxels.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/body/body.h"
#include "lib/body/slot_set.h"
#include "lib/fem/voxel/hex_mesh.h"

namespace supple {

/// Most halvings: elements of 1/8 of a voxel's edge are 512 times as many.
constexpr int kMostHalvings = 3;

class RefinedShape {
 public:
  /// `halvings`: 1 to kMostHalvings.
  RefinedShape(const Body& coarse, int halvings);

  /// The refined body: elements, classes, cuts and geometry; at rest.
  const Body& body() const { return m_fine; }
  /// Number of parts of each edge of a voxel.
  int parts() const { return m_parts; }

  /// The elements that a set of the body consists of, whose elements are `coarse`.
  SlotSet parts_of(const SlotSet& set, const BrickTopology& coarse) const;
  /// The same of one voxel, as numbers of elements of `mesh`, that of body().
  std::vector<std::int32_t> parts_of(const HexMesh& mesh, const Vec3i& voxel) const;
  /// The vector at the centre of a coarse voxel; `values` are three per node of that mesh.
  Vec3d at_centre(const HexMesh& mesh, const std::vector<double>& values, const Vec3i& voxel) const;

 private:
  std::int32_t element_of(const HexMesh& mesh, const Vec3i& fine) const;

  int m_parts;  // of an edge
  Body m_fine;
};

}  // namespace supple
