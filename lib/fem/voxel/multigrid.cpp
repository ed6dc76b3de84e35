#include "lib/fem/voxel/multigrid.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "lib/fem/node_vectors.h"
#include "lib/fem/voxel/cell_matrices.h"
#include "lib/fem/voxel/chebyshev.h"
#include "volumes/base/memory.h"

namespace supple {

namespace {

/// Steps of conjugate gradients on the finest level of the K-cycle, and on those below it.
constexpr std::size_t kKrylovLevel = 2;
constexpr int kKrylovSteps = 4, kDeeperKrylovSteps = 2;
/// Products leave out what is held where no larger share of the groups of elements is left.
constexpr double kMostFreeShare = 0.95;
/// Thin parts are smoothed further with as many steps as cost no more than so many products of the
/// finest level, if these are as many as help.
constexpr double kThinProducts = 4;
constexpr int kMostThinSteps = 16, kLeastThinSteps = 4;
/// Meshes of more nodes return the memory that their levels were made in before the solve.
constexpr NodeIndex kManyNodes = 300000;
/// The power method's values come from below, and the diagonal is rounded.
constexpr double kBoundMargin = 1.02;

/// The largest eigenvalue of D^-1 K of an element by the power method.
double element_eigenvalue(const VoxelMaterial& material, std::size_t of) {
  constexpr int kSteps = 60;
  const auto entry = [&](std::size_t n, std::size_t m) {
    return material.moduli.shear[of] * material.matrix.shear[n][m] +
           material.moduli.bulk[of] * material.matrix.bulk[n][m] +
           material.moduli.inertia[of] * material.matrix.mass[n][m];
  };
  Matrix24 scaled;
  std::array<double, 24> x;
  for (std::size_t n = 0; n < 24; ++n) {
    x[n] = std::sin(double(n * n));
    for (std::size_t m = 0; m < 24; ++m) {
      scaled[n][m] = entry(n, m) / std::sqrt(entry(n, n) * entry(m, m));
    }
  }
  double value = 0;
  for (int step = 0; step < kSteps; ++step) {
    std::array<double, 24> y{};
    double norm = 0;
    for (std::size_t n = 0; n < 24; ++n) {
      for (std::size_t m = 0; m < 24; ++m) y[n] += scaled[n][m] * x[m];
      norm += y[n] * y[n];
    }
    value = std::sqrt(norm);
    for (std::size_t n = 0; n < 24; ++n) x[n] = y[n] / value;
  }
  return value;
}

/// Above all eigenvalues of D^-1 K of any body of this material and of any part of it: the largest
/// of single elements, as x.K x is the sum of x.K_e x, and each at most lambda_e x.D_e x (Irons and
/// Treharne 1971).
double element_bound(const VoxelMaterial& material) {
  std::array<bool, 256> occurs{};
  for (const std::uint8_t of : material.classes) occurs[of] = true;
  double bound = 0;
  for (std::size_t of = 0; of < occurs.size(); ++of) {
    if (occurs[of]) bound = std::max(bound, element_eigenvalue(material, of));
  }
  return kBoundMargin * bound;
}

}  // namespace

void Multigrid::Level::subtract(const float* x, float* y) const {
  if (free) {
    fine->subtract(x, y, *free);
  } else if (fine != nullptr) {
    fine->subtract(x, y);
  } else if (cells) {
    cells->subtract(x, y);
  } else {
    matrix->subtract(x, y);
  }
}

void Multigrid::Level::make_room_for_steps() {
  for (std::vector<float>* of : {&rest, &sum, &p, &q}) of->resize(unknowns());
}

void Multigrid::leave_out_held(const HeldBits& held) {
  Level& level = m_levels[0];
  std::vector<bool> is_free(held.size());
  for (std::size_t node = 0; node < held.size(); ++node) is_free[node] = held[node] != kAllHeld;
  level.free = level.fine->groups_at(is_free);
  if (level.free->share > kMostFreeShare) level.free.reset();
}

void Multigrid::prepare_thin() {
  const Level& level = m_levels[0];
  const double share = m_pieces->groups().share / (level.free ? level.free->share : 1);
  const double steps = kThinProducts / (2 * share);
  if (steps < kLeastThinSteps) return;
  m_thin_steps = std::min(kMostThinSteps, int(steps));
  m_thin_eigenvalue = element_bound(*m_material);
  for (std::vector<float>* of : {&m_thin_r, &m_thin_z}) of->resize(3 * m_pieces->node_count());
}

void Multigrid::invert_diagonal(Level& level, const std::vector<float>& diagonal,
                                const HeldBits* held) {
  level.inverse_diagonal.resize(diagonal.size());
  for (std::size_t n = 0; n < diagonal.size(); ++n) {
    const bool is_held = held != nullptr && ((*held)[n / 3] >> n % 3 & 1) != 0;
    level.inverse_diagonal[n] = ShortFloat(is_held || diagonal[n] <= 0 ? 0 : 1 / diagonal[n]);
  }
  level.d.resize(diagonal.size());
}

Multigrid::Multigrid(const MeshLevels& levels, const HexOperator& fine,
                     const VoxelMaterial& material, const HeldBits& held,
                     const SmootherParams& params, Progress* progress, int first)
    : m_params(params),
      m_material(&material),
      m_first(int(levels.coarsenings.size())),
      m_levels(levels.coarsenings.size()) {
  stage(progress, "multigrid");
  const std::vector<HexMesh>& meshes = levels.meshes;
  std::optional<CellClasses> cells;
  if (meshes.size() > 1) {
    cells =
        cell_classes(meshes[0], levels.coarsenings[0], material, held, meshes[1].element_count());
  }
  std::optional<CellMatrices> matrices;
  const std::size_t coarsest = meshes.size() - 1;
  for (std::size_t n = 0; n <= coarsest; ++n) {
    report(progress, double(n) / double(coarsest + 1));
    // The matrices of single elements, where they are needed.
    if (n == 0 && n == coarsest) {
      matrices = CellMatrices::of_voxels(meshes[0], material, held);
    } else if (n == 1 && n == coarsest) {
      matrices = CellMatrices::of_cells(*cells, material);
    } else if (n == 2) {
      matrices = CellMatrices::of_large_cells(meshes[1], levels.coarsenings[1], *cells, material,
                                              meshes[2].element_count());
      cells.reset();
    } else if (n > 2) {
      matrices =
          matrices->coarser(meshes[n - 1], levels.coarsenings[n - 1], meshes[n].element_count());
    }
    if (n == coarsest) break;
    Level& level = m_levels[n];
    level.transfer.emplace(meshes[n], meshes[n + 1], levels.coarsenings[n]);
    if (n == 0) {
      level.fine = &fine;
      invert_diagonal(level, fine.diagonal(), &held);
    } else if (n == 1) {
      level.cells.emplace(meshes[1], *cells, material);
      invert_diagonal(level, level.cells->diagonal(), nullptr);
    } else {
      level.matrix = assemble<float>(meshes[n], *matrices);
      invert_diagonal(level, level.matrix->diagonal(), nullptr);
    }
    if (n == 0) continue;
    for (std::vector<float>* of : {&level.r, &level.z}) of->resize(level.unknowns());
    if (n >= kKrylovLevel) level.make_room_for_steps();
  }
  m_coarsest.emplace(assemble<double>(meshes[coarsest], *matrices));
  m_coarsest_r.resize(3 * std::size_t(meshes[coarsest].node_count()));
  m_coarsest_z.resize(m_coarsest_r.size());
  matrices.reset();
  extend(first, held, progress);
  if (meshes[0].node_count() > kManyNodes) return_free_memory();
}

void Multigrid::extend(int first, const HeldBits& held, Progress* progress) {
  if (first >= m_first) return;
  if (first == 0) {
    const HexOperator& fine = *m_levels[0].fine;
    m_pieces.emplace(fine, *m_material, held, progress);
    if (m_pieces->count() == 0) m_pieces.reset();
    leave_out_held(held);
    if (m_pieces) prepare_thin();
  }
  for (int n = first; n < m_first; ++n) {
    Level& level = m_levels[std::size_t(n)];
    level.largest_eigenvalue = estimate_largest(
        level.inverse_diagonal, [&](const float* x, float* y) { level.subtract(x, y); });
  }
  if (first > 0) m_levels[std::size_t(first)].make_room_for_steps();
  m_first = first;
}

std::size_t Multigrid::bytes() const {
  std::size_t sum = m_coarsest->bytes() + (m_pieces ? m_pieces->bytes() : 0) +
                    (m_thin_r.capacity() + m_thin_z.capacity()) * sizeof(float);
  for (const Level& level : m_levels) {
    sum += level.inverse_diagonal.capacity() * sizeof(ShortFloat);
    for (const std::vector<float>* of :
         {&level.r, &level.z, &level.d, &level.rest, &level.sum, &level.p, &level.q}) {
      sum += of->capacity() * sizeof(float);
    }
    if (level.free) sum += level.free->bytes();
    if (level.cells) sum += level.cells->bytes();
    if (level.matrix) sum += level.matrix->bytes();
  }
  return sum;
}

void Multigrid::cycle(float* r, float* z, const Progress* progress) {
  m_polled = progress;
  if (!m_pieces) {
    cycle_from(0, r, z);
    return;
  }
  // B = Q + (I - Q K) M (I - K Q): the pieces by Q = Z E^-1 Z^T, and M, the levels between further
  // steps of thin parts.
  Level& level = m_levels[0];
  float* d = level.d.data();
  m_pieces->take_forces(r);
  m_pieces->solve();
  fill(d, level.unknowns(), 0.0f);
  m_pieces->add_motions(d);
  level.fine->subtract(d, r, m_pieces->groups());
  if (m_thin_steps == 0) {
    cycle_from(0, r, z);
  } else {
    m_pieces->clear(d);
    smooth_thin(true, r);
    for_thin([&](std::size_t thin, std::size_t n) { m_thin_r[thin] = r[n]; });
    cycle_from(0, r, z);
    for_thin([&](std::size_t thin, std::size_t n) { r[n] = m_thin_r[thin]; });
    level.fine->subtract(z, r, m_pieces->groups());
    fill(d, level.unknowns(), 0.0f);
    smooth_thin(false, r);
    for_thin([&](std::size_t thin, std::size_t n) { z[n] += m_thin_z[thin]; });
  }
  m_pieces->clear(d);
  level.fine->subtract(z, d, m_pieces->groups());
  m_pieces->add_forces(d);
  m_pieces->solve();
  m_pieces->add_motions(z);
}

/// Calls visit(place among the unknowns of thin parts, unknown).
template <class Visit>
void Multigrid::for_thin(Visit&& visit) const {
  static_assert(kVectorRange % 3 == 0, "ranges hold whole nodes");
  for_ranges(m_thin_z.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; n += 3) {
      const std::size_t first = 3 * m_pieces->node(n / 3);
      for (std::size_t a = 0; a < 3; ++a) visit(n + a, first + a);
    }
  });
}

void Multigrid::cycle_from(std::size_t number, float* r, float* z) {
  if (number == m_levels.size()) {
    m_coarsest->solve(r, z);
    return;
  }
  Level& level = m_levels[number];
  smooth(level, true, r, z);
  float* coarse_r = forces_of(number + 1).data();
  float* coarse_z = displacements_of(number + 1).data();
  level.transfer->restrict_to(r, level.inverse_diagonal.data(), coarse_r);
  solve_from(number + 1, coarse_r, coarse_z);
  level.transfer->prolong(coarse_z, level.inverse_diagonal.data(), level.d.data());
  for_ranges(level.unknowns(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) z[n] += level.d[n];
  });
  level.subtract(level.d.data(), r);
  smooth(level, false, r, z);
}

/// z = K^-1 r nearly: one cycle, or steps of flexible conjugate gradients with it.
void Multigrid::solve_from(std::size_t number, float* r, float* z) {
  if (number < kKrylovLevel || number == m_levels.size()) {
    cycle_from(number, r, z);
    return;
  }
  take_steps(number, number == kKrylovLevel ? kKrylovSteps : kDeeperKrylovSteps, 0, r, z);
}

/// z = K^-1 r by steps of flexible conjugate gradients, each with one cycle; how many they were.
int Multigrid::take_steps(std::size_t number, int most_steps, double tolerance, float* r,
                          float* z) {
  Level& level = m_levels[number];
  const std::size_t count = level.unknowns();
  float *rest = level.rest.data(), *sum = level.sum.data(), *p = level.p.data(),
        *q = level.q.data();
  std::copy_n(r, count, rest);
  std::fill_n(sum, count, 0.0f);
  const double enough = tolerance > 0 ? tolerance * tolerance * dot(rest, rest, count) : 0;
  double p_q = 0;
  int step = 0;
  for (; step < most_steps; ++step) {
    poll(m_polled);
    if (tolerance > 0 && dot(rest, rest, count) <= enough) break;
    if (step > 0) std::copy_n(rest, count, r);
    cycle_from(number, r, z);
    // q = -K p.
    const float beta = step == 0 ? 0.0f : float(dot(z, q, count) / p_q);
    for_ranges(count, [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) p[n] = step == 0 ? z[n] : z[n] + beta * p[n];
    });
    fill(q, count, 0.0f);
    level.subtract(p, q);
    p_q = -dot(p, q, count);
    if (!(p_q > 0)) break;
    const float alpha = float(dot(p, rest, count) / p_q);
    for_ranges(count, [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) {
        sum[n] += alpha * p[n];
        rest[n] += alpha * q[n];
      }
    });
  }
  std::copy_n(sum, count, z);
  return step;
}

std::vector<float>& Multigrid::forces_of(std::size_t level) {
  return level == m_levels.size() ? m_coarsest_r : m_levels[level].r;
}
std::vector<float>& Multigrid::displacements_of(std::size_t level) {
  return level == m_levels.size() ? m_coarsest_z : m_levels[level].z;
}

const std::vector<float>& Multigrid::restrict_to(int level, const float* r) {
  for (std::size_t n = 0; n < std::size_t(level); ++n) {
    const float* from = n == 0 ? r : m_levels[n].r.data();
    m_levels[n].transfer->restrict_to(from, m_levels[n].inverse_diagonal.data(),
                                      forces_of(n + 1).data());
  }
  return forces_of(std::size_t(level));
}

int Multigrid::solve_at(int level, double tolerance, int most_steps, const Progress* progress) {
  m_polled = progress;
  const auto number = std::size_t(level);
  float *r = forces_of(number).data(), *z = displacements_of(number).data();
  if (number < m_levels.size()) return take_steps(number, most_steps, tolerance, r, z);
  m_coarsest->solve(r, z);
  return 1;
}

void Multigrid::prolong_from(int level, float* z) {
  for (auto n = std::size_t(level); n-- > 0;) {
    float* to = n == 0 ? z : m_levels[n].z.data();
    m_levels[n].transfer->prolong(displacements_of(n + 1).data(),
                                  m_levels[n].inverse_diagonal.data(), to);
  }
}

/// Smooths with the residual kept in r. The last product is left out after the coarse correction.
void Multigrid::smooth(Level& level, bool is_first, float* r, float* z) const {
  ChebyshevSteps chebyshev(level.largest_eigenvalue, m_params.range);
  const ShortFloat* inverse = level.inverse_diagonal.data();
  for (int n = 0; n < m_params.degree; ++n, chebyshev.advance()) {
    poll(m_polled);
    const bool starts = n == 0, overwrites = starts && is_first;
    const float keep = chebyshev.keep(), step = chebyshev.step();
    for_ranges(level.unknowns(), [&](std::size_t begin, std::size_t end) {
      float* d = level.d.data();
      for (std::size_t i = begin; i < end; ++i) {
        d[i] = starts ? step * inverse[i] * r[i] : keep * d[i] + step * inverse[i] * r[i];
        z[i] = overwrites ? d[i] : z[i] + d[i];
      }
    });
    if (is_first || n + 1 < m_params.degree) level.subtract(level.d.data(), r);
  }
}

/// Smooths the unknowns of thin parts alone; d must be 0, and the second time adds to m_thin_z.
/// That many steps magnify what lies above the largest eigenvalue, hence a bound of it instead of
/// an estimate.
void Multigrid::smooth_thin(bool is_first, float* r) {
  Level& level = m_levels[0];
  // A range as wide as the steps reach: plates bend the more softly the longer their waves.
  ChebyshevSteps chebyshev(m_thin_eigenvalue, 4.0 * m_thin_steps * m_thin_steps);
  const ShortFloat* inverse = level.inverse_diagonal.data();
  float* d = level.d.data();
  if (is_first) std::fill(m_thin_z.begin(), m_thin_z.end(), 0.0f);
  for (int n = 0; n < m_thin_steps; ++n, chebyshev.advance()) {
    poll(m_polled);
    const float keep = chebyshev.keep(), step = chebyshev.step();
    for_thin([&](std::size_t thin, std::size_t i) {
      d[i] = keep * d[i] + step * inverse[i] * r[i];
      m_thin_z[thin] += d[i];
    });
    if (is_first || n + 1 < m_thin_steps) level.fine->subtract(d, r, m_pieces->groups());
  }
}

}  // namespace supple
