#include "volumes/field/inversion/lane_solver.h"

#include <algorithm>
#include <cmath>

#include "volumes/field/inversion/lane_cells.h"

namespace supple {

namespace {

constexpr float kRegular = 1e-3f;
// Newton stops at this part of the tolerance.
constexpr float kNewtonPart = 0.12f;
constexpr int kMaxSteps = 8;
constexpr float kLost = 1.5f;
// Cells whose smallest det F at a corner is below, or with a longer edge, are declined.
constexpr float kMinDet = 0.02f;
constexpr float kMaxEdge = 6;
// Coefficients of the bent part: Bxy, Byz, Bxz, Bxyz, and the bound on it.
constexpr int kBendCoefficients = 13;
constexpr int kQueue = 1024;

/// A whole voxel near the displacement of the brick's first cell.
Vec3f shift_of(const SourceCells& cells) {
  for (int word = 0; word < 8; ++word) {
    if (cells.mask[word] == 0) continue;
    const Vec3i c = brick_local(64 * word + __builtin_ctzll(cells.mask[word]));
    const Vec3f u = cells.u(c.x, c.y, c.z);
    return {std::round(u.x), std::round(u.y), std::round(u.z)};
  }
  return Vec3f(0);
}

}  // namespace

/// Coefficients per cell, and pairs of a cell and a node that wait until sixteen can be solved.
struct LaneSolver::Scratch {
  alignas(64) float bend[kBendCoefficients][kBrickVoxels];
  alignas(64) std::int32_t injective[kBrickVoxels];
  alignas(64) float t[3][kQueue + kLanes];
  alignas(64) float node[3][kQueue + kLanes];  // relative to the cell and the shift
  std::uint16_t cell[kQueue + kLanes];
  int queued = 0;

  Vec3i origin;
  Vec3f shift;
  float tolerance;
  CellResults* results;

  void keep(const LaneCells& cell_lanes, int first);
  void enqueue(const LaneCells& cell_lanes, const LaneInts& active, LaneVec lo, const LaneVec& hi,
               int first);
  void append(unsigned bits, const LaneVec& target, const LaneVec& at, int first);
  void solve_queue(bool all);
  void solve_lanes(int start, int count);
  void emit(unsigned inside, unsigned doubtful, int start, const LaneVec& offset);
};

void LaneSolver::Scratch::keep(const LaneCells& c, int first) {
  const LaneVec* parts[4] = {&c.xy, &c.yz, &c.xz, &c.xyz};
  for (int n = 0; n < 4; ++n) {
    for (int a = 0; a < 3; ++a) {
      std::memcpy(&bend[3 * n + a][first], &(*parts[n])[a], sizeof(Lanes));
    }
  }
  std::memcpy(&bend[12][first], &c.bend, sizeof(Lanes));
  std::memcpy(&injective[first], &c.injective, sizeof(Lanes));
}

/// Queues the nodes whose target lies in the box of the preconditioned image.
void LaneSolver::Scratch::enqueue(const LaneCells& c, const LaneInts& active, LaneVec lo,
                                  const LaneVec& hi, int first) {
  const LaneVec step{c.rows[0].z, c.rows[1].z, c.rows[2].z};
  LaneVec at;
  at.x = lo.x;
  for (LaneInts in_x = active & (at.x <= hi.x); bits_of_lanes(in_x) != 0;
       at.x += 1.0f, in_x = active & (at.x <= hi.x)) {
    at.y = lo.y;
    for (LaneInts in_y = in_x & (at.y <= hi.y); bits_of_lanes(in_y) != 0;
         at.y += 1.0f, in_y = in_x & (at.y <= hi.y)) {
      at.z = lo.z;
      LaneVec target = precondition(c, at - c.center);
      for (LaneInts in_z = in_y & (at.z <= hi.z); bits_of_lanes(in_z) != 0;
           at.z += 1.0f, in_z = in_y & (at.z <= hi.z), target = target + step) {
        const LaneVec beyond = magnitude(target - c.middle) - c.half;
        const unsigned reached = bits_of_lanes(in_z & (max_component(beyond) <= 0.0f));
        if (reached != 0) append(reached, target, at, first);
      }
    }
  }
}

void LaneSolver::Scratch::append(unsigned bits, const LaneVec& target, const LaneVec& at,
                                 int first) {
  for (; bits != 0; bits &= bits - 1) {
    const int lane = __builtin_ctz(bits);
    for (int a = 0; a < 3; ++a) {
      t[a][queued] = target[a][lane];
      node[a][queued] = at[a][lane];
    }
    cell[queued++] = std::uint16_t(first + lane);
  }
  if (queued >= kQueue) solve_queue(false);
}

void LaneSolver::Scratch::solve_queue(bool all) {
  int start = 0;
  for (; start + kLanes <= queued; start += kLanes) solve_lanes(start, kLanes);
  const int left = queued - start;
  if (all && left > 0) {
    for (int n = queued; n < start + kLanes; ++n) {
      for (int a = 0; a < 3; ++a) t[a][n] = node[a][n] = 0;
      cell[n] = cell[start];
    }
    solve_lanes(start, left);
  } else {
    for (int n = 0; n < left; ++n) {
      for (int a = 0; a < 3; ++a) {
        t[a][n] = t[a][start + n];
        node[a][n] = node[a][start + n];
      }
      cell[n] = cell[start + n];
    }
  }
  queued = all ? 0 : left;
}

/// Newton for the pairs start … start + 15 of the queue, of which the first `count` are real.
void LaneSolver::Scratch::solve_lanes(int start, int count) {
  Lanes b[kBendCoefficients];
  LaneInts is_injective;
  for (int k = 0; k < kBendCoefficients; ++k) {
    for (int n = 0; n < kLanes; ++n) b[k][n] = bend[k][cell[start + n]];
  }
  for (int n = 0; n < kLanes; ++n) is_injective[n] = injective[cell[start + n]];
  const LaneVec xy{b[0], b[1], b[2]}, yz{b[3], b[4], b[5]}, xz{b[6], b[7], b[8]},
      xyz{b[9], b[10], b[11]};
  const LaneVec target{load_lanes(&t[0][start]), load_lanes(&t[1][start]),
                       load_lanes(&t[2][start])};

  LaneVec eta{clamp(target.x, 0.5f), clamp(target.y, 0.5f), clamp(target.z, 0.5f)};
  LaneInts done{}, failed{};
  for (int step = 0; step < kMaxSteps; ++step) {
    const LaneVec residual = bent(xy, yz, xz, xyz, eta) - target;
    done |= max_component(magnitude(residual)) <= tolerance;
    LaneVec jx = xy * eta.y + xz * eta.z + xyz * (eta.y * eta.z);
    LaneVec jy = xy * eta.x + yz * eta.z + xyz * (eta.x * eta.z);
    LaneVec jz = yz * eta.y + xz * eta.x + xyz * (eta.x * eta.y);
    jx.x += 1.0f;
    jy.y += 1.0f;
    jz.z += 1.0f;
    const LaneVec jyz = cross(jy, jz);
    const Lanes volume = dot(jx, jyz);
    failed |= ~done & (magnitude(volume) < kRegular);
    const LaneInts moving = ~done & ~failed;
    if (bits_of_lanes(moving) == 0) break;
    const Lanes inverse = 1.0f / volume;
    const LaneVec xr = cross(jx, residual);
    const LaneVec change{dot(residual, jyz) * inverse, dot(xr, jz) * inverse,
                         -dot(xr, jy) * inverse};
    for (int a = 0; a < 3; ++a) {
      eta[a] = select(moving, clamp(eta[a] - change[a], 2), eta[a]);
    }
    // The residual after a step is of second order in it; often that saves another look.
    const Lanes size = max_component(magnitude(change));
    done |= moving & (size < 1.0f) & (b[12] * size * size <= tolerance);
    // A solution further away would not be taken; whether there is one inside stays open.
    failed |= ~done & (max_component(magnitude(eta)) > kLost);
  }

  const Lanes reached = max_component(magnitude(eta));
  const LaneInts inside = done & (reached <= 0.5f + kEdge);
  const LaneInts outside = done & ~inside & is_injective & (reached <= kInjectiveHalf);
  LaneVec offset;
  for (int a = 0; a < 3; ++a) {
    offset[a] = clamp(eta[a], 0.5f) + 0.5f - (load_lanes(&node[a][start]) + shift[a]);
  }
  const unsigned real = (1u << count) - 1;
  emit(bits_of_lanes(inside) & real, ~bits_of_lanes(inside | outside) & real, start, offset);
}

void LaneSolver::Scratch::emit(unsigned inside, unsigned doubtful, int start,
                               const LaneVec& offset) {
  const auto node_of = [&](int lane, const Vec3i& at) {
    const int n = start + lane;
    return at +
           Vec3i(int(node[0][n] + shift.x), int(node[1][n] + shift.y), int(node[2][n] + shift.z));
  };
  for (; inside != 0; inside &= inside - 1) {
    const int lane = __builtin_ctz(inside);
    results->hits.push_back({node_of(lane, origin + brick_local(cell[start + lane])),
                             {offset.x[lane], offset.y[lane], offset.z[lane]}});
  }
  for (; doubtful != 0; doubtful &= doubtful - 1) {
    const int lane = __builtin_ctz(doubtful);
    const Vec3i at = origin + brick_local(cell[start + lane]);
    results->doubts.push_back({node_of(lane, at), at});
  }
}

LaneSolver::LaneSolver() : m_scratch(std::make_unique<Scratch>()) {}
LaneSolver::~LaneSolver() = default;

BrickMask LaneSolver::solve(const SourceCells& cells, const BrickMask& tissue_cells,
                            double tolerance_voxels, CellResults& results, double& min_det) {
  Scratch& scratch = *m_scratch;
  scratch.origin = cells.origin;
  scratch.shift = shift_of(cells);
  scratch.tolerance = kNewtonPart * float(tolerance_voxels) / kMaxEdge;
  scratch.results = &results;
  Lanes smallest = broadcast(1);
  BrickMask declined{};
  for (int x = 0; x < kBrickDim; ++x) {
    for (int y = 0; y < kBrickDim; y += 2) {
      const unsigned bits = unsigned(cells.mask[x] >> (8 * y)) & 0xffff;
      if (bits == 0) continue;
      const LaneCorners corners = load_corners(cells, scratch.shift, x, y);
      const LaneEdges edges = edges_of(corners);
      const Lanes det = min_det_of(edges);
      const LaneInts active = lanes_of_bits(bits) & ~corners.translated & (det > kMinDet) &
                              (longest_component(edges) < kMaxEdge);
      const unsigned taken = bits_of_lanes(active);
      declined[x] |= std::uint64_t(bits & ~taken) << (8 * y);
      if (taken == 0) continue;
      const LaneInts is_tissue = lanes_of_bits(unsigned(tissue_cells[x] >> (8 * y)) & 0xffff);
      smallest = smaller(smallest, select(active & is_tissue, det, broadcast(1)));

      const LaneCells lanes = set_up(corners);
      const int first = 64 * x + 8 * y;
      const unsigned suspects = bits_of_lanes(active & ~lanes.regular);
      results.suspects[x] |= std::uint64_t(suspects) << (8 * y);
      scratch.keep(lanes, first);
      LaneVec lo, hi;
      find_nodes(corners, lo, hi);
      const unsigned next_x = x + 1 < kBrickDim ? unsigned(cells.mask[x + 1] >> (8 * y)) : 0;
      const unsigned next_y = unsigned(cells.mask[x] >> (8 * y) >> 8);
      const LaneInts upper[3] = {lanes_of_bits(next_x), lanes_of_bits(next_y),
                                 lanes_of_bits((bits >> 1) & 0x7f7f)};
      drop_shared_faces(corners, upper, hi);
      scratch.enqueue(lanes, active, lo, hi, first);
    }
  }
  scratch.solve_queue(true);
  for (int n = 0; n < kLanes; ++n) min_det = std::min(min_det, double(smallest[n]));
  return declined;
}

}  // namespace supple
