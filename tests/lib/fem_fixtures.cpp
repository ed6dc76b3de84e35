#include "tests/lib/fem_fixtures.h"

#include <algorithm>
#include <map>

#include <Eigen/Dense>
#include <gtest/gtest.h>

namespace supple::test {

namespace {

/// True if two neighbouring elements are joined across their common face.
bool is_joined(const Body& body, Vec3i a, Vec3i b) {
  if (voxel_less(b, a)) std::swap(a, b);
  if (!body.elements.is_active(a) || !body.elements.is_active(b)) return false;
  const int axis = b.x != a.x ? 0 : b.y != a.y ? 1 : 2;
  return !body.cuts.is_cut(std::size_t(body.elements.find(a)), brick_offset(a), axis);
}

/// The piece among the eight voxels around a lattice corner that a voxel belongs to, as the bits of
/// its voxels: voxel (corner - 1 + bits).
int piece_around(const Body& body, const Vec3i& corner, int own) {
  int piece = 1 << own;
  for (int round = 0; round < 8; ++round) {
    for (int a = 0; a < 8; ++a) {
      for (int axis = 0; axis < 3; ++axis) {
        const int b = a ^ (4 >> axis);
        const auto voxel = [&](int bits) {
          return corner - Vec3i(1) + Vec3i(bits >> 2 & 1, bits >> 1 & 1, bits & 1);
        };
        if ((piece >> a & 1) != 0 && is_joined(body, voxel(a), voxel(b))) piece |= 1 << b;
      }
    }
  }
  return piece;
}

/// All elements around a corner, unless a cut between two of them parts pieces there.
int joined_around(const Body& body, const Vec3i& corner, int own) {
  int all = 0;
  bool is_parted = false;
  for (int a = 0; a < 8; ++a) {
    const auto voxel = [&](int bits) {
      return corner - Vec3i(1) + Vec3i(bits >> 2 & 1, bits >> 1 & 1, bits & 1);
    };
    if (!body.elements.is_active(voxel(a))) continue;
    all |= 1 << a;
    for (int axis = 0; axis < 3; ++axis) {
      const int b = a ^ (4 >> axis);
      if (!body.elements.is_active(voxel(b)) || is_joined(body, voxel(a), voxel(b))) continue;
      is_parted = is_parted || (piece_around(body, corner, a) >> b & 1) == 0;
    }
  }
  return is_parted ? piece_around(body, corner, own) : all;
}

using Strain = Eigen::MatrixXd;  // 6 x 24

/// Engineering strain xx, yy, zz, xy, yz, zx of the corners' displacements.
Strain strain_matrix(const Eigen::Matrix3d& axes, const Vec3d& at) {
  Strain b = Strain::Zero(6, 24);
  const Eigen::Matrix3d inverse = axes.inverse();
  for (int n = 0; n < 8; ++n) {
    const int bits[3] = {n >> 2 & 1, n >> 1 & 1, n & 1};
    Eigen::RowVector3d slope;
    for (int d = 0; d < 3; ++d) {
      slope[d] = bits[d] != 0 ? 1 : -1;
      for (int e = 0; e < 3; ++e) {
        if (e != d) slope[d] *= bits[e] != 0 ? at[e] : 1 - at[e];
      }
    }
    const Eigen::RowVector3d g = slope * inverse;
    b(0, 3 * n) = b(3, 3 * n + 1) = b(5, 3 * n + 2) = g[0];
    b(1, 3 * n + 1) = b(3, 3 * n) = b(4, 3 * n + 2) = g[1];
    b(2, 3 * n + 2) = b(4, 3 * n + 1) = b(5, 3 * n) = g[2];
  }
  return b;
}

Eigen::MatrixXd element_stiffness(const Geometry& geometry, double e, double nu,
                                  Dilatation dilatation) {
  Eigen::Matrix3d axes;
  for (int a = 0; a < 3; ++a) {
    for (int c = 0; c < 3; ++c) axes(c, a) = geometry.axes_mm()[a][c];
  }
  Eigen::MatrixXd d = Eigen::MatrixXd::Zero(6, 6);
  const double factor = e / ((1 + nu) * (1 - 2 * nu));
  d.topLeftCorner(3, 3).setConstant(nu * factor);
  for (int n = 0; n < 3; ++n) {
    d(n, n) = (1 - nu) * factor;
    d(3 + n, 3 + n) = (1 - 2 * nu) / 2 * factor;
  }
  std::vector<Strain> points;
  Eigen::RowVectorXd mean = Eigen::RowVectorXd::Zero(24);
  for (int p = 0; p < 8; ++p) {
    const double lo = 0.5 - 0.5 / std::sqrt(3.0), hi = 1 - lo;
    points.push_back(strain_matrix(
        axes, {(p & 4) != 0 ? hi : lo, (p & 2) != 0 ? hi : lo, (p & 1) != 0 ? hi : lo}));
    mean += points.back().topRows(3).colwise().sum() / 8;
  }
  Eigen::MatrixXd k = Eigen::MatrixXd::Zero(24, 24);
  for (Strain& b : points) {
    if (dilatation == Dilatation::mean) {
      const Eigen::RowVectorXd own = b.topRows(3).colwise().sum();
      for (int n = 0; n < 3; ++n) b.row(n) += (mean - own) / 3;
    }
    k += b.transpose() * d * b * (std::abs(axes.determinant()) / 8);
  }
  return k;
}

}  // namespace

Body fem_body(int n, const std::function<int(const Vec3i&)>& class_of, double spacing_mm) {
  Block block = homogeneous(Vec3i(n), 1.5, 0.5, 0.5);
  block.spacing_mm = Vec3d(spacing_mm);
  for (int v = 0; v < block.size(); ++v) block.element[v] = class_of(block.voxel(v)) >= 0;
  Body body = body_of(block);
  for (std::size_t b = 0; b < body.elements.brick_count(); ++b) {
    for_each_active(body.elements.mask(b), [&](int offset) {
      body.classes[b * kBrickVoxels + offset] =
          std::uint8_t(class_of(body.elements.origin(b) + brick_local(offset)));
    });
  }
  return body;
}

Body fem_cube(int n, double spacing_mm) {
  return fem_body(
      n, [](const Vec3i&) { return 0; }, spacing_mm);
}

Body random_fem_body(std::mt19937& random, const Vec3i& max_dims) {
  Block block = random_block(random, max_dims);
  cut_randomly(random, block);
  Body body = body_of(block);
  for (std::uint8_t& of : body.classes) of = std::uint8_t(random() % 256);
  std::array<Vec3d, 3> axes{Vec3d(pick(random, 0.5, 2), 0, 0), Vec3d(0, pick(random, 0.5, 2), 0),
                            Vec3d(0, 0, pick(random, 0.5, 2))};
  for (Vec3d& axis : axes) {
    axis += Vec3d(pick(random, -0.2, 0.2), pick(random, -0.2, 0.2), pick(random, -0.2, 0.2));
  }
  if (random() % 2 == 0) std::swap(axes[0], axes[2]);
  body.geometry = Geometry(body.geometry.dims(), Vec3d(10, -20, 30), axes);
  return body;
}

ElasticTable random_elastic(std::mt19937& random) {
  ElasticTable table;
  for (int n = 0; n <= kLastClass; ++n) {
    table.young_kpa[n] = std::pow(10, pick(random, -1, 2));
    table.poisson[n] = pick(random, -0.3, 0.49);
  }
  return table;
}

SlotSet elements_in(const Body& body, const IndexBox& box) {
  return slots_in_box(body.elements, box);
}

HeldElements hold_where(const Body& body, std::function<bool(const Vec3d&)> where,
                        std::function<Vec3d(const Vec3d&)> displacement_mm) {
  HeldElements held;
  held.elements = slots_in_mask(body.elements, body.elements);
  held.holds_node = std::move(where);
  held.displacement_mm = std::move(displacement_mm);
  return held;
}

Eigen::SparseMatrix<double> assembled_stiffness(const Body& body, const HexMesh& mesh,
                                                const ElasticTable& elastic,
                                                const ElementChoice& choice) {
  using Node = std::array<int, 4>;  // lattice corner and piece
  std::map<Node, NodeIndex> node_of;
  std::map<NodeIndex, Node> seen;
  std::map<int, Eigen::MatrixXd> stiffness;
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t b = 0; b < body.elements.brick_count(); ++b) {
    std::int32_t element = mesh.element_begin[b];
    for_each_active(body.elements.mask(b), [&](int offset) {
      const Vec3i voxel = body.elements.origin(b) + brick_local(offset);
      const Corners corners = mesh.corners(element++);
      for (int c = 0; c < 8; ++c) {
        const Vec3i corner = voxel + Vec3i(c >> 2 & 1, c >> 1 & 1, c & 1);
        const Node node{corner.x, corner.y, corner.z,
                        choice.touching == Touching::joined ? joined_around(body, corner, 7 - c)
                                                            : piece_around(body, corner, 7 - c)};
        EXPECT_EQ(node_of.try_emplace(node, corners[c]).first->second, corners[c]);
        EXPECT_EQ(seen.try_emplace(corners[c], node).first->second, node);
      }
      const int of = body.classes[b * kBrickVoxels + offset];
      auto found = stiffness.find(of);
      if (found == stiffness.end()) {
        found = stiffness
                    .emplace(of, element_stiffness(body.geometry, elastic.young_kpa[of],
                                                   elastic.poisson[of], choice.dilatation))
                    .first;
      }
      for (int n = 0; n < 24; ++n) {
        for (int m = 0; m < 24; ++m) {
          entries.emplace_back(3 * corners[n / 3] + n % 3, 3 * corners[m / 3] + m % 3,
                               found->second(n, m));
        }
      }
    });
  }
  EXPECT_EQ(node_of.size(), std::size_t(mesh.node_count()));
  const int unknowns = 3 * mesh.node_count();
  Eigen::SparseMatrix<double> k(unknowns, unknowns);
  k.setFromTriplets(entries.begin(), entries.end());
  return k;
}

Eigen::MatrixXd assembled_mass(const FemModel& model, const MassDensities& density) {
  const HexMesh& mesh = model.mesh();
  Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(3 * mesh.node_count(), 3 * mesh.node_count());
  const double volume_mm3 = std::abs(mesh.geometry.determinant());
  for (std::int32_t e = 0; e < mesh.element_count(); ++e) {
    const Corners corners = mesh.corners(e);
    const double weight_kg = density[model.material().classes[e]] * 1e-9 * volume_mm3 / 8;
    for (int point = 0; point < 8; ++point) {
      double shape[8];
      for (int c = 0; c < 8; ++c) {
        shape[c] = 1;
        for (int bit = 1; bit < 8; bit *= 2) {
          const double at = 0.5 + ((point & bit) != 0 ? 0.5 : -0.5) / std::sqrt(3.0);
          shape[c] *= (c & bit) != 0 ? at : 1 - at;
        }
      }
      for (int a = 0; a < 8; ++a) {
        for (int b = 0; b < 8; ++b) {
          for (int axis = 0; axis < 3; ++axis) {
            mass(3 * corners[a] + axis, 3 * corners[b] + axis) += weight_kg * shape[a] * shape[b];
          }
        }
      }
    }
  }
  return mass;
}

Eigen::MatrixXd free_part(const Eigen::MatrixXd& matrix, const HeldBits& held) {
  std::vector<int> free;
  for (int n = 0; n < matrix.rows(); ++n) {
    if ((held[std::size_t(n / 3)] >> n % 3 & 1) == 0) free.push_back(n);
  }
  Eigen::MatrixXd part(Eigen::Index(free.size()), Eigen::Index(free.size()));
  for (Eigen::Index a = 0; a < part.rows(); ++a) {
    for (Eigen::Index b = 0; b < part.cols(); ++b) {
      part(a, b) = matrix(free[std::size_t(a)], free[std::size_t(b)]);
    }
  }
  return part;
}

MassDensities even_density(double kg_m3) {
  MassDensities density;
  density.fill(kg_m3);
  return density;
}

Corners corners_around(const HexMesh& fine, const HexMesh& coarse, const Coarsening& coarsening,
                       NodeIndex node) {
  const std::vector<NodeIndex>& begin = fine.node_begin;
  const auto block = std::upper_bound(begin.begin(), begin.end(), node) - begin.begin() - 1;
  return coarse.corners(coarsening.parent_of_node(std::size_t(block), node));
}

std::vector<double> orders_of(const std::vector<double>& errors) {
  std::vector<double> orders;
  for (std::size_t n = 1; n < errors.size(); ++n) {
    orders.push_back(std::log2(std::abs(errors[n - 1] / errors[n])));
  }
  return orders;
}

std::vector<double> random_values(std::mt19937& random, std::size_t count) {
  std::vector<double> values(count);
  for (double& value : values) value = pick(random, -1, 1);
  return values;
}

}  // namespace supple::test
