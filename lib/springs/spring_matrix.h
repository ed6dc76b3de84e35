// The matrix of implicit steps: masses on the diagonal, and the second derivatives of the springs,
// made positive semidefinite: across a compressed spring k (1 - R / |x|) is negative and is taken
// as 0 (Choi and Ko, Stable but responsive cloth, 2002). An awake barrier counts by an upper bound.
//
// Surfaces and chains are solved by their factors. In solids the factors fill up (a cube of 16^3
// nodes takes 2.8 s): beyond 2 10^7 products of blocks, or 20,000 nodes, conjugate gradients take
// over.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "lib/springs/block_ldlt.h"
#include "lib/springs/spring_system.h"
#include "lib/springs/symmetric_block.h"
#include "volumes/base/progress.h"

namespace supple {

// Conjugate gradients for symmetric positive definite matrices of 3 x 3 blocks, preconditioned by
// the blocks of the diagonal: for solids, whose factors fill up. Rows share the threads; sums are
// taken in blocks of rows, so that results do not depend on how many threads there are.
// Cost: 16 bytes per coupling and 52 per row beside the blocks, 96 per row more while it solves.

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

/// A node that slips along a surface, which friction of at most `friction_mn` hinders.
struct SlidingNode {
  int node;
  Vec3d normal;
  Vec3d slip_mm;  // along the surface
  double friction_mn;
  Vec3d back_mm{0, 0, 0};
};

class SpringMatrix {
 public:
  /// Analyses the pattern: masses, springs and held nodes as they are. Keeps no reference. Throws
  /// Cancelled.
  SpringMatrix(const SpringSystem& system, const std::vector<char>& is_held,
               const Progress* progress = nullptr);
  SpringMatrix(const SpringMatrix&) = delete;
  SpringMatrix& operator=(const SpringMatrix&) = delete;

  /// Assembles A = diag(mass_factor m) + K(pos) + damping_factor sum d n n^T, n along the springs
  /// of `damping_pos`. In mN/mm. Throws Cancelled.
  void assemble(const SpringSystem& system, double mass_factor, double damping_factor,
                const std::vector<Vec3d>& damping_pos, const Progress* progress = nullptr);
  /// Assembles the same, pressed nodes as good as fixed along their normals; then finds its
  /// factors. False when A is not positive definite.
  bool factorise(const SpringSystem& system, double mass_factor, double damping_factor,
                 const std::vector<Vec3d>& damping_pos,
                 const std::vector<PressedNode>& pressed = {}, const Progress* progress = nullptr);
  /// Solves A x = b for the free nodes, in place; 0 for held ones. Conjugate gradients end at
  /// `tolerance` times |b| (BlockGradients::solve) and throw Cancelled.
  void solve(std::vector<Vec3d>& x, double tolerance, const Progress* progress = nullptr);

  /// Applies Coulomb's law after assemble(): finds the ways back y along the surfaces that minimise
  /// y A y / 2 + sum of friction |slip + y|, all other nodes at rest. Sweeps node by node.
  void take_back(std::vector<SlidingNode>& sliding) const;

  bool is_direct() const { return m_factors.has_value(); }
  std::size_t bytes() const;

 private:
  struct SpringRows {
    int a, b;      // rows of the ends; -1: held
    int coupling;  // -1: none
  };
  struct Pattern {
    std::vector<int> row_of_node;
    std::vector<int> node_of_row;
    std::vector<std::array<int, 2>> couplings;  // ascending, those of a row one after the other
    std::vector<int> first_of_row;              // among them, and one more
    std::vector<int> coupling_of_spring;        // -1: none

    /// Coupling of two rows; -1: none.
    int coupling_of(int a, int b) const;
  };
  static Pattern analyse(const SpringSystem& system, const std::vector<char>& is_held,
                         const Progress* progress);

  void add_block(const SpringRows& place, const SymmetricBlock& block);
  void add_barrier(const SpringSystem& system);

  Pattern m_pattern;
  std::optional<BlockLdlt> m_factors;
  std::optional<BlockGradients> m_gradients;  // where there are no factors
  std::vector<SymmetricBlock> m_diagonal, m_coupling;
  std::vector<Vec3d> m_rows;
};

}  // namespace supple
