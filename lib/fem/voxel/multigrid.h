// A geometric multigrid cycle as preconditioner, in single precision: a V-cycle on the two finest
// levels, which have nearly all unknowns, and below a K-cycle (Notay and Vassilevski 2008): a few
// steps of conjugate gradients with the cycle of the levels below as preconditioner. A plate or a
// beam one voxel thick is stiffer on every next level, by a factor of up to four, so that a V-cycle
// alone loses the more the deeper it goes: on a head it needs twice as many iterations.
//
// Coarse operators are P^T K P of the voxels' own stiffnesses on every level (Galerkin), with
// prescribed nodes left out of P, so that held single voxels count on all levels. Levels 0 and 1
// have no matrix (hex_operator.h), coarser ones have blocks per pair of nodes (block_matrix.h), the
// coarsest is factorised (coarsest_solver.h).
//
// Thin parts, which no coarse cell can bend, have a coarse space of their own (thin_pieces.h), and
// are smoothed further, before and after: what is left there after some iterations is nearly all
// that is left of a head. That takes up to 32 products with K of their elements in a cycle, and 24
// bytes per node of theirs. Products leave out groups of elements that are held as a whole.
//
// Smoother: Chebyshev polynomials of D^-1 K (chebyshev.h), the same before and after the coarse
// correction, so that the V-cycle is symmetric and positive definite; the steps of conjugate
// gradients below make the whole nonlinear by a little. All needs nothing but K x and sums in a
// fixed order, which makes it parallel with the same bits for any number of threads.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "lib/fem/voxel/cell_classes.h"
#include "lib/fem/voxel/coarsest_solver.h"
#include "lib/fem/voxel/hex_operator.h"
#include "lib/fem/voxel/short_float.h"
#include "lib/fem/voxel/thin_pieces.h"
#include "lib/fem/voxel/transfer.h"
#include "volumes/base/progress.h"

namespace supple {

/// The defaults are the best of degrees 2 to 4 and ranges 4 to 25 over a cube (nu = 0.3, 0.45), a
/// stiff shell and 30 % stiff voxels: about the time of degree 2, with a fifth fewer iterations.
struct SmootherParams {
  int degree = 3;  // products with K before the coarse correction, and as many after it
  /// Damps eigenvalues from 1/`range` of the largest one on.
  double range = 15;
};

class Multigrid {
 public:
  /// `levels`, `fine`, the operator of the voxels, and `material` must outlive this. Levels below
  /// `first` are not smoothed: for solve_at() of `first`, or a coarser one.
  Multigrid(const MeshLevels& levels, const HexOperator& fine, const VoxelMaterial& material,
            const HeldBits& held, const SmootherParams& params, Progress* progress, int first = 0);
  /// Prepares levels from `first` on, too, as if it had been made so. `held` is that of before.
  /// Throws Cancelled, all as it was.
  void extend(int first, const HeldBits& held, Progress* progress);

  /// z = B r, r three values per node of the voxels; held components of r do not count, those of z
  /// are 0. `r` is used up. What pieces of thin parts can do is exact: B K z = z for their motions.
  void cycle(float* r, float* z, const Progress* progress = nullptr);

  /// The equations of one level from 1 on, whose displacements are those that its mesh can have:
  /// first the forces r of the voxels' nodes, of which it returns those of the level's nodes until
  /// they are solved for; then steps of conjugate gradients, at most so many, until these forces
  /// are `tolerance` of what they were, and how many that took; then the displacements z of the
  /// voxels' nodes. Throws Cancelled.
  const std::vector<float>& restrict_to(int level, const float* r);
  int solve_at(int level, double tolerance, int most_steps, const Progress* progress);
  void prolong_from(int level, float* z);

  int level_count() const { return int(m_levels.size()) + 1; }
  std::size_t bytes() const;

 private:
  struct Level {
    const HexOperator* fine = nullptr;         // level 0
    std::optional<GroupsAtNodes> free;         // of it, where many nodes are held
    std::optional<HexOperator> cells;          // level 1
    std::optional<BlockMatrix<float>> matrix;  // from level 2 on
    std::optional<Transfer> transfer;
    std::vector<ShortFloat> inverse_diagonal;  // of D; 0: held
    double largest_eigenvalue = 0;
    std::vector<float> r, z, d;          // r and z of level 0 are the caller's
    std::vector<float> rest, sum, p, q;  // of the K-cycle

    void subtract(const float* x, float* y) const;
    void make_room_for_steps();
    std::size_t unknowns() const { return inverse_diagonal.size(); }
  };
  void leave_out_held(const HeldBits& held);
  void prepare_thin();
  void invert_diagonal(Level& level, const std::vector<float>& diagonal, const HeldBits* held);
  void cycle_from(std::size_t level, float* r, float* z);
  void solve_from(std::size_t level, float* r, float* z);
  int take_steps(std::size_t level, int most_steps, double tolerance, float* r, float* z);
  std::vector<float>& forces_of(std::size_t level);
  std::vector<float>& displacements_of(std::size_t level);
  void smooth(Level& level, bool is_first, float* r, float* z) const;
  void smooth_thin(bool is_first, float* r);
  template <class Visit>
  void for_thin(Visit&& visit) const;

  SmootherParams m_params;
  const VoxelMaterial* m_material;
  int m_first;
  const Progress* m_polled = nullptr;  // of the cycle or solution that runs
  std::optional<ThinPieces> m_pieces;
  int m_thin_steps = 0;
  double m_thin_eigenvalue = 0;
  std::vector<float> m_thin_r, m_thin_z;  // of the unknowns of pieces
  std::vector<Level> m_levels;            // all but the coarsest
  std::optional<CoarsestSolver> m_coarsest;
  std::vector<float> m_coarsest_r, m_coarsest_z;
};

}  // namespace supple
