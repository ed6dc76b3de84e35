// Elastic constants of elements from the densities of the voxels in them, by a material's curves.
//
// Stiffness and Poisson's ratio of an element are the means of those of its voxels' densities, not
// those of their mean density: a thin wall in an element counts by its part. Elements of similar
// stiffness share a material, whose constants are their means by volume.
// Cost: some 30 ns per voxel and 0.3 us per element.
#pragma once

#include <map>

#include "lib/material/material.h"
#include "lib/mesh/tets/element_regions.h"
#include "lib/mesh/tets/mask_distance.h"
#include "volumes/grid/density_grid.h"
#include "volumes/io/solid/solid_mesh.h"

namespace supple {

struct ElasticCurves {
  Curve young_kpa, poisson;
};
/// The curves of the common table, and those of labels that have a table of their own.
struct ElasticOfLabels {
  ElasticCurves common;
  std::map<std::int32_t, ElasticCurves> of_labels;
};
/// Throws InputError where the common table has no stiffness. Poisson's ratio is kDefaultPoisson
/// where there is no curve.
ElasticOfLabels elastic_curves(const MaterialTable& material);

/// Gives every element a material, at most `bins` of them: steps of equal ratio of stiffness.
/// Voxels of the mask count alone; an element that holds no centre of one takes those nearest to
/// its corners, and where there are none either, the mean of all others. `label_of` chooses the
/// table of a voxel; empty: the common one.
void give_materials(SolidMesh& mesh, const VoxelMask& mask, const DensityGrid& density,
                    const ElasticOfLabels& elastic, const VoxelLabel& label_of, int bins);

}  // namespace supple
