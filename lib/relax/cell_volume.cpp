#include "lib/relax/cell_volume.h"

#include <algorithm>
#include <vector>

#include "lib/relax/cell_brick.h"
#include "volumes/base/parallel.h"
#include "volumes/grid/cell.h"

namespace supple {

namespace {

double determinant(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  return a.dot(b.cross(c));
}

CellVolumes join(const CellVolumes& a, const CellVolumes& b) {
  return {a.cells + b.cells, a.rest_mm3 + b.rest_mm3, a.total_mm3 + b.total_mm3,
          std::min(a.smallest, b.smallest), std::max(a.largest, b.largest)};
}

/// Volumes of the cells whose lowest corners lie in brick b, in rest volumes of a cell.
CellVolumes volumes_in(const Body& body, std::size_t b) {
  const BricksAround around = bricks_around(body.elements, b);
  const CellRows cells = find_cells(body, around);
  const bool is_at_rest = std::all_of(around.begin(), around.end(), [&](std::int32_t other) {
    return other < 0 || std::all_of(body.q.begin(), body.q.end(), [&](const BrickValues& q) {
             return q.brick(std::size_t(other)) == nullptr;
           });
  });
  CellVolumes sum;
  for_each_cell(cells, [&](const Vec3i& low) {
    double volume = 1;
    if (!is_at_rest) {
      Hexahedron corners;
      for (int n = 0; n < 8; ++n) {
        const Vec3i step = cell_corner(n);
        const Slot slot = slot_around(around, low.x + step.x, low.y + step.y, low.z + step.z);
        for (int c = 0; c < 3; ++c) {
          corners[std::size_t(n)][c] = step[c] + body.q[std::size_t(c)].at(slot) / kFixedOne;
        }
      }
      volume = hexahedron_volume(corners);
    }
    sum = join(sum, {1, 1, volume, volume, volume});
  });
  return sum;
}

}  // namespace

double hexahedron_volume(const Hexahedron& x) {
  const Vec3d far_i = x[7] - x[4], far_j = x[7] - x[2], far_k = x[7] - x[1];
  const Vec3d near_jk = x[3] - x[0], near_ik = x[5] - x[0], near_ij = x[6] - x[0];
  return (determinant(far_i + near_jk, far_j, near_ij) +
          determinant(near_jk, far_j + near_ik, far_k) +
          determinant(far_i, near_ik, far_k + near_ij)) /
         12;
}

Vec3d hexahedron_gradient(const Hexahedron& corners, int corner) {
  const auto way = [&](int bits) {
    return corners[std::size_t(corner ^ bits)] - corners[std::size_t(corner)];
  };
  const auto face = [](const Vec3d& e1, const Vec3d& across, const Vec3d& e2) {
    return (e1 - e2).cross(across) + e1.cross(e2);
  };
  const Vec3d along_i = way(4), along_j = way(2), along_k = way(1);
  const Vec3d sum = face(along_i, way(6), along_j) + face(along_j, way(3), along_k) +
                    face(along_k, way(5), along_i);
  // Edges along i, j, k from the lowest corner are right-handed; each reversed axis reverses that.
  const bool is_right_handed = ((corner >> 2 ^ corner >> 1 ^ corner) & 1) == 0;
  return sum * (is_right_handed ? -1.0 / 12 : 1.0 / 12);
}

CellVolumes cell_volumes(const Body& body) {
  std::vector<CellVolumes> of_brick(body.elements.brick_count());
  parallel_for(of_brick.size(), Grain{4},
               [&](std::size_t b) { of_brick[b] = volumes_in(body, b); });
  CellVolumes total;
  for (const CellVolumes& volumes : of_brick) total = join(total, volumes);
  const Vec3d spacing = body.geometry.spacing_mm();
  const double cell_mm3 = spacing.x * spacing.y * spacing.z;
  total.rest_mm3 *= cell_mm3;
  total.total_mm3 *= cell_mm3;
  return total;
}

}  // namespace supple
