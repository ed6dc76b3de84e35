// Sixteen deformed cells at a time: corners, preconditioned equations and the nodes in reach, as
// deformed_cell.h does for one. For lane_solver.cpp alone, into which everything here is inlined.
#pragma once

#include <cmath>

#include "volumes/field/inversion/lanes.h"
#include "volumes/field/inversion/source_cells.h"
#include "volumes/grid/cell.h"

namespace supple {

// These have the same values as in deformed_cell.cpp.
constexpr float kEdge = 1e-5f;
constexpr float kNodeSlack = 1e-5f;
constexpr float kInjectiveHalf = 0.75f;

/// The deformed corners of sixteen cells, relative to their lowest lattice corners plus the shift.
struct LaneCorners {
  LaneVec p[8];  // 4 x + 2 y + z
  LaneInts translated;
};

inline LaneCorners load_corners(const SourceCells& cells, const Vec3f& shift, int x, int y) {
  LaneCorners corners;
  corners.translated = LaneInts{} - 1;
  Lanes first[3];
  for (int n = 0; n < 8; ++n) {
    const auto& half = n & 1 ? cells.upper : cells.lower;
    for (int a = 0; a < 3; ++a) {
      const Lanes u = load_lanes(&half[a][x + (n >> 2)][y + ((n >> 1) & 1)][0]);
      if (n == 0) first[a] = u;
      corners.translated &= u == first[a];
      const int step = a == 0 ? n >> 2 : a == 1 ? (n >> 1) & 1 : n & 1;
      corners.p[n][a] = u - shift[a] + float(step);
    }
  }
  return corners;
}

/// Edges along x, y and z, by the two other coordinates of their ends.
struct LaneEdges {
  LaneVec x[4], y[4], z[4];
};
inline LaneEdges edges_of(const LaneCorners& corners) {
  LaneEdges edges;
  const LaneVec* p = corners.p;
  for (int n = 0; n < 4; ++n) {
    const int upper = 4 * (n >> 1) + (n & 1);
    edges.x[n] = p[n + 4] - p[n];
    edges.y[n] = p[upper + 2] - p[upper];
    edges.z[n] = p[2 * n + 1] - p[2 * n];
  }
  return edges;
}

inline Lanes min_det_of(const LaneEdges& edges) {
  Lanes smallest;
  for (int n = 0; n < 8; ++n) {
    const auto [x, y, z] = cell_corner(n);
    const Lanes det = dot(edges.x[2 * y + z], cross(edges.y[2 * x + z], edges.z[2 * x + y]));
    smallest = n == 0 ? det : smaller(smallest, det);
  }
  return smallest;
}

inline Lanes longest_component(const LaneEdges& edges) {
  Lanes longest{};
  for (int n = 0; n < 4; ++n) {
    for (const LaneVec& edge : {edges.x[n], edges.y[n], edges.z[n]}) {
      longest = larger(longest, max_component(magnitude(edge)));
    }
  }
  return longest;
}

/// The preconditioned equation of sixteen cells; see deformed_cell.h.
struct LaneCells {
  LaneVec center;
  LaneVec rows[3];  // of the inverse of G
  LaneVec xy, yz, xz, xyz;
  LaneVec middle, half;  // box of the preconditioned corners
  Lanes bend;            // |N(a + b) - N(a) - N'(a) b| <= bend |b|^2
  LaneInts injective;    // on the box of half width kInjectiveHalf
  LaneInts regular;      // in the cell itself: then det F has one sign
};

inline LaneVec precondition(const LaneCells& cell, const LaneVec& v) {
  return {dot(cell.rows[0], v), dot(cell.rows[1], v), dot(cell.rows[2], v)};
}

/// Box of the preconditioned image: with the signs of x and y fixed, its ends along z.
inline void find_image_box(LaneCells& cell) {
  for (int a = 0; a < 3; ++a) {
    const float own = a == 2 ? 0.5f : 0;
    Lanes lo{}, hi{};
    for (int n = 0; n < 4; ++n) {
      const float x = n & 2 ? 0.5f : -0.5f, y = n & 1 ? 0.5f : -0.5f;
      const Lanes middle = (a == 0 ? x : a == 1 ? y : 0) + cell.xy[a] * (x * y);
      const Lanes slope =
          magnitude(own + 0.5f * (cell.yz[a] * y + cell.xz[a] * x + cell.xyz[a] * (x * y)));
      lo = n == 0 ? middle - slope : smaller(lo, middle - slope);
      hi = n == 0 ? middle + slope : larger(hi, middle + slope);
    }
    cell.middle[a] = (lo + hi) * 0.5f;
    cell.half[a] = (hi - lo) * 0.5f + kEdge;
  }
}

inline LaneCells set_up(const LaneCorners& corners) {
  const LaneVec* p = corners.p;
  // Sums and differences along z, then y, then x.
  LaneVec s[4], d[4];
  for (int n = 0; n < 4; ++n) {
    s[n] = p[2 * n] + p[2 * n + 1];
    d[n] = p[2 * n + 1] - p[2 * n];
  }
  const LaneVec ss0 = s[0] + s[1], ds0 = s[1] - s[0], sd0 = d[0] + d[1], dd0 = d[1] - d[0];
  const LaneVec ss1 = s[2] + s[3], ds1 = s[3] - s[2], sd1 = d[2] + d[3], dd1 = d[3] - d[2];
  const auto scaled = [](const LaneVec& v, float factor) { return v * broadcast(factor); };
  LaneCells cell;
  cell.center = scaled(ss0 + ss1, 0.125f);
  const LaneVec gx = scaled(ss1 - ss0, 0.25f), gy = scaled(ds0 + ds1, 0.25f),
                gz = scaled(sd0 + sd1, 0.25f);

  // Precondition by the inverse of G.
  const LaneVec gyz = cross(gy, gz);
  const Lanes inverse = 1.0f / dot(gx, gyz);
  cell.rows[0] = gyz * inverse;
  cell.rows[1] = cross(gz, gx) * inverse;
  cell.rows[2] = cross(gx, gy) * inverse;
  cell.xy = precondition(cell, scaled(ds1 - ds0, 0.5f));
  cell.yz = precondition(cell, scaled(dd0 + dd1, 0.5f));
  cell.xz = precondition(cell, scaled(sd1 - sd0, 0.5f));
  cell.xyz = precondition(cell, dd1 - dd0);

  const LaneVec pairs = magnitude(cell.xy) + magnitude(cell.yz) + magnitude(cell.xz);
  const LaneVec triple = magnitude(cell.xyz);
  constexpr float kHalf = kInjectiveHalf;
  cell.bend = max_component(pairs + scaled(triple, 7));
  cell.injective =
      max_component(scaled(pairs, 2 * kHalf) + scaled(triple, 3 * kHalf * kHalf)) < 1.0f;
  cell.regular = max_component(pairs + scaled(triple, 0.75f)) < 1.0f;
  find_image_box(cell);
  return cell;
}

/// Smallest and largest node in the box of the deformed corners.
inline void find_nodes(const LaneCorners& corners, LaneVec& lo, LaneVec& hi) {
  for (int a = 0; a < 3; ++a) {
    lo[a] = hi[a] = corners.p[0][a];
    for (int n = 1; n < 8; ++n) {
      lo[a] = smaller(lo[a], corners.p[n][a]);
      hi[a] = larger(hi[a], corners.p[n][a]);
    }
    lo[a] = ceil_lanes(lo[a] - kNodeSlack);
    hi[a] = floor_lanes(hi[a] + kNodeSlack);
  }
}

/// Leaves the nodes of an upper face that lies in a lattice plane to the cell on its other side,
/// which has the same face. `upper[a]`: lanes whose neighbour along axis a is a complete cell.
inline void drop_shared_faces(const LaneCorners& corners, const LaneInts (&upper)[3], LaneVec& hi) {
  for (int a = 0; a < 3; ++a) {
    LaneInts is_shared = upper[a];
    for (int n = 0; n < 8; ++n) {
      if ((n >> (2 - a)) & 1) is_shared &= corners.p[n][a] == hi[a];
    }
    hi[a] -= select(is_shared, broadcast(1), Lanes{});
  }
}

inline LaneVec bent(const LaneVec& xy, const LaneVec& yz, const LaneVec& xz, const LaneVec& xyz,
                    const LaneVec& eta) {
  const Lanes ab = eta.x * eta.y;
  return eta + xy * ab + yz * (eta.y * eta.z) + xz * (eta.x * eta.z) + xyz * (ab * eta.z);
}

}  // namespace supple
