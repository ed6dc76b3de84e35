#include "lib/fem/tet/shell_triangles.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "lib/fem/elastic_law.h"
#include "lib/fem/tet/tet_shape.h"
#include "volumes/base/error.h"

namespace supple {

namespace {

/// Curvatures xx, yy, xy in the frame of a triangle.
using Curvature = std::array<double, 3>;

struct TriangleFrame {
  Vec3d normal;
  double area = 0;
  std::array<Vec3d, 3> tangents, outward;  // of edges 01, 12, 20, of unit length
  std::array<double, 3> lengths;

  explicit TriangleFrame(const std::array<Vec3d, 3>& x) {
    const Vec3d twice = (x[1] - x[0]).cross(x[2] - x[0]);
    area = twice.length() / 2;
    normal = twice / (2 * area);
    for (std::size_t e = 0; e < 3; ++e) {
      const Vec3d along = x[(e + 1) % 3] - x[e];
      lengths[e] = along.length();
      tangents[e] = along / lengths[e];
      outward[e] = tangents[e].cross(normal);
    }
  }
  /// The gradient of a corner's linear shape function.
  Vec3d gradient(std::size_t corner) const {
    const std::size_t opposite = (corner + 1) % 3;
    return outward[opposite] * (-lengths[opposite] / (2 * area));
  }
};

void add_stretch(const TriangleFrame& frame, const ElasticSheet& sheet, TriangleMatrix& matrix) {
  const double weight = sheet.thickness_mm * frame.area, nu = sheet.poisson;
  const double lambda = weight * sheet.young_kpa * nu / (1 - nu * nu);
  const double mu = weight * sheet.young_kpa / (2 * (1 + nu));
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = 0; b < 3; ++b) {
      const Vec3d g = frame.gradient(a), h = frame.gradient(b);
      Matrix9 block{};
      add_stiffness(lambda, mu, g, h, block);
      const double out = mu * g.dot(h);
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
          matrix[3 * a + i][3 * b + j] +=
              block[3 * i + j] - out * frame.normal[int(i)] * frame.normal[int(j)];
        }
      }
    }
  }
}

/// Curvatures by the deflection of each corner, then by the turn about each edge.
std::array<Curvature, 6> curvatures(const TriangleFrame& frame) {
  const Vec3d x = frame.tangents[0], y = frame.normal.cross(x);
  std::array<Curvature, 6> out{};
  for (std::size_t e = 0; e < 3; ++e) {
    const double tx = frame.tangents[e].dot(x), ty = frame.tangents[e].dot(y);
    const double mx = frame.outward[e].dot(x), my = frame.outward[e].dot(y);
    const Curvature sheared{tx * mx, ty * my, (tx * my + ty * mx) / 2},
        bent{mx * mx, my * my, mx * my};
    for (std::size_t n = 0; n < 3; ++n) {
      out[e][n] -= sheared[n] / frame.area;
      out[(e + 1) % 3][n] += sheared[n] / frame.area;
      // A positive turn about the tangent lowers what lies outward.
      out[3 + e][n] = -frame.lengths[e] * bent[n] / frame.area;
    }
  }
  return out;
}

void add_bending(const TriangleFrame& frame, const ElasticSheet& sheet, TriangleMatrix& matrix) {
  const double h = sheet.thickness_mm, nu = sheet.poisson;
  const double stiffness = frame.area * sheet.young_kpa * h * h * h / (12 * (1 - nu * nu));
  const std::array<Curvature, 6> of = curvatures(frame);
  // The direction in which each of the twelve unknowns counts, and as which of the six.
  const auto six = [](std::size_t n) { return n < 9 ? n / 3 : n - 6; };
  const auto part = [&](std::size_t n) { return n < 9 ? frame.normal[int(n % 3)] : 1; };
  for (std::size_t n = 0; n < 12; ++n) {
    for (std::size_t m = 0; m < 12; ++m) {
      const Curvature &a = of[six(n)], &b = of[six(m)];
      const double product = a[0] * b[0] + a[1] * b[1] + 2 * (a[2] * b[2]);
      const double traces = (a[0] + a[1]) * (b[0] + b[1]);
      matrix[n][m] += stiffness * ((1 - nu) * product + nu * traces) * (part(n) * part(m));
    }
  }
}

[[noreturn]] void refuse_triangle(std::size_t triangle, const ElasticSheet& sheet,
                                  const std::string& found, const std::string& expected) {
  throw InputError(
      {"", "faces " + sheet.faces + ", triangle " + std::to_string(triangle), found, expected});
}

}  // namespace

void ElasticSheet::validate() const {
  require(young_kpa > 0 && std::isfinite(young_kpa), "stiffness", young_kpa, "above 0 kPa");
  require(poisson > -1 && poisson <= 0.5, "poisson", poisson, "above -1 and at most 0.5");
  require(thickness_mm > 0 && std::isfinite(thickness_mm), "thickness", thickness_mm, "above 0 mm");
}

TriangleMatrix triangle_stiffness(const std::array<Vec3d, 3>& corners, const ElasticSheet& sheet) {
  TriangleMatrix matrix{};
  const TriangleFrame frame(corners);
  if (sheet.kind != SheetKind::bending) add_stretch(frame, sheet, matrix);
  if (sheet.kind != SheetKind::stretch) add_bending(frame, sheet, matrix);
  return matrix;
}

ShellTriangles::ShellTriangles(const std::vector<ElasticSheet>& sheets,
                               const std::vector<Triangle>& triangles,
                               const std::vector<Vec3d>& positions)
    : m_first_node(NodeIndex(positions.size())), m_sheets(sheets), m_triangles(triangles) {
  const auto edge_of = [](const Triangle& triangle, std::size_t e) {
    const NodeIndex a = triangle.corners[e], b = triangle.corners[(e + 1) % 3];
    return std::array<NodeIndex, 2>{std::min(a, b), std::max(a, b)};
  };
  const auto bends = [&](const Triangle& triangle) {
    return m_sheets[std::size_t(triangle.sheet)].kind != SheetKind::stretch;
  };
  for (const Triangle& triangle : m_triangles) {
    for (std::size_t e = 0; e < 3 && bends(triangle); ++e) m_edges.push_back(edge_of(triangle, e));
  }
  std::sort(m_edges.begin(), m_edges.end());
  m_edges.erase(std::unique(m_edges.begin(), m_edges.end()), m_edges.end());
  for (std::size_t n = 0; n < m_triangles.size(); ++n) {
    const Triangle& triangle = m_triangles[n];
    const ElasticSheet& sheet = m_sheets[std::size_t(triangle.sheet)];
    std::array<Vec3d, 3> corners;
    for (std::size_t c = 0; c < 3; ++c) corners[c] = positions[std::size_t(triangle.corners[c])];
    m_areas.push_back((corners[1] - corners[0]).cross(corners[2] - corners[0]).length() / 2);
    if (!(m_areas.back() > 0)) {
      refuse_triangle(n, sheet, number_text(m_areas.back()) + " mm²", "an area above 0");
    }
    TriangleMatrix matrix = triangle_stiffness(corners, sheet);
    std::array<NodeIndex, 6> nodes{triangle.corners[0], triangle.corners[1], triangle.corners[2]};
    std::array<std::int32_t, 3> edges{-1, -1, -1};
    for (std::size_t e = 0; e < 3 && bends(triangle); ++e) {
      const std::array<NodeIndex, 2> edge = edge_of(triangle, e);
      edges[e] =
          std::int32_t(std::lower_bound(m_edges.begin(), m_edges.end(), edge) - m_edges.begin());
      nodes[3 + e] = m_first_node + edges[e] / 3;
      if (edge[0] == triangle.corners[e]) continue;
      for (std::size_t m = 0; m < 12; ++m) {
        matrix[9 + e][m] = -matrix[9 + e][m];
        matrix[m][9 + e] = -matrix[m][9 + e];
      }
    }
    m_sets.add(nodes.data(), bends(triangle) ? 6 : 3);
    m_edges_of.push_back(edges);
    m_matrices.push_back(matrix);
  }
}

ShellTriangles ShellTriangles::bending_alone(const std::vector<Vec3d>& positions) const {
  std::vector<Triangle> bending;
  std::copy_if(m_triangles.begin(), m_triangles.end(), std::back_inserter(bending),
               [&](const Triangle& of) {
                 return m_sheets[std::size_t(of.sheet)].kind != SheetKind::stretch;
               });
  std::vector<ElasticSheet> sheets = m_sheets;
  for (ElasticSheet& sheet : sheets) sheet.kind = SheetKind::bending;
  return ShellTriangles(sheets, bending, positions);
}

void ShellTriangles::add_to(BlockCsr& matrix, const std::vector<double>& parts,
                            const std::vector<double>& inertia) const {
  matrix.add_sets(m_sets, [&](std::size_t n, std::int32_t at, Matrix9* blocks) {
    const std::size_t sheet = std::size_t(m_triangles[n].sheet);
    const double thickness = m_sheets[sheet].thickness_mm;
    const double mass = inertia[sheet] * thickness * m_areas[n] / 12;
    const double turning = mass * thickness * thickness / 3;
    // Unknown of the triangle that is component c of its node; 12: none.
    const auto unknown = [&](std::size_t node, std::size_t c) {
      if (node < 3) return 3 * node + c;
      return std::size_t(m_edges_of[n][node - 3] % 3) == c ? 6 + node : 12;
    };
    const std::size_t a = std::size_t(at);
    for (std::size_t b = 0; b < m_sets.count(n); ++b) {
      Matrix9 block{};
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
          const std::size_t row = unknown(a, i), column = unknown(b, j);
          if (row < 12 && column < 12) block[3 * i + j] = parts[sheet] * m_matrices[n][row][column];
        }
        if (a < 3 && b < 3) block[4 * i] += mass * (a == b ? 2 : 1);
      }
      if (a >= 3 && a == b) block[4 * std::size_t(m_edges_of[n][a - 3] % 3)] += turning;
      blocks[b] = block;
    }
  });
  fill_last_node(matrix);
}

void ShellTriangles::fill_last_node(BlockCsr& matrix) const {
  const std::size_t used = m_edges.size() % 3;
  if (used == 0) return;
  NodeSets last;
  const NodeIndex node = m_first_node + NodeIndex(turn_node_count()) - 1;
  last.add(&node, 1);
  const auto& columns = matrix.columns();
  const auto row = columns.begin() + matrix.begin()[std::size_t(node)];
  const auto end = columns.begin() + matrix.begin()[std::size_t(node) + 1];
  const std::size_t slot = std::size_t(std::lower_bound(row, end, node) - columns.begin());
  const double like = matrix.blocks()[slot][4 * (used - 1)];
  matrix.add_sets(last, [&](std::size_t, std::int32_t, Matrix9* blocks) {
    blocks[0] = Matrix9{};
    for (std::size_t c = used; c < 3; ++c) blocks[0][4 * c] = like;
  });
}

std::vector<double> ShellTriangles::area_ratios(const std::vector<Vec3d>& displaced) const {
  std::vector<double> out;
  for (std::size_t n = 0; n < m_triangles.size(); ++n) {
    const auto corner = [&](std::size_t c) {
      return displaced[std::size_t(m_triangles[n].corners[c])];
    };
    const Vec3d twice = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    out.push_back(twice.length() / 2 / m_areas[n]);
  }
  return out;
}

std::size_t ShellTriangles::bytes() const {
  return m_triangles.capacity() * (sizeof(Triangle) + sizeof(TriangleMatrix) + 5 * sizeof(double)) +
         m_edges.capacity() * sizeof(m_edges[0]) + m_sets.bytes();
}

}  // namespace supple
