#include "lib/relax/cell_sweep.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "volumes/base/simd.h"
#include "volumes/grid/cell.h"

namespace supple {

namespace {

/// Four elements of one row, every other one.
using Lane = Pack<double, 4>;
using MaskLane = Pack<std::int64_t, 4>;
using CellQuad = Pack<float, 4>;

inline Lane load(const double* values) {
  return load_pack<Lane>(values);
}

struct Lane3 {
  Lane c[3];
};
inline Lane3 operator-(const Lane3& a, const Lane3& b) {
  return {{a.c[0] - b.c[0], a.c[1] - b.c[1], a.c[2] - b.c[2]}};
}
inline Lane3 operator+(const Lane3& a, const Lane3& b) {
  return {{a.c[0] + b.c[0], a.c[1] + b.c[1], a.c[2] + b.c[2]}};
}
inline Lane3 cross(const Lane3& a, const Lane3& b) {
  return {{a.c[1] * b.c[2] - a.c[2] * b.c[1], a.c[2] * b.c[0] - a.c[0] * b.c[2],
           a.c[0] * b.c[1] - a.c[1] * b.c[0]}};
}
inline Lane determinant(const Lane3& a, const Lane3& b, const Lane3& d) {
  const Lane3 normal = cross(b, d);
  return a.c[0] * normal.c[0] + a.c[1] * normal.c[1] + a.c[2] * normal.c[2];
}

/// Offset in a CellBrick of the element (di, dj) rows on.
constexpr int row_step(int di, int dj) {
  return (10 * di + dj) * CellBrick::kRowLength;
}

/// Volumes beyond rest of four cells, whose lowest corners begin at `low` and their ends along k at
/// `high` (hexahedron_volume has the formula).
inline Lane excess_of(const CellBrick& brick, int low, int high) {
  // The way from corner `from` to corner `to`, numbered as Hexahedron; both are constants here.
  const auto way = [&](int to, int from) {
    const auto place = [&](int corner) {
      return ((corner & 1) != 0 ? high : low) + row_step(corner >> 2, corner >> 1 & 1);
    };
    Lane3 way_to;
    for (int c = 0; c < 3; ++c) {
      const int steps = (to >> (2 - c) & 1) - (from >> (2 - c) & 1);
      way_to.c[c] = load(brick.offsets[c] + place(to)) - load(brick.offsets[c] + place(from)) +
                    double(steps) * kFineVoxel;
    }
    return way_to;
  };
  const Lane3 far_i = way(7, 4), far_j = way(7, 2), far_k = way(7, 1), near = way(3, 0),
              diagonal_ij = way(6, 0), diagonal_ik = way(5, 0);
  return (determinant(far_i + near, far_j, diagonal_ij) +
          determinant(near, far_j + diagonal_ik, far_k) +
          determinant(far_i, diagonal_ik, far_k + diagonal_ij)) *
             (1.0 / 12) -
         kFineCell;
}

/// Four links side by side, limits in 2^-32 voxel.
struct LinkLane {
  Lane stiffness, upper, lower, yield;
};

inline LinkLane look_up(const LinkValues* table, const std::int32_t* entries) {
  CellQuad links[4];
  for (int n = 0; n < 4; ++n) std::memcpy(&links[n], table + entries[n], sizeof(CellQuad));
  const CellQuad ab = __builtin_shufflevector(links[0], links[1], 0, 4, 1, 5);
  const CellQuad cd = __builtin_shufflevector(links[2], links[3], 0, 4, 1, 5);
  const CellQuad last_ab = __builtin_shufflevector(links[0], links[1], 2, 6, 3, 7);
  const CellQuad last_cd = __builtin_shufflevector(links[2], links[3], 2, 6, 3, 7);
  const auto widened = [](CellQuad column) { return __builtin_convertvector(column, Lane); };
  return {widened(__builtin_shufflevector(ab, cd, 0, 1, 4, 5)),
          widened(__builtin_shufflevector(ab, cd, 2, 3, 6, 7)) * kFinePerUnit,
          widened(__builtin_shufflevector(last_ab, last_cd, 0, 1, 4, 5)) * kFinePerUnit,
          widened(__builtin_shufflevector(last_ab, last_cd, 2, 3, 6, 7)) * kFinePerUnit};
}

/// Takes the values in BrickSprings or BrickRest of the links of elements (i, j, k), k + 2, k + 4
/// and k + 6, upwards or downwards along an axis.
template <class Values, class T>
inline void take_links(const Values& values, int axis, bool up, int i, int j, int k, T* out) {
  if (axis == 2) {
    const T* row = values.k[i][j];
    const int first = k - !up;
    out[0] = first < 0 ? values.low_k[i][j] : row[first];
    for (int n = 1; n < 4; ++n) out[n] = row[first + 2 * n];
    return;
  }
  const T* row = axis == 0 ? values.i[i + up][j] + k : values.j[i][j + up] + k;
  for (int n = 0; n < 4; ++n) out[n] = row[2 * n];
}

/// Stretch of four links beyond their rest stretches.
inline Lane beyond_rest(const BrickRest& rest, int axis, bool up, int i, int j, int k,
                        Lane stretch) {
  double values[4];
  take_links(rest, axis, up, i, j, k, values);
  return stretch - load(values);
}
inline Lane pulled(const LinkLane& link, Lane beyond) {
  return lanes_max(-link.yield, lanes_min(link.yield, beyond));
}

/// Pull of the links of four elements in one coordinate, and how far these may rise and sink.
struct CellForces {
  Lane force{}, stiffness{};
  Lane rise = Lane{} + HUGE_VAL, sink = Lane{} + HUGE_VAL;
};

/// Place of four elements: (i, j, k), k + 2, k + 4 and k + 6.
struct CellRun {
  int i, j, k;        // of the first
  int node;           // in a row of offsets
  const int* beside;  // CellBrick::kPlace
  int along(int axis, bool up) const {
    if (axis == 2) return node - beside[1] + beside[up ? 2 : 0];
    return node + (up ? 1 : -1) * (axis == 0 ? row_step(1, 0) : row_step(0, 1));
  }
};

template <bool kPlastic>
inline void ask_links(const CellBrick& brick, const BrickSprings& links, const LinkTables& tables,
                      const CellSweep& sweep, const CellRun& at, CellForces (&asks)[3]) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const bool up : {false, true}) {
      std::int32_t entries[4];
      take_links(links, axis, up, at.i, at.j, at.k, entries);
      for (std::size_t c = 0; c < 3; ++c) {
        const LinkLane link = look_up(tables[c]->row(axis), entries);
        // Offset of the other end less that of this one; a link downwards stretches as it shrinks.
        const Lane apart =
            load(brick.offsets[c] + at.along(axis, up)) - load(brick.offsets[c] + at.node);
        Lane pull = apart;
        if constexpr (kPlastic) {
          const Lane beyond =
              beyond_rest(*sweep.rest[c], axis, up, at.i, at.j, at.k, up ? apart : -apart);
          pull = up ? pulled(link, beyond) : -pulled(link, beyond);
        }
        CellForces& ask = asks[c];
        ask.force += link.stiffness * pull;
        ask.stiffness += link.stiffness;
        ask.rise = lanes_min(ask.rise, (up ? link.lower : link.upper) + apart);
        ask.sink = lanes_min(ask.sink, (up ? link.upper : link.lower) - apart);
      }
    }
  }
}

/// Volume gradients of the eight cells around four elements, each times its root_share; cell 4 i +
/// 2 j + k is the one on the upper side where i, j or k is 1. Zero where there is no cell.
inline void find_gradients(const CellBrick& brick, const CellRun& at, const int (&cells)[8],
                           Lane3 (&out)[8]) {
  Lane3 here;
  for (int c = 0; c < 3; ++c) here.c[c] = load(brick.offsets[c] + at.node);
  // The way from here to the element one step along the axes that are not 0.
  const auto way = [&](int di, int dj, int dk) {
    const int place = at.node + row_step(di, dj) - at.beside[1] + at.beside[dk + 1];
    const int steps[3] = {di, dj, dk};
    Lane3 to;
    for (int c = 0; c < 3; ++c) {
      to.c[c] = load(brick.offsets[c] + place) - here.c[c] + double(steps[c]) * kFineVoxel;
    }
    return to;
  };
  const Lane3 along_i[2] = {way(-1, 0, 0), way(1, 0, 0)};
  const Lane3 along_j[2] = {way(0, -1, 0), way(0, 1, 0)};
  const Lane3 along_k[2] = {way(0, 0, -1), way(0, 0, 1)};
  const auto face = [](const Lane3& e1, const Lane3& across, const Lane3& e2) {
    return cross(e1 - e2, across) + cross(e1, e2);
  };
  Lane3 faces[3][2][2];  // i-j, j-k, k-i
  for (int a = 0; a < 2; ++a) {
    for (int b = 0; b < 2; ++b) {
      const int u = 2 * a - 1, v = 2 * b - 1;
      faces[0][a][b] = face(along_i[a], way(u, v, 0), along_j[b]);
      faces[1][a][b] = face(along_j[a], way(0, u, v), along_k[b]);
      faces[2][a][b] = face(along_k[a], way(v, 0, u), along_i[b]);
    }
  }
  for (int n = 0; n < 8; ++n) {
    const auto [i, j, k] = cell_corner(n);
    const bool is_right_handed = ((i + j + k) & 1) != 0;
    const Lane factor =
        load(brick.root_share + cells[n]) * (is_right_handed ? -1.0 / 12 : 1.0 / 12);
    const Lane3 sum = faces[0][i][j] + faces[1][j][k] + faces[2][k][i];
    for (int c = 0; c < 3; ++c) out[n].c[c] = sum.c[c] * factor;
  }
}

/// Finds where the eight cells around four elements begin, as find_gradients() numbers them.
inline void find_places(const CellRun& at, int (&cells)[8]) {
  for (int n = 0; n < 8; ++n) {
    const int i = at.i - 1 + (n >> 2), j = at.j - 1 + (n >> 1 & 1);
    cells[n] = CellBrick::cell_row(i, j) + at.beside[n & 1];
  }
}

inline Lane chosen(unsigned bits, Lane lane) {
  const MaskLane set = (MaskLane{} + std::int64_t(bits)) & MaskLane{1, 4, 16, 64};
  return set != 0 ? lane : Lane{};
}

template <bool kPlastic>
Lane step_four(CellBrick& brick, const BrickSprings& links, const LinkTables& tables,
               const CellSweep& sweep, const CellRun& at, const unsigned (&free)[3]) {
  CellForces asks[3];
  ask_links<kPlastic>(brick, links, tables, sweep, at, asks);
  int cells[8];
  find_places(at, cells);
  Lane3 gradients[8];
  find_gradients(brick, at, cells, gradients);
  Lane excess[8];
  for (int n = 0; n < 8; ++n) excess[n] = load(brick.excess + cells[n]);

  Lane largest{};
  for (std::size_t c = 0; c < 3; ++c) {
    if (free[c] == 0) continue;
    Lane pressure{}, squares{};
    for (int n = 0; n < 8; ++n) {
      pressure += gradients[n].c[c] * excess[n];
      squares += gradients[n].c[c] * gradients[n].c[c];
    }
    const CellForces& ask = asks[c];
    const Lane force = ask.force - sweep.weight[c] * pressure;
    const Lane of_cells = sweep.weight[c] * squares;
    const Lane relaxation = damped_relaxation(sweep.relaxation, ask.stiffness, of_cells);
    const Lane wanted = force * relaxation / (ask.stiffness + of_cells + kNoStiffness);
    Lane rise = ask.rise, sink = ask.sink;
    double* const place = brick.offsets[c] + at.node;
    const Lane here = load(place);
    if (sweep.bounds != nullptr) {
      for (int lane = 0; lane < 4; ++lane) {
        const int offset = 64 * at.i + 8 * at.j + at.k + 2 * lane;
        rise[lane] =
            std::min(rise[lane], std::max(0.0, sweep.bounds->most[c][offset] - here[lane]));
        sink[lane] =
            std::min(sink[lane], std::max(0.0, here[lane] - sweep.bounds->least[c][offset]));
      }
    }
    const Lane step = chosen(free[c], truncated(lanes_max(-sink, lanes_min(rise, wanted))));
    store_pack(place, here + step);
    for (int n = 0; n < 8; ++n) excess[n] += gradients[n].c[c] * step;
    largest = lanes_max(largest, lanes_max(step, -step));
  }
  for (int n = 0; n < 8; ++n) store_pack(brick.excess + cells[n], excess[n]);
  return largest;
}

template <bool kPlastic>
double sweep_all(CellBrick& brick, const BrickSprings& links, const LinkTables& tables,
                 const CellSweep& sweep) {
  Lane largest{};
  for (int colour = 0; colour < 8; ++colour) {
    const int k = colour & 1;
    for (int i = colour >> 2; i < 8; i += 2) {
      for (int j = colour >> 1 & 1; j < 8; j += 2) {
        unsigned free[3], any = 0;
        for (std::size_t c = 0; c < 3; ++c) {
          free[c] = unsigned(sweep.free[c][std::size_t(i)] >> (8 * j + k)) & 0x55;
          any |= free[c];
        }
        if (any == 0) continue;
        const int* beside = CellBrick::kPlace[k];
        const CellRun at{i, j, k, CellBrick::node_row(i, j) + beside[1], beside};
        largest = lanes_max(largest, step_four<kPlastic>(brick, links, tables, sweep, at, free));
      }
    }
  }
  return std::max(std::max(largest[0], largest[1]), std::max(largest[2], largest[3]));
}

}  // namespace

void find_excess(CellBrick& brick) {
  for (int i = -1; i < 8; ++i) {
    for (int j = -1; j < 8; ++j) {
      const int nodes = CellBrick::node_row(i, j), cells = CellBrick::cell_row(i, j);
      // The cells at k = 0, 2, 4, 6; at -1, 1, 3, 5; and at 1, 3, 5, 7.
      constexpr int kEven = 0, kOdd = CellBrick::kFirstOdd;
      const auto find = [&](int low, int high) {
        store_pack(brick.excess + cells + low, load(brick.root_share + cells + low) *
                                                   excess_of(brick, nodes + low, nodes + high));
      };
      find(kEven, kOdd + 1);
      find(kOdd, kEven);
      find(kOdd + 1, kEven + 1);
      brick.excess[cells + CellBrick::place(8)] = 0;
    }
  }
}

double sweep_cells(CellBrick& brick, const BrickSprings& links, const LinkTables& tables,
                   const CellSweep& sweep) {
  return sweep.rest[0] != nullptr ? sweep_all<true>(brick, links, tables, sweep)
                                  : sweep_all<false>(brick, links, tables, sweep);
}

CellEnergy energy_of_cells(const CellBrick& brick, const BrickSprings& links,
                           const LinkTables& tables, const std::array<const BrickRest*, 3>& rest) {
  Lane sums[3] = {}, squares{};
  for (int i = 0; i < 8; ++i) {
    for (int j = 0; j < 8; ++j) {
      for (int k = 0; k < 2; ++k) {
        const int* beside = CellBrick::kPlace[k];
        const CellRun at{i, j, k, CellBrick::node_row(i, j) + beside[1], beside};
        const Lane excess = load(brick.excess + CellBrick::cell_row(i, j) + beside[1]);
        squares += excess * excess;
        for (int axis = 0; axis < 3; ++axis) {
          std::int32_t entries[4];
          take_links(links, axis, true, i, j, k, entries);
          for (std::size_t c = 0; c < 3; ++c) {
            const LinkLane link = look_up(tables[c]->row(axis), entries);
            const Lane stretch =
                load(brick.offsets[c] + at.along(axis, true)) - load(brick.offsets[c] + at.node);
            Lane pull = stretch, work = stretch;
            if (rest[c] != nullptr) {
              const Lane beyond = beyond_rest(*rest[c], axis, true, i, j, k, stretch);
              pull = pulled(link, beyond);
              work = beyond + beyond - pull;
            }
            sums[c] += link.stiffness * pull * work;
          }
        }
      }
    }
  }
  const auto total = [](const Lane& lane) { return (lane[0] + lane[1]) + (lane[2] + lane[3]); };
  CellEnergy energy;
  for (std::size_t c = 0; c < 3; ++c) energy.links[c] = total(sums[c]);
  energy.excess_squared = total(squares);
  return energy;
}

}  // namespace supple
