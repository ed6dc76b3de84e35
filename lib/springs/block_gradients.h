// Conjugate gradients for symmetric positive definite matrices of 3 x 3 blocks, preconditioned by
// the blocks of the diagonal: for solids, whose factors fill up. Rows share the threads; sums are
// taken in blocks of rows, so that results do not depend on how many threads there are.
// Cost: 16 bytes per coupling and 52 per row beside the blocks, 96 per row more while it solves.
#pragma once

#include <array>
#include <vector>

#include "lib/springs/symmetric_block.h"
#include "volumes/base/progress.h"

namespace supple {

class BlockGradients {
 public:
  /// `couplings`: pairs of different rows, each pair once.
  BlockGradients(int rows, const std::vector<std::array<int, 2>>& couplings);

  /// Takes the matrix, which is read where it lies. False when a block of its diagonal is not
  /// positive definite.
  bool prepare(const std::vector<SymmetricBlock>& diagonal,
               const std::vector<SymmetricBlock>& coupling);

  /// Solves A x = b in place, down to `tolerance` times |b|, or after 3,000 steps with the iterate
  /// at hand, which goes downhill in any case. Throws Cancelled.
  void solve(std::vector<Vec3d>& b, double tolerance, const Progress* progress) const;

  std::size_t bytes() const;

 private:
  struct Entry {
    int row, coupling;
  };
  struct Sums {
    double first = 0, second = 0;
    Sums operator+(const Sums& other) const { return {first + other.first, second + other.second}; }
  };
  template <class OfRow>
  Sums sum(const OfRow& of_row) const;
  Vec3d product(const std::vector<Vec3d>& x, std::size_t row) const;

  std::vector<int> m_first;      // entry of each row; one more at the end
  std::vector<Entry> m_entries;  // ascending by row
  const SymmetricBlock* m_diagonal = nullptr;
  const SymmetricBlock* m_coupling = nullptr;
  std::vector<SymmetricBlock> m_inverse_diagonal;
};

}  // namespace supple
