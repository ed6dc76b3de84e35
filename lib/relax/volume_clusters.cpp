#include "lib/relax/volume_clusters.h"

#include <algorithm>
#include <cmath>

#include "lib/relax/cell_sweep.h"
#include "lib/relax/cell_volume.h"
#include "lib/relax/cluster_pull.h"
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

}  // namespace supple
