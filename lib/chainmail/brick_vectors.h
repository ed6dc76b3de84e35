// Vectors of levels and costs for the kernels of the block engine, as wide as the machine's.
#pragma once

#include <cstdint>
#include <utility>

#include "lib/chainmail/link_costs.h"
#include "volumes/base/simd.h"
#include "volumes/grid/brick_topology.h"

namespace supple {

/// One row of a brick, and as many rows as the machine's vectors hold.
using SlackRow = AliasingPack<Level, 8>;
using SignedRow = AliasingPack<std::int32_t, 8>;
#ifdef __AVX512F__
using Rows = AliasingPack<Level, 16>;
using SignedRows = AliasingPack<std::int32_t, 16>;
#else
using Rows = SlackRow;
using SignedRows = SignedRow;
#endif
constexpr int kRowLanes = 8;
constexpr int kLanes = sizeof(Rows) / sizeof(Level);
constexpr int kVectors = kBrickVoxels / kLanes;
constexpr int kPlaneVectors = 64 / kLanes;

/// The larger levels, compared as signed ones, which compilers know as one instruction.
inline SlackRow larger(SlackRow a, SlackRow b) {
  const SignedRow x = SignedRow(a), y = SignedRow(b);
  return SlackRow(x > y ? x : y);
}
#ifdef __AVX512F__
inline Rows larger(Rows a, Rows b) {
  const SignedRows x = SignedRows(a), y = SignedRows(b);
  return Rows(x > y ? x : y);
}
#endif

template <class Vector>
inline bool any_set(Vector v) {
  Level all = 0;
  for (std::size_t lane = 0; lane < sizeof(Vector) / sizeof(Level); ++lane) all |= v[lane];
  return all != 0;
}

/// Every row moved by `Step` lanes towards higher k (lower when negative); the ends repeat.
constexpr int source_lane(int lane, int step) {
  const int within = lane % kRowLanes - step;
  return lane / kRowLanes * kRowLanes + (within < 0            ? 0
                                         : within >= kRowLanes ? kRowLanes - 1
                                                               : within);
}
template <int Step, std::size_t... Lane>
inline Rows moved(Rows v, std::index_sequence<Lane...>) {
  return __builtin_shufflevector(v, v, source_lane(int(Lane), Step)...);
}
template <int Step>
inline Rows moved(Rows v) {
  return moved<Step>(v, std::make_index_sequence<kLanes>());
}

}  // namespace supple
