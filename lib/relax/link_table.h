// Stiffness and limits of a link in one coordinate, looked up from the classes of its ends (thesis
// section 4.2.3, design.md section 3).
#pragma once

#include <cstdint>
#include <vector>

#include "lib/body/body.h"
#include "lib/relax/link_kinds.h"
#include "volumes/base/vec.h"

namespace supple {

// How much of a body's elasticity the springs of each kind of link carry.
//
// A spring that stretches by u(x + l) - u(x) along the step l stores k (l . grad u)^2 / 2 in each
// coordinate, so that all kinds together are the continuum E |grad u|^2 / 2 per volume where
//   sum over kinds of k l_a l_b = E V delta_ab,
// V the volume of a voxel. Along the axes alone this is k = E V / h_a^2, Young's modulus times area
// over length. Diagonals in their four or two directions add nothing to a != b. With
//   k = w E V / (longest spacing along the diagonal)^2
// the axes carry the rest, which is always positive. Where the spacings are equal, w is that of the
// isotropic stencils of 18 and 26 neighbours (lattice Boltzmann's D3Q19 and D3Q27):
//   18: 1/3 along axes, 1/6 across faces;   26: 4/9 along axes, 1/9 across faces, 1/36 across
//   cells,
// for which the terms of fourth order are a multiple of (d^2)^2 as well: a handle's dimple is round
// already a few voxels from it (docs/models/relaxation.md).

/// Stiffness in N/m of a link of one kPa, for 6, 18 or 26 links per voxel.
std::array<double, kLinkKinds> spring_shares(const Vec3d& spacing_mm, int links);

/// A link that is absent has no stiffness and no limits.
struct alignas(16) LinkValues {
  float stiffness;     // N/m; the same along and across the link, as in the thesis
  float upper, lower;  // 2^-16 voxel, infinite without a limit; below 2^24 exact, else rounded down
  float yield;         // 2^-16 voxel from its rest stretch; infinite where it is elastic
};

/// Stretch by which the spring of a link pulls when it is stretched that far from its rest stretch,
/// both in 2^-32 voxel: no more than where it yields.
inline double pulled_stretch(const LinkValues& link, double stretch) {
  const double yield = link.yield * 65536.0;
  return stretch > yield ? yield : stretch < -yield ? -yield : stretch;
}

/// Links with no more slack than this count as at their limit: relaxation comes to rest that near.
constexpr int kTightSlack = 16;  // 2^-16 voxel

enum class RigidLinks { absent, springs };

class LinkTable {
 public:
  /// Stiffness of a link: Young's modulus times its share, with 6 links the area
  /// that belongs to it over its length. Rigid links, those without slack, are absent where their
  /// ends move as one (clusters.h). `links`: those of the body, or 6 for axis links alone.
  LinkTable(const Body& body, int coordinate, RigidLinks rigid, int links);
  LinkTable(const Body& body, int coordinate, RigidLinks rigid)
      : LinkTable(body, coordinate, rigid, body.slacks.links()) {}

  /// Values of a kind of link (link_kinds.h); axes are the first three. Entry class_a * stride +
  /// class_b of a row, stride as in SlackTable, classes as in Body; missing() and beyond: absent.
  const LinkValues* row(int kind) const { return m_rows[std::size_t(kind)].data(); }
  const LinkValues& values(int kind, int class_a, int class_b) const {
    return m_rows[std::size_t(kind)][std::size_t(class_a) * m_stride + class_b];
  }
  /// Links per voxel: 6, 18 or 26.
  int links() const { return m_links; }
  int stride() const { return m_stride; }
  int coordinate() const { return m_coordinate; }
  std::int32_t missing() const { return std::int32_t(m_rows[0].size()) - 1; }
  /// True where a link of these classes lets its ends come neither nearer nor farther apart.
  bool is_rigid(int kind, int class_a, int class_b) const {
    return m_rigid[std::size_t(kind)][std::size_t(class_a) * m_stride + class_b] != 0;
  }
  bool has_rigid() const { return m_has_rigid; }
  bool has_yield() const { return m_has_yield; }
  std::size_t bytes() const;

 private:
  int m_stride;
  int m_coordinate;
  int m_links;
  bool m_has_rigid = false, m_has_yield = false;
  std::vector<std::vector<LinkValues>> m_rows;     // per kind
  std::vector<std::vector<std::uint8_t>> m_rigid;  // per kind
};

}  // namespace supple
