// Sweeps of a coordinate over a body with diagonal links.
#include <algorithm>
#include <array>
#include <limits>

#include "lib/relax/coordinate_relaxation.h"
#include "volumes/base/parallel.h"

namespace supple {

/// Finds the bounds of a brick's elements; false where it has none.
bool CoordinateRelaxation::find_bounds(std::size_t brick, NodeBounds& out) const {
  const auto [least, least_end] = bounds_in(m_at_least, brick);
  const auto [most, most_end] = bounds_in(m_at_most, brick);
  if (least == least_end && most == most_end) return false;
  std::fill_n(out.least, kBrickVoxels, -std::numeric_limits<double>::infinity());
  std::fill_n(out.most, kBrickVoxels, std::numeric_limits<double>::infinity());
  for (auto bound = least; bound != least_end; ++bound) {
    out.least[bound->slot % kBrickVoxels] = bound->value * kFinePerUnit;
  }
  for (auto bound = most; bound != most_end; ++bound) {
    out.most[bound->slot % kBrickVoxels] = bound->value * kFinePerUnit;
  }
  return true;
}

SweepOutcome CoordinateRelaxation::sweep_diagonals_of(std::size_t brick, const BrickMask& free,
                                                      const DiagonalSweep& sweep,
                                                      double* out) const {
  DiagonalBrick loaded;
  load_brick(m_body, m_table.links(), brick, m_now, m_one_class, loaded);
  NodeBounds bounds;
  DiagonalSweep bounded = sweep;
  if (find_bounds(brick, bounds)) bounded.bounds = &bounds;
  return sweep_brick(loaded, m_table, free, bounded, out);
}

/// Steps a brick's single nodes; records its energy, tightness, change. Returns the largest step.
double CoordinateRelaxation::step_diagonals_of(std::size_t brick, const DiagonalSweep& sweep,
                                               double* out) {
  const SweepOutcome outcome = sweep_diagonals_of(brick, m_elements.single[brick], sweep, out);
  m_energies[brick] = outcome.energy;
  m_is_tight[brick] = outcome.least_slack <= kTightSlack * kFinePerUnit;
  if (outcome.largest_step > (m_in_turns ? m_still : 0)) m_changed[brick] = 1;
  return outcome.largest_step;
}

/// Steps all single nodes of the pass's bricks at once; returns the largest step.
double CoordinateRelaxation::sweep_diagonals_at_once(const SweepRule& rule) {
  std::vector<double> largest(m_work.size());
  parallel_for(m_work.size(), Grain{4}, [&](std::size_t n) {
    const std::size_t brick = m_work[n];
    largest[n] = step_diagonals_of(brick, {rule, true, nullptr}, m_next.touch(brick));
  });
  m_now.swap(m_next);
  return largest.empty() ? 0 : *std::max_element(largest.begin(), largest.end());
}

/// Steps them in place instead, one colour of bricks after the other.
double CoordinateRelaxation::sweep_diagonals(const SweepRule& rule) {
  std::array<std::vector<std::uint32_t>, 8> colours;
  for (const std::uint32_t b : m_work) {
    colours[std::size_t(brick_colour(m_body.elements.origin(b)))].push_back(b);
  }
  double all = 0;
  for (const auto& bricks : colours) {
    std::vector<double> largest(bricks.size());
    parallel_for(bricks.size(), Grain{4}, [&](std::size_t n) {
      const std::size_t brick = bricks[n];
      largest[n] = step_diagonals_of(brick, {rule, false, nullptr}, m_now.touch(brick));
    });
    for (const double step : largest) all = std::max(all, step);
  }
  return all;
}

}  // namespace supple
