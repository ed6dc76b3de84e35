// Values between the nodes of a mesh and of the next coarser one by trilinear interpolation, and
// forces back by its transpose. Nodes whose inverse diagonal is 0 are held: they receive nothing
// and send nothing.
#pragma once

#include <vector>

#include "lib/fem/voxel/hex_mesh.h"
#include "lib/fem/voxel/short_float.h"

namespace supple {

class Transfer {
 public:
  /// All must outlive this.
  Transfer(const HexMesh& fine, const HexMesh& coarse, const Coarsening& coarsening)
      : m_fine(&fine), m_coarse(&coarse), m_coarsening(&coarsening) {}

  /// fine = P coarse.
  void prolong(const float* coarse, const ShortFloat* inverse_diagonal, float* fine) const;
  /// coarse = P^T fine.
  void restrict_to(const float* fine, const ShortFloat* inverse_diagonal, float* coarse) const;

 private:
  template <class Visit>
  void for_nodes_of_block(std::size_t block, Visit&& visit) const;

  const HexMesh* m_fine;
  const HexMesh* m_coarse;
  const Coarsening* m_coarsening;
};

}  // namespace supple
