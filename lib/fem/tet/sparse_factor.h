// Exact factors K = L L^T of a symmetric positive definite matrix of 3 x 3 blocks, for many
// right-hand sides, by fronts (Duff & Reid 1983) in an order by nested dissection (George 1973).
//
// The nodes are halved along their longest extent again and again; those of one half that have
// neighbours in the other form a border, which is eliminated after both. Halves and borders are a
// tree. Each part of it has a front: a dense matrix of its own unknowns and of those outside that
// they are coupled with. It takes what its two halves leave behind, eliminates its own, and leaves
// the rest. Fronts of different halves are found at the same time, each in the same way whatever
// the number of threads.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "lib/fem/nodal_loads.h"
#include "lib/fem/tet/block_csr.h"

namespace supple {

class SparseFactor {
 public:
  /// Held components count as those of the identity. Throws Error unless the rest is positive
  /// definite.
  SparseFactor(const BlockCsr& matrix, const HeldBits& held, const std::vector<Vec3d>& positions);
  ~SparseFactor();

  /// z = K^-1 r, 0 where something is held.
  void solve(const double* r, double* z) const;
  std::size_t entry_count() const;
  std::size_t bytes() const { return entry_count() * sizeof(double); }

 private:
  struct Parts;
  std::unique_ptr<Parts> m_parts;
};

}  // namespace supple
