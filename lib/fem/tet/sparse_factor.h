// Exact factors of a symmetric positive definite matrix of 3 x 3 blocks, for many right-hand sides:
// Eigen's simplicial Cholesky in an order by nested dissection (George 1973): the nodes are halved
// along their longest extent again and again, and those of one half that have neighbours in the
// other come after both.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "lib/fem/nodal_loads.h"
#include "lib/fem/tet/block_csr.h"

namespace supple {

/// Nodes in an order of elimination that leaves few entries.
std::vector<NodeIndex> nested_dissection(const BlockCsr& matrix,
                                         const std::vector<Vec3d>& positions);

class SparseFactor {
 public:
  /// Held components count as those of the identity. Throws Error unless the rest is positive
  /// definite.
  SparseFactor(const BlockCsr& matrix, const HeldBits& held, const std::vector<Vec3d>& positions);
  ~SparseFactor();

  /// z = K^-1 r, 0 where something is held.
  void solve(const double* r, double* z) const;
  std::size_t entry_count() const;
  std::size_t bytes() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> m_parts;
};

}  // namespace supple
