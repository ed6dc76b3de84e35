#include "lib/relax/coordinate_relaxation.h"

#include <algorithm>
#include <cmath>

#include "lib/relax/cluster_pull.h"
#include "lib/relax/excess_energy.h"
#include "lib/relax/fine_offsets.h"
#include "volumes/base/parallel.h"

namespace supple {

namespace {

constexpr double kTight = kTightSlack * kFinePerUnit;
/// Number of passes from one search for elements that block each other to the next.
constexpr int kTightPasses = 24;

bool takes_turns(RelaxMethod method) {
  return method == RelaxMethod::red_black || method == RelaxMethod::accelerated;
}

/// Voxels of a brick whose coordinates have an even (0) or odd (1) sum. Brick origins are even.
BrickMask chessboard(int colour) {
  constexpr std::uint64_t kEvenPlane = 0xaa55aa55aa55aa55u;
  BrickMask mask;
  for (int i = 0; i < 8; ++i) {
    mask[std::size_t(i)] = (i + colour) % 2 == 0 ? kEvenPlane : ~kEvenPlane;
  }
  return mask;
}

}  // namespace

CoordinateRelaxation::CoordinateRelaxation(const Body& body, int coordinate,
                                           const SlotSet& anchored, const Holds& held,
                                           const RelaxParams& params)
    : m_body(body),
      m_at_least(held.at_least[std::size_t(coordinate)]),
      m_at_most(held.at_most[std::size_t(coordinate)]),
      m_method(params.method),
      m_still(params.still_voxels * kFinePerUnit * kFixedOne),
      m_table(body, coordinate,
              m_method == RelaxMethod::plain ? RigidLinks::springs : RigidLinks::absent),
      m_is_plastic(m_table.has_yield() || has_rest(body, coordinate)),
      m_extent(largest_extent(body.elements)),
      m_elements(find_movable(body, m_table, anchored, m_method != RelaxMethod::plain)),
      m_now(fine_offsets(body, m_table, held)),
      m_next(body.elements.brick_count()),
      m_in_turns(has_diagonals() && takes_turns(m_method)),
      m_changed(body.elements.brick_count(), 0),
      m_is_tight(body.elements.brick_count(), 0),
      m_energies(body.elements.brick_count(), 0),
      m_stiff(body, m_table, m_elements) {
  for (std::size_t b = 0; b < m_now.brick_count(); ++b) {
    const double* values = m_now.brick(b);
    if (values == nullptr) continue;
    if (!m_in_turns) std::copy_n(values, kBrickVoxels, m_next.touch(b));
    m_changed[b] = 1;
  }
  if (has_diagonals()) m_one_class = classes_of_bricks(body);
  for (const auto& axis : body.rest) {
    const BrickValues& rest = axis[std::size_t(coordinate)];
    for (std::size_t b = 0; b < rest.brick_count(); ++b) {
      if (rest.brick(b) != nullptr) m_changed[b] = 1;
    }
  }
  add_bricks();
}

/// True where the brick changed, or one to which its links lead.
bool CoordinateRelaxation::is_due(std::size_t brick) const {
  const auto changed = [&](std::int32_t b) { return b >= 0 && m_changed[std::size_t(b)] != 0; };
  if (changed(std::int32_t(brick))) return true;
  if (has_diagonals()) {
    const BrickNeighbours around = neighbours_of(m_body.elements, brick);
    return std::any_of(around.begin(), around.end(), changed);
  }
  for (int face = 0; face < 6; ++face) {
    if (changed(m_body.elements.neighbour(brick, face))) return true;
  }
  return false;
}

/// Bricks of the next pass: those that changed, and their neighbours.
void CoordinateRelaxation::add_bricks() {
  m_work.clear();
  for (std::size_t b = 0; b < m_changed.size(); ++b) {
    if (!is_due(b)) continue;
    m_work.push_back(std::uint32_t(b));
    m_now.touch(b);
    if (!m_in_turns) m_next.touch(b);
  }
}

SweepOutcome CoordinateRelaxation::sweep_one(std::size_t brick, const BrickMask& free,
                                             const SweepRule& rule, double* out) const {
  PaddedBrick<double> offsets;
  const auto values_of = [&](std::size_t b) {
    return [values = m_now.brick_or_zero(b)](int offset) { return values[offset]; };
  };
  pad_brick(m_body.elements, brick, 0.0, values_of, offsets);
  BrickSprings links;
  find_links(m_body, brick, m_table.missing(), links);
  if (!m_is_plastic) return sweep_brick(offsets, links, nullptr, m_table, free, rule, out);
  BrickRest rest;
  const std::size_t c = std::size_t(m_table.coordinate());
  find_rest(m_body.elements, {&m_body.rest[0][c], &m_body.rest[1][c], &m_body.rest[2][c]}, brick,
            rest);
  return sweep_brick(offsets, links, &rest, m_table, free, rule, out);
}

/// Clamps steps at the bounds of held elements; elements that start within stay within. Returns the
/// largest step that is left of those that the sweep took.
double CoordinateRelaxation::keep_bounds(std::size_t brick, double* values, double largest) const {
  const auto [least, least_end] = bounds_in(m_at_least, brick);
  for (auto bound = least; bound != least_end; ++bound) {
    double& value = values[bound->slot % kBrickVoxels];
    value = std::max(value, bound->value * kFinePerUnit);
  }
  const auto [most, most_end] = bounds_in(m_at_most, brick);
  for (auto bound = most; bound != most_end; ++bound) {
    double& value = values[bound->slot % kBrickVoxels];
    value = std::min(value, bound->value * kFinePerUnit);
  }
  if (least == least_end && most == most_end) return largest;
  const double* before = m_now.brick_or_zero(brick);
  largest = 0;
  for (int n = 0; n < kBrickVoxels; ++n) {
    largest = std::max(largest, std::abs(values[n] - before[n]));
  }
  return largest;
}

/// Steps all single nodes of a colour (-1: all) of the pass's bricks; returns the largest step.
double CoordinateRelaxation::sweep_nodes(int colour, const SweepRule& rule, bool first) {
  static const BrickMask kColours[2] = {chessboard(0), chessboard(1)};
  std::vector<double> largest(m_work.size());
  parallel_for(m_work.size(), Grain{4}, [&](std::size_t n) {
    const std::size_t brick = m_work[n];
    BrickMask free = m_elements.single[brick];
    if (colour >= 0) {
      for (std::size_t word = 0; word < 8; ++word) free[word] &= kColours[colour][word];
    }
    double* out = m_next.touch(brick);
    const SweepOutcome outcome = sweep_one(brick, free, rule, out);
    if (first) m_energies[brick] = outcome.energy;
    m_is_tight[brick] = outcome.least_slack <= kTight;
    if (outcome.largest_step == 0) return;
    largest[n] = keep_bounds(brick, out, outcome.largest_step);
    if (largest[n] != 0) m_changed[brick] = 1;
  });
  m_now.swap(m_next);
  return largest.empty() ? 0 : *std::max_element(largest.begin(), largest.end());
}

/// Step of one cluster. All step at once: where two meet, each may take half of the slack, and goes
/// no further than to its own mean, so that the energy does not rise.
double CoordinateRelaxation::step_of_cluster(const Clusters& clusters, std::size_t cluster,
                                             double relaxation) const {
  const ClusterPull pull = pull_of_cluster(clusters, cluster, m_now, m_at_least, m_at_most, 0.5);
  if (pull.stiffness == 0) return 0;
  const double part = pull.touches_other ? std::min(1.0, relaxation) : relaxation;
  const double wanted = part * pull.force / pull.stiffness;
  return std::trunc(std::max(-pull.sink, std::min(pull.rise, wanted)));
}

/// Moves every cluster as one; returns the largest step.
double CoordinateRelaxation::sweep_clusters(const Clusters& clusters, double relaxation) {
  std::vector<double> steps(clusters.count());
  parallel_for(clusters.count(), Grain{4}, [&](std::size_t c) {
    if (m_elements.moves(clusters.members[clusters.first[c]])) {
      steps[c] = step_of_cluster(clusters, c, relaxation);
    }
  });
  double largest = 0;
  for (std::size_t c = 0; c < clusters.count(); ++c) {
    if (steps[c] == 0) continue;
    largest = std::max(largest, std::abs(steps[c]));
    for (std::uint32_t n = clusters.first[c]; n < clusters.first[c + 1]; ++n) {
      const Slot slot = clusters.members[n];
      m_now.touch(slot / kBrickVoxels)[slot % kBrickVoxels] += steps[c];
      m_changed[slot / kBrickVoxels] = 1;
    }
  }
  return largest;
}

std::vector<std::uint32_t> CoordinateRelaxation::stored_bricks() const {
  std::vector<std::uint32_t> bricks;
  for (std::size_t b = 0; b < m_now.brick_count(); ++b) {
    if (m_now.brick(b) != nullptr) bricks.push_back(std::uint32_t(b));
  }
  return bricks;
}

/// Steps stiff parts as one, the widest first.
double CoordinateRelaxation::sweep_stiff_clusters() {
  double largest = 0;
  for (const Clusters& level : m_stiff.of(stored_bricks())) {
    largest = std::max(largest, sweep_clusters(level, 1));
  }
  return largest;
}

/// Elements that links at their limits join within aligned blocks of 2^block_bits voxels.
Clusters CoordinateRelaxation::find_tight_clusters(int block_bits) const {
  const auto joins = [&](int kind, Slot low, Slot high) {
    if (!m_elements.moves(low) || !m_elements.moves(high)) return false;
    const std::uint8_t a = m_body.classes[low], b = m_body.classes[high];
    if (m_table.is_rigid(kind, a, b)) return true;
    const LinkValues& values = m_table.values(kind, a, b);
    const double apart = m_now.at(high) - m_now.at(low);
    const double wider = values.upper * kFinePerUnit - apart;
    const double narrower = values.lower * kFinePerUnit + apart;
    if (std::min(wider, narrower) > kTight) return false;
    const Vec3i at = voxel_of(m_body.elements, low), next = voxel_of(m_body.elements, high);
    const auto same_block = [&](int axis) {
      return at[axis] >> block_bits == next[axis] >> block_bits;
    };
    return same_block(0) && same_block(1) && same_block(2);
  };
  std::vector<char> wanted = m_is_tight;
  for (const Slot slot : m_elements.rigid.members) wanted[slot / kBrickVoxels] = 1;
  std::vector<std::uint32_t> bricks;
  for (std::size_t b = 0; b < wanted.size(); ++b) {
    if (wanted[b]) bricks.push_back(std::uint32_t(b));
  }
  return find_clusters(m_body, m_table, bricks, joins);
}

double CoordinateRelaxation::pass() {
  std::fill(m_changed.begin(), m_changed.end(), 0);
  SweepRule rule;
  double largest = 0;
  if (m_method == RelaxMethod::plain || m_method == RelaxMethod::jacobi) {
    rule.limited = m_method == RelaxMethod::jacobi;
    largest = has_diagonals() ? sweep_diagonals_at_once(rule) : sweep_nodes(-1, rule, true);
  } else {
    rule.share = 1;
    if (m_method == RelaxMethod::accelerated) rule.relaxation = over_relaxation(m_passes, m_extent);
    if (has_diagonals()) largest = sweep_diagonals(rule);
    for (int colour = 0; colour < 2 && !has_diagonals(); ++colour) {
      largest = std::max(largest, sweep_nodes(colour, rule, colour == 0));
    }
  }
  ++m_passes;
  if (m_elements.rigid.count() > 0) {
    largest = std::max(largest, sweep_clusters(m_elements.rigid, rule.relaxation));
  }
  if (m_method == RelaxMethod::accelerated) largest = std::max(largest, sweep_stiff_clusters());
  if (m_method == RelaxMethod::accelerated && m_passes % kTightPasses == 0) {
    // Every time blocks of another size, up to the whole body.
    int levels = 1;
    while (m_extent >> levels != 0) ++levels;
    const Clusters tight = find_tight_clusters(1 + m_passes / kTightPasses % levels);
    largest = std::max(largest, sweep_clusters(tight, 1));
  }
  m_energy = 0;
  for (const double energy : m_energies) m_energy += energy;
  add_bricks();
  return largest;
}

double CoordinateRelaxation::energy() {
  parallel_for(m_work.size(), Grain{4}, [&](std::size_t n) {
    double unused[kBrickVoxels];
    m_energies[m_work[n]] = has_diagonals()
                                ? sweep_diagonals_of(m_work[n], BrickMask{}, {}, unused).energy
                                : sweep_one(m_work[n], BrickMask{}, {}, unused).energy;
  });
  double total = 0;
  for (const double energy : m_energies) total += energy;
  return total;
}

double CoordinateRelaxation::excess() const {
  return excess_energy(m_body, m_table, m_elements, m_now, m_at_least, m_at_most, stored_bricks());
}

void CoordinateRelaxation::store(Body& body) const {
  store_fine(m_now, m_table.coordinate(), body);
}

std::size_t CoordinateRelaxation::bytes() const {
  return m_now.bytes() + m_next.bytes() + m_table.bytes() + m_elements.bytes() + m_stiff.bytes() +
         m_work.capacity() * sizeof(m_work[0]) + m_changed.capacity() + m_is_tight.capacity() +
         m_energies.capacity() * sizeof(double);
}

}  // namespace supple
