// Tetrahedra between the cuts of one lattice tetrahedron, through all extreme positions of two
// labels and through random ones of three and four.
#include <cmath>
#include <map>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "lib/mesh/tets/cleaving.h"
#include "lib/mesh/tets/tet_fan.h"

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
    TetPoints points;
    points.corners = {0, 1, 2, 3};
    for (std::size_t e = 0; e < 6; ++e) {
      int p = kTetEdges[e][0], q = kTetEdges[e][1];
      if (m_tet.signs[std::size_t(p)] * m_tet.signs[std::size_t(q)] >= 0) continue;
      if (m_tet.signs[std::size_t(p)] > 0) std::swap(p, q);
      points.cuts[e] = 4 + 4 * p + q;
      points.ranks[e] = edge_rank(m_tet.places[std::size_t(p)], m_tet.places[std::size_t(q)]);
    }
    const auto add_inside = [&](int a, int b, int c, int d) {
      for (const int node : {a, b, c, d}) {
        if (node < 4 && m_tet.signs[std::size_t(node)] < 0) {
          return add({place(a), place(b), place(c), place(d)});
        }
      }
    };
    const std::int32_t tip = points.first_cut(-1);
    tip < 0 ? add_inside(0, 1, 2, 3) : fan(points, tip, add_inside);
  }

  void add(const std::array<Vec3d, 4>& p) {
    const TetAngles angles(p);
    ++tetrahedra;
    inverted += tet_volume(p) > 0 ? 0 : 1;
    least = std::min(least, angle_deg(angles.largest_cosine));
    largest = std::max(largest, angle_deg(angles.least_cosine));
  }

  /// A tetrahedron of positive volume whose long edges are 0-1 and 2-3.
  struct LatticeTet {
    std::array<LatticePlace, 4> places;
    std::array<std::int8_t, 4> signs;  // -1 inside, 0 on the surface, 1 outside
  };
  LatticeTet m_tet{};
  std::vector<int> m_warped;
  std::array<Vec3i, 4> m_steps{};
  std::array<Vec3d, 4> m_at{};
  std::array<Vec3d, 16> m_cuts{};
};

}  // namespace

TEST(UnitTetFan, EveryExtremePositionOfATetrahedronKeepsTheProvenAngles) {
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

TEST(PropertyTetFan, PartsOfTwoToFourLabelsFillTheTetrahedronAndItsFacesWithoutGaps) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> part(0.2, 0.8);
  for (int n = 0; n < 2000; ++n) {
    const std::array<Vec3d, 4> corners = {Vec3d(0), {2, 0, 0}, {1, 1, -1}, {1, 1, 1}};
    std::vector<Vec3d> places(corners.begin(), corners.end());
    const auto add = [&](const Vec3d& place) {
      places.push_back(place);
      return std::int32_t(places.size() - 1);
    };
    TetPoints points;
    points.corners = {0, 1, 2, 3};
    std::array<unsigned, 4> labels{};
    for (unsigned& label : labels) label = random() % 4;
    for (std::size_t e = 0; e < 6; ++e) {
      const std::size_t p = std::size_t(kTetEdges[e][0]), q = std::size_t(kTetEdges[e][1]);
      points.ranks[e] = random();
      if (labels[p] == labels[q]) continue;
      points.cuts[e] = add(corners[p] + (corners[q] - corners[p]) * part(random));
    }
    std::int32_t tip = points.first_cut(-1);
    if (tip < 0) continue;
    for (std::size_t f = 0; f < 4; ++f) {
      const std::size_t a = f == 0 ? 1 : 0, b = f <= 1 ? 2 : 1, c = f == 3 ? 2 : 3;
      if (labels[a] == labels[b] || labels[b] == labels[c] || labels[a] == labels[c]) continue;
      const double u = part(random), v = part(random), w = part(random);
      points.in_face[f] = add((corners[a] * u + corners[b] * v + corners[c] * w) / (u + v + w));
      tip = points.in_face[f];
    }
    if (places.size() == 14) tip = add((corners[0] + corners[1] + corners[2] + corners[3]) / 4);
    double volume = 0;
    std::map<std::array<int, 3>, int> faces;
    fan(points, tip, [&](int a, int b, int c, int d) {
      const std::array<int, 4> tet{a, b, c, d};
      const double own = tet_volume({places[std::size_t(a)], places[std::size_t(b)],
                                     places[std::size_t(c)], places[std::size_t(d)]});
      EXPECT_GT(own, 1e-4);
      volume += own;
      for (std::size_t f = 0; f < 4; ++f) {
        std::array<int, 3> face{tet[(f + 1) & 3U], tet[(f + 2) & 3U], tet[(f + 3) & 3U]};
        std::sort(face.begin(), face.end());
        ++faces[face];
      }
    });
    EXPECT_NEAR(volume, tet_volume(corners), 1e-12);
    for (const auto& [face, count] : faces) {
      bool is_outer = false;
      for (std::size_t f = 0; f < 4; ++f) {
        const Vec3d &a = corners[(f + 1) & 3U], &b = corners[(f + 2) & 3U],
                    &c = corners[(f + 3) & 3U];
        const Vec3d normal = (b - a).cross(c - a);
        const auto is_on = [&](int node) {
          return std::abs(normal.dot(places[std::size_t(node)] - a)) < 1e-12;
        };
        is_outer |= is_on(face[0]) && is_on(face[1]) && is_on(face[2]);
      }
      ASSERT_EQ(count, is_outer ? 1 : 2) << n;
    }
  }
}

}  // namespace supple::test
