// The displacement in the air around a body with cuts: from either side of a cut on its own.
#include <utility>

#include <tbb/parallel_for.h>

#include "volumes/field/cuts/cut_body.h"
#include "volumes/grid/cell.h"
#include "volumes/grid/padded_rows.h"

namespace supple {

namespace {

constexpr int kRings = 2;
// Beside a cut a voxel may be this many rings from the elements of its own side.
constexpr int kRingsOfSide = 4;

/// Rings of voxels around the elements: 0 for elements, kRings + 1 for all beyond the last.
class Rings {
 public:
  /// Of `voxels` and what is within a brick of them.
  Rings(const BrickTopology& voxels, const BrickTopology& elements)
      : m_bricks(touching_bricks(voxels)), m_rings(m_bricks.brick_count()) {
    for (auto& rings : m_rings) rings.fill(kRings + 1);
    const BrickTopology inside = intersect(elements, m_bricks);
    for (int ring = kRings; ring >= 0; --ring) {
      const BrickTopology reached = dilate(inside, ring);
      for (std::size_t b = 0; b < reached.brick_count(); ++b) {
        const std::int32_t here = m_bricks.find(reached.origin(b));
        if (here < 0) continue;
        auto& rings = m_rings[std::size_t(here)];
        for_each_active(reached.mask(b),
                        [&](int n) { rings[std::size_t(n)] = std::uint8_t(ring); });
      }
    }
  }

  int operator[](const Vec3i& voxel) const {
    return m_rings[std::size_t(m_bricks.find(voxel))][std::size_t(brick_offset(voxel))];
  }
  void put_off(const Vec3i& voxel) {
    ++m_rings[std::size_t(m_bricks.find(voxel))][std::size_t(brick_offset(voxel))];
  }

 private:
  BrickTopology m_bricks;
  std::vector<std::array<std::uint8_t, kBrickVoxels>> m_rings;
};

/// What a voxel of the air is given from those of lower rings on its own side.
Extrapolation extrapolated(const Vec3i& voxel, int ring, const VectorBricks& u, const Rings& rings,
                           const CutBody& body) {
  const auto value_at = [&](const Vec3i& from, const Vec3i& to, Vec3f& value) {
    return u.at(to, value) && rings[to] < ring && body.connects(from, to);
  };
  Extrapolation extrapolation;
  for (int n = 0; n < 27; ++n) {
    const Vec3i beside = voxel + Vec3i(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1);
    Vec3f near, far;
    if (n == 13 || !value_at(voxel, beside, near)) continue;
    if (value_at(beside, 2 * beside - voxel, far)) {
      extrapolation.add_row(near, far);
    } else {
      extrapolation.add(near);
    }
  }
  return extrapolation;
}

}  // namespace

void extend_beside_cuts(VectorBricks& u, const CutBody& body) {
  // The second ring sees four voxels far.
  std::vector<Vec3i> corners;
  for (const Vec3i& cell : body.parted_cells()) {
    for (int n = 0; n < kCellCorners; ++n) corners.push_back(cell + cell_corner(n));
  }
  const BrickTopology shell =
      subtract(intersect(dilate(topology_of(corners), 3), u.topology), body.elements());
  Rings rings(shell, body.elements());
  for (int ring = 1; ring <= kRingsOfSide; ++ring) {
    struct OfBrick {
      std::vector<std::pair<int, Vec3f>> values;
      std::vector<int> later;  // next to no voxel of their own side yet
    };
    std::vector<OfBrick> found(shell.brick_count());
    tbb::parallel_for(std::size_t(0), found.size(), [&](std::size_t b) {
      for_each_active(shell.mask(b), [&](int offset) {
        const Vec3i voxel = shell.origin(b) + brick_local(offset);
        if (rings[voxel] != ring) return;
        const Extrapolation own = extrapolated(voxel, ring, u, rings, body);
        if (own.empty()) {
          found[b].later.push_back(offset);
        } else {
          found[b].values.emplace_back(offset, own.value());
        }
      });
    });
    for (std::size_t b = 0; b < found.size(); ++b) {
      const std::int32_t brick = u.topology.find(shell.origin(b));
      for (const auto& [offset, value] : found[b].values) {
        u.vectors.touch(std::size_t(brick))[offset] = value;
      }
      for (const int offset : found[b].later) rings.put_off(shell.origin(b) + brick_local(offset));
    }
  }
}

}  // namespace supple
