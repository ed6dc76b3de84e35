// Material of the voxels of a mesh.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/body/body.h"
#include "lib/fem/elastic_law.h"
#include "lib/fem/voxel/element_matrix.h"

namespace supple {

struct VoxelMaterial {
  ElementMatrix matrix;
  ModuliTable<double> moduli;
  ModuliTable<float> moduli_single;
  std::vector<std::uint8_t> classes;  // per element
};

/// Makes the material of a body's elements. Throws InputError as ElasticTable::validate().
VoxelMaterial voxel_material(const Body& body, const ElasticTable& elastic, Dilatation dilatation);

/// The same elements with the moduli of a sum of stiffness and mass. Throws InputError.
VoxelMaterial weighted_material(const VoxelMaterial& material, const ElementWeights& weights);

}  // namespace supple
