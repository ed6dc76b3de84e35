#include "lib/fem/voxel/contrast.h"

#include <algorithm>
#include <array>
#include <limits>

namespace supple {

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
