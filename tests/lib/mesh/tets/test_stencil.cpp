// The stencils of isosurface stuffing, through all extreme positions of one lattice tetrahedron.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "lib/mesh/tets/stencil.h"
#include "lib/mesh/tets/stuffing.h"

namespace supple::test {
namespace {

std::vector<Vec3i> all_steps() {
  std::vector<Vec3i> steps;
  for (int edge = 0; edge < kOwnedEdges; ++edge) {
    steps.push_back(edge_step(edge));
    if (edge < kLongEdges) steps.push_back(-edge_step(edge));
  }
  return steps;
}

/// Positions of a tetrahedron: signs, where its warped vertices go, and where its edges are cut.
class Positions {
 public:
  explicit Positions(int turn) {
    const int ring[4][2] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};
    const auto corner = [&](int n) { return Vec3i(6, 5 + ring[n % 4][0], 5 + ring[n % 4][1]); };
    m_tet.places = {Vec3i(5), {7, 5, 5}, corner(turn), corner(turn + 1)};
    m_tet.nodes = {0, 1, 2, 3};
  }

  void go_through_all() {
    for (int pattern = 0; pattern < 81; ++pattern) {
      m_warped.clear();
      for (int n = 0, rest = pattern; n < 4; ++n, rest /= 3) {
        m_tet.signs[std::size_t(n)] = std::int8_t(rest % 3 - 1);
        if (rest % 3 == 1) m_warped.push_back(n);
      }
      choose_directions(0);
    }
  }

  double least = 180, largest = 0;
  std::int64_t tetrahedra = 0, inverted = 0;

 private:
  static double threshold(bool is_long) { return is_long ? kWarpLong : kWarpShort; }

  /// Every edge of every warped vertex.
  void choose_directions(std::size_t next) {
    if (next < m_warped.size()) {
      for (const Vec3i& step : all_steps()) {
        m_steps[std::size_t(m_warped[next])] = step;
        choose_directions(next + 1);
      }
      return;
    }
    if (can_be()) choose_lengths(0);
  }

  /// The vertex towards which one has moved; -1 for one of another tetrahedron.
  int target(int n) const {
    const auto& places = m_tet.places;
    for (int other = 0; other < 4; ++other) {
      if (places[std::size_t(n)] + m_steps[std::size_t(n)] == places[std::size_t(other)]) {
        return other;
      }
    }
    return -1;
  }

  /// A vertex that has moved takes the cuts of its edges away, so none follow each other in a
  /// circle; and ends of a cut edge lie on different sides.
  bool can_be() const {
    for (const int first : m_warped) {
      int at = target(first);
      for (int n = 0; n < 4 && at >= 0 && is_warped(at); ++n) {
        if (at == first) return false;
        at = target(at);
      }
    }
    for (int signs = 0; signs < 1 << m_warped.size(); ++signs) {
      std::array<int, 4> before{};
      for (int n = 0; n < 4; ++n) before[std::size_t(n)] = m_tet.signs[std::size_t(n)];
      for (std::size_t w = 0; w < m_warped.size(); ++w) {
        before[std::size_t(m_warped[w])] = (signs >> w & 1) != 0 ? 1 : -1;
      }
      bool differ = true;
      for (const int n : m_warped) {
        const int to = target(n);
        differ &= to < 0 || before[std::size_t(n)] != before[std::size_t(to)];
      }
      if (differ) return true;
    }
    return false;
  }
  bool is_warped(int n) const { return m_tet.signs[std::size_t(n)] == 0; }

  /// No way and the longest, of every warped vertex.
  void choose_lengths(std::size_t next) {
    if (next < m_warped.size()) {
      const std::size_t n = std::size_t(m_warped[next]);
      const bool is_long = (m_steps[n].x & 1) == 0;
      for (const double part : {0.0, threshold(is_long)}) {
        m_at[n] = Vec3d(m_tet.places[n]) + Vec3d(m_steps[n]) * part;
        choose_lengths(next + 1);
      }
      return;
    }
    choose_cuts(0);
  }

  /// The nearest and the farthest place of every cut.
  void choose_cuts(int next) {
    if (next == 16) return measure();
    const int p = next / 4, q = next % 4;
    if (!(m_tet.signs[std::size_t(p)] < 0 && m_tet.signs[std::size_t(q)] > 0)) {
      return choose_cuts(next + 1);
    }
    const double nearest = threshold((p ^ 1) == q);
    for (const double part : {nearest, 1 - nearest}) {
      const Vec3d from(m_tet.places[std::size_t(p)]), to(m_tet.places[std::size_t(q)]);
      m_cuts[std::size_t(next)] = from + (to - from) * part;
      choose_cuts(next + 1);
    }
  }

  void measure() {
    for (std::size_t n = 0; n < 4; ++n) {
      if (m_tet.signs[n] != 0) m_at[n] = Vec3d(m_tet.places[n]);
    }
    const auto place = [&](std::int32_t node) {
      return node < 4 ? m_at[std::size_t(node)] : m_cuts[std::size_t(node - 4)];
    };
    stuff(
        m_tet, [](int p, int q) { return std::int32_t(4 + 4 * p + q); },
        [&](int a, int b, int c, int d) {
          add({place(a), place(b), place(c), place(d)});
        });
  }

  void add(const std::array<Vec3d, 4>& p) {
    const std::array<Vec3d, 4> normals = {
        (p[3] - p[1]).cross(p[2] - p[1]), (p[2] - p[0]).cross(p[3] - p[0]),
        (p[3] - p[0]).cross(p[1] - p[0]), (p[1] - p[0]).cross(p[2] - p[0])};
    ++tetrahedra;
    inverted += (p[1] - p[0]).cross(p[2] - p[0]).dot(p[3] - p[0]) > 0 ? 0 : 1;
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = i + 1; j < 4; ++j) {
        const double cosine =
            -normals[i].dot(normals[j]) / (normals[i].length() * normals[j].length());
        const double angle = std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / M_PI;
        least = std::min(least, angle);
        largest = std::max(largest, angle);
      }
    }
  }

  LatticeTet m_tet{};
  std::vector<int> m_warped;
  std::array<Vec3i, 4> m_steps{};
  std::array<Vec3d, 4> m_at{};
  std::array<Vec3d, 16> m_cuts{};
};

}  // namespace

TEST(UnitStencil, EveryExtremePositionOfATetrahedronKeepsTheProvenAngles) {
  for (int turn = 0; turn < 2; ++turn) {
    Positions positions(turn);
    positions.go_through_all();
    EXPECT_GT(positions.tetrahedra, 50'000);
    EXPECT_EQ(positions.inverted, 0);
    EXPECT_GE(positions.least, kLeastDihedralDeg);
    EXPECT_LE(positions.largest, kLargestDihedralDeg);
    EXPECT_LT(positions.least, kLeastDihedralDeg + 0.1);
  }
}

}  // namespace supple::test
