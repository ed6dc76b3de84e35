#include "lib/relax/volume_relaxation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lib/relax/cell_sweep.h"
#include "lib/relax/cell_volume.h"
#include "lib/relax/cluster_pull.h"
#include "lib/relax/fine_offsets.h"
#include "lib/relax/grouped.h"
#include "volumes/base/parallel.h"
#include "volumes/grid/cell.h"

namespace supple {

namespace {

/// Cells per partial sum; these are added in turn: the same whatever the number of threads.
constexpr std::size_t kCellsPerSum = 512;

struct RigidPull {
  double force = 0, stiffness = 0;
};

}  // namespace

VolumeClusters::VolumeClusters(const Body& body, int coordinate, const Movable& elements,
                               const Holds& held, const CellModuli& moduli, double weight)
    : m_body(body),
      m_elements(elements),
      m_at_least(held.at_least[std::size_t(coordinate)]),
      m_at_most(held.at_most[std::size_t(coordinate)]),
      m_coordinate(std::size_t(coordinate)),
      m_weight(weight) {
  const Clusters& rigid = elements.rigid;
  if (rigid.count() == 0) return;
  find_cells_of_clusters(moduli);
  m_first_brick.push_back(0);
  for (std::size_t c = 0; c < rigid.count(); ++c) {
    std::vector<std::uint32_t> bricks;
    for (std::uint32_t n = rigid.first[c]; n < rigid.first[c + 1]; ++n) {
      bricks.push_back(rigid.members[n] / kBrickVoxels);
    }
    for (std::uint32_t n = m_first_cell[c]; n < m_first_cell[c + 1]; ++n) {
      for (const Slot corner : m_cells[n].corners) bricks.push_back(corner / kBrickVoxels);
    }
    for (std::uint32_t n = rigid.first_link[c]; n < rigid.first_link[c + 1]; ++n) {
      bricks.push_back(rigid.boundary[n].outside / kBrickVoxels);
    }
    std::sort(bricks.begin(), bricks.end());
    m_bricks.insert(m_bricks.end(), bricks.begin(), std::unique(bricks.begin(), bricks.end()));
    m_first_brick.push_back(std::uint32_t(m_bricks.size()));
  }
}

void VolumeClusters::find_cells_of_clusters(const CellModuli& moduli) {
  const Clusters& rigid = m_elements.rigid;
  const std::size_t bricks = m_body.elements.brick_count();
  BrickValues numbers(bricks);  // one more than the cluster's
  for (std::size_t c = 0; c < rigid.count(); ++c) {
    for (std::uint32_t n = rigid.first[c]; n < rigid.first[c + 1]; ++n) {
      numbers.set(rigid.members[n], std::int32_t(c + 1));
    }
  }
  std::vector<ClusteredItems<PartCell>> found(1);
  for (std::size_t b = 0; b < bricks; ++b) {
    const BricksAround around = bricks_around(m_body.elements, b);
    const bool has_members = std::any_of(around.begin(), around.end(), [&](std::int32_t other) {
      return other >= 0 && numbers.brick(std::size_t(other)) != nullptr;
    });
    if (!has_members) continue;
    for_each_cell(find_cells(m_body, around), [&](const Vec3i& low) {
      PartCell cell;
      std::array<std::int32_t, 8> number;
      for (std::size_t n = 0; n < 8; ++n) {
        const Vec3i corner = low + cell_corner(int(n));
        cell.corners[n] = slot_around(around, corner.x, corner.y, corner.z);
        number[n] = numbers.at(cell.corners[n]);
      }
      cell.share = float(share_of_cell(m_body, moduli, cell.corners));
      for (std::size_t n = 0; n < 8; ++n) {
        if (number[n] == 0 ||
            std::find(number.begin(), number.begin() + n, number[n]) != number.begin() + n) {
          continue;
        }
        unsigned members = 0;
        for (std::size_t m = n; m < 8; ++m) members |= unsigned(number[m] == number[n]) << m;
        if (members == 0xff) continue;
        cell.members = std::uint8_t(members);
        found.front().push_back({std::uint32_t(number[n] - 1), cell});
      }
    });
  }
  group_by_cluster(std::move(found), rigid.count(), m_cells, m_first_cell);
}

bool VolumeClusters::is_due(std::size_t cluster, const std::vector<char>& due) const {
  return std::any_of(m_bricks.begin() + m_first_brick[cluster],
                     m_bricks.begin() + m_first_brick[cluster + 1],
                     [&](std::uint32_t brick) { return due[brick] != 0; });
}

/// Step t of a cluster. The volume of a cell is linear in it: V + t sum of dV/dx of its corners.
double VolumeClusters::step_of(std::size_t cluster,
                               const std::array<BrickArray<double>, 3>& offsets,
                               double relaxation) const {
  const Clusters& rigid = m_elements.rigid;
  const BrickArray<double>& now = offsets[m_coordinate];
  const ClusterPull links = pull_of_cluster(rigid, cluster, now, m_at_least, m_at_most, 1);
  double force = links.force;
  const std::size_t begin = m_first_cell[cluster], end = m_first_cell[cluster + 1];
  std::vector<RigidPull> sums((end - begin + kCellsPerSum - 1) / kCellsPerSum);
  parallel_for(sums.size(), Grain{4}, [&](std::size_t sum) {
    const std::size_t first = begin + sum * kCellsPerSum;
    for (std::size_t n = first; n < std::min(end, first + kCellsPerSum); ++n) {
      const PartCell& cell = m_cells[n];
      Hexahedron corners;
      for (int corner = 0; corner < 8; ++corner) {
        for (int c = 0; c < 3; ++c) {
          const double offset = offsets[std::size_t(c)].at(cell.corners[std::size_t(corner)]) -
                                offsets[std::size_t(c)].at(cell.corners[0]);
          corners[std::size_t(corner)][c] = offset / kFineVoxel + (corner >> (2 - c) & 1);
        }
      }
      double gradient = 0;
      for (int corner = 0; corner < 8; ++corner) {
        if ((cell.members >> corner & 1) != 0) {
          gradient += hexahedron_gradient(corners, corner)[int(m_coordinate)];
        }
      }
      const double pull = m_weight * double(cell.share) * gradient;
      sums[sum].force -= pull * (hexahedron_volume(corners) - 1) * kFineVoxel;
      sums[sum].stiffness += pull * gradient;
    }
  });
  double of_cells = 0;
  for (const RigidPull& sum : sums) {
    force += sum.force;
    of_cells += sum.stiffness;
  }
  const double stiffness = links.stiffness + of_cells;
  if (stiffness == 0) return 0;
  const double wanted =
      damped_relaxation(relaxation, links.stiffness, of_cells) * force / stiffness;
  return std::trunc(std::max(-links.sink, std::min(links.rise, wanted)));
}

double VolumeClusters::step(std::array<BrickArray<double>, 3>& offsets, double relaxation,
                            const std::vector<char>& due, std::vector<char>& changed) const {
  const Clusters& rigid = m_elements.rigid;
  double largest = 0;
  for (std::size_t c = 0; c < rigid.count(); ++c) {
    if (!m_elements.moves(rigid.members[rigid.first[c]])) continue;
    // Bricks that changed earlier in this pass count as well.
    if (!is_due(c, due) && !is_due(c, changed)) continue;
    const double step = step_of(c, offsets, relaxation);
    if (step == 0) continue;
    largest = std::max(largest, std::abs(step));
    for (std::uint32_t n = rigid.first[c]; n < rigid.first[c + 1]; ++n) {
      const Slot slot = rigid.members[n];
      offsets[m_coordinate].touch(slot / kBrickVoxels)[slot % kBrickVoxels] += step;
      changed[slot / kBrickVoxels] = 1;
    }
  }
  return largest;
}

std::size_t VolumeClusters::bytes() const {
  return m_cells.capacity() * sizeof(PartCell) +
         (m_first_cell.capacity() + m_bricks.capacity() + m_first_brick.capacity()) *
             sizeof(std::uint32_t);
}

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Bricks of one colour do not touch each other, not even at a corner.
std::size_t colour_of(const Vec3i& origin) {
  return std::size_t((origin.x >> 3 & 1) << 2 | (origin.y >> 3 & 1) << 1 | (origin.z >> 3 & 1));
}

}  // namespace

/// Data of one brick that a sweep reads: 90 kB, half of it only where springs yield.
struct VolumeRelaxation::BrickData {
  CellBrick cells;
  BrickSprings links;
  BrickRest rest[3];
};

VolumeRelaxation::VolumeRelaxation(const Body& body, const SlotSet& anchored, const Holds& held,
                                   RelaxMethod method, const CellModuli& moduli)
    : m_body(body),
      m_held(held),
      m_method(method),
      m_extent(largest_extent(body.elements)),
      m_moduli(moduli),
      m_due(body.elements.brick_count(), 0),
      m_changed(body.elements.brick_count(), 0),
      m_energies(body.elements.brick_count(), 0) {
  const Vec3d spacing = body.geometry.spacing_mm();
  const double stiffness = m_moduli.kpa * spacing.x * spacing.y * spacing.z;
  m_cell_energy = stiffness / 2 / (kFineCell * kFineCell);
  m_coordinates.reserve(3);
  m_clusters.reserve(3);
  for (int c = 0; c < 3; ++c) {
    LinkTable table(body, c, RigidLinks::absent, 6);
    Movable elements = find_movable(body, table, anchored, true);
    m_coordinates.push_back({std::move(table), std::move(elements), spacing[c] / kFineVoxel});
    const double weight = stiffness / (spacing[c] * spacing[c]);
    m_weight[std::size_t(c)] = weight / (kFineCell * kFineCell) * (kFineVoxel * kFineVoxel);
    m_clusters.emplace_back(body, c, m_coordinates.back().elements, held, m_moduli, weight);
    m_is_plastic = m_is_plastic || m_coordinates.back().table.has_yield() || has_rest(body, c);

    m_now[std::size_t(c)] = fine_offsets(body, m_coordinates.back().table, held);
    for (std::size_t b = 0; b < body.elements.brick_count(); ++b) {
      if (m_now[std::size_t(c)].brick(b) != nullptr) m_changed[b] = 1;
      for (const auto& axis : body.rest) {
        if (axis[std::size_t(c)].brick(b) != nullptr) m_changed[b] = 1;
      }
    }
  }
  find_work();
}

/// Bricks of the next pass: those that changed, and all around them.
void VolumeRelaxation::find_work() {
  const BrickTopology& elements = m_body.elements;
  std::fill(m_due.begin(), m_due.end(), 0);
  for (std::size_t b = 0; b < m_changed.size(); ++b) {
    if (m_changed[b] == 0) continue;
    for (const std::int32_t other : bricks_around(elements, b)) {
      if (other >= 0) m_due[std::size_t(other)] = 1;
    }
  }
  for (auto& colour : m_work) colour.clear();
  for (std::size_t b = 0; b < m_due.size(); ++b) {
    if (m_due[b] == 0) continue;
    m_work[colour_of(elements.origin(b))].push_back(std::uint32_t(b));
    for (auto& offsets : m_now) offsets.touch(b);
  }
}

void VolumeRelaxation::load(std::size_t brick, BrickData& data) const {
  const BricksAround around = bricks_around(m_body.elements, brick);
  fill_cells(m_now, around, find_cells(m_body, around), data.cells);
  find_shares(m_body, m_moduli, around, data.cells);
  find_excess(data.cells);
  find_links(m_body, brick, m_coordinates[0].table.missing(), data.links);
  for (std::size_t c = 0; c < 3 && m_is_plastic; ++c) {
    find_rest(m_body.elements, {&m_body.rest[0][c], &m_body.rest[1][c], &m_body.rest[2][c]}, brick,
              data.rest[c]);
  }
}

std::array<const BrickRest*, 3> VolumeRelaxation::rest_of(const BrickData& data) const {
  if (!m_is_plastic) return {};
  return {&data.rest[0], &data.rest[1], &data.rest[2]};
}

/// Finds the bounds of a brick's elements; false where it has none.
bool VolumeRelaxation::find_bounds(std::size_t brick, BrickBounds& out) const {
  bool has_any = false;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto [least, least_end] = bounds_in(m_held.at_least[c], brick);
    const auto [most, most_end] = bounds_in(m_held.at_most[c], brick);
    has_any = has_any || least != least_end || most != most_end;
  }
  if (!has_any) return false;
  for (std::size_t c = 0; c < 3; ++c) {
    std::fill_n(out.least[c], kBrickVoxels, -kInfinity);
    std::fill_n(out.most[c], kBrickVoxels, kInfinity);
    const auto [least, least_end] = bounds_in(m_held.at_least[c], brick);
    for (auto bound = least; bound != least_end; ++bound) {
      out.least[c][bound->slot % kBrickVoxels] = bound->value * kFinePerUnit;
    }
    const auto [most, most_end] = bounds_in(m_held.at_most[c], brick);
    for (auto bound = most; bound != most_end; ++bound) {
      out.most[c][bound->slot % kBrickVoxels] = bound->value * kFinePerUnit;
    }
  }
  return true;
}

double VolumeRelaxation::sweep(std::size_t brick, double relaxation) {
  BrickData data;
  load(brick, data);
  BrickBounds bounds;
  CellSweep sweep;
  sweep.relaxation = relaxation;
  sweep.weight = m_weight;
  sweep.rest = rest_of(data);
  if (find_bounds(brick, bounds)) sweep.bounds = &bounds;
  for (std::size_t c = 0; c < 3; ++c) sweep.free[c] = m_coordinates[c].elements.single[brick];
  const double largest = sweep_cells(data.cells, data.links, tables(), sweep);
  if (largest == 0) return 0;
  m_changed[brick] = 1;
  for (int c = 0; c < 3; ++c) take_offsets(data.cells, c, m_now[std::size_t(c)].touch(brick));
  return largest;
}

double VolumeRelaxation::work_of_pass() const {
  std::size_t bricks = 0;
  for (const auto& colour : m_work) bricks += colour.size();
  return 3.0 * double(bricks) * kBrickVoxels;
}

double VolumeRelaxation::pass() {
  m_energy = energy();
  std::fill(m_changed.begin(), m_changed.end(), 0);
  const double relaxation =
      m_method == RelaxMethod::accelerated ? over_relaxation(m_passes, m_extent) : 1;
  double largest = 0;
  for (const auto& bricks : m_work) {
    std::vector<double> steps(bricks.size());
    parallel_for(bricks.size(), Grain{4},
                 [&](std::size_t n) { steps[n] = sweep(bricks[n], relaxation); });
    for (const double step : steps) largest = std::max(largest, step);
  }
  for (const VolumeClusters& clusters : m_clusters) {
    largest = std::max(largest, clusters.step(m_now, relaxation, m_due, m_changed));
  }
  ++m_passes;
  find_work();
  return largest / kFineVoxel;
}

double VolumeRelaxation::energy_of(std::size_t brick) const {
  BrickData data;
  load(brick, data);
  const CellEnergy twice = energy_of_cells(data.cells, data.links, tables(), rest_of(data));
  double energy = m_cell_energy * twice.excess_squared;
  for (std::size_t c = 0; c < 3; ++c) {
    energy += 0.5 * twice.links[c] * m_coordinates[c].fine_mm * m_coordinates[c].fine_mm;
  }
  return energy;
}

double VolumeRelaxation::energy() {
  for (const auto& bricks : m_work) {
    parallel_for(bricks.size(), Grain{4},
                 [&](std::size_t n) { m_energies[bricks[n]] = energy_of(bricks[n]); });
  }
  double total = 0;
  for (const double energy : m_energies) total += energy;
  return total;
}

void VolumeRelaxation::store(Body& body) const {
  for (std::size_t c = 0; c < 3; ++c) store_fine(m_now[c], int(c), body);
}

LinkTables VolumeRelaxation::tables() const {
  return {&m_coordinates[0].table, &m_coordinates[1].table, &m_coordinates[2].table};
}

std::size_t VolumeRelaxation::bytes() const {
  std::size_t total =
      m_due.capacity() + m_changed.capacity() + m_energies.capacity() * sizeof(double);
  for (const auto& bricks : m_work) total += bricks.capacity() * sizeof(bricks[0]);
  for (const auto& offsets : m_now) total += offsets.bytes();
  for (const Coordinate& c : m_coordinates) total += c.table.bytes() + c.elements.bytes();
  for (const VolumeClusters& clusters : m_clusters) total += clusters.bytes();
  return total;
}

}  // namespace supple
