#include "lib/fem/voxel/voxel_material.h"

#include <algorithm>
#include <array>
#include <limits>

#include "lib/fem/voxel/hex_mesh.h"

namespace supple {

namespace {

void fill_single(VoxelMaterial& material) {
  for (std::size_t n = 0; n < material.moduli.shear.size(); ++n) {
    material.moduli_single.shear[n] = float(material.moduli.shear[n]);
    material.moduli_single.bulk[n] = float(material.moduli.bulk[n]);
    material.moduli_single.inertia[n] = float(material.moduli.inertia[n]);
  }
}

}  // namespace

VoxelMaterial voxel_material(const Body& body, const ElasticTable& elastic, Dilatation dilatation) {
  elastic.validate();
  VoxelMaterial out;
  out.matrix = element_matrix(body.geometry.axes_mm(), dilatation);
  for (int n = 0; n <= kLastClass; ++n) {
    const ElasticModuli moduli = elastic_moduli(elastic.young_kpa[n], elastic.poisson[n]);
    out.moduli.shear[n] = moduli.shear_kpa;
    out.moduli.bulk[n] = moduli.bulk_kpa;
  }
  fill_single(out);
  out.classes.reserve(std::size_t(body.elements.active_count()));
  for (std::size_t b = 0; b < body.elements.brick_count(); ++b) {
    for_each_active(body.elements.mask(b), [&](int offset) {
      out.classes.push_back(body.classes[b * kBrickVoxels + offset]);
    });
  }
  return out;
}

VoxelMaterial weighted_material(const VoxelMaterial& material, const ElementWeights& weights) {
  VoxelMaterial out = material;
  out.moduli = weighted_moduli(material.moduli, weights);
  fill_single(out);
  return out;
}

double free_contrast(const HexMesh& mesh, const VoxelMaterial& material, const HeldBits& held) {
  std::array<bool, 256> is_there{};
  for (std::size_t b = 0; b < mesh.block_count(); ++b) {
    for (auto e = mesh.element_begin[b]; e < mesh.element_begin[b + 1]; ++e) {
      bool& is_of_class = is_there[material.classes[std::size_t(e)]];
      if (is_of_class) continue;
      const Corners corners = mesh.corners_in(b, e);
      is_of_class = std::any_of(corners.begin(), corners.end(), [&](NodeIndex node) {
        return held[std::size_t(node)] != kAllHeld;
      });
    }
  }
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (std::size_t of = 0; of < is_there.size(); ++of) {
    if (!is_there[of]) continue;
    const double shear = material.moduli.shear[of];
    least = std::min(least, shear);
    most = std::max(most, shear);
  }
  return most > 0 && least > 0 ? most / least : 1;
}

}  // namespace supple
