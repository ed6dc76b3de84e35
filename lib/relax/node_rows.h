// Eight nodes of a row side by side, as vectors that GCC and Clang make of any machine's registers.
// Only for kernels: the types must not cross the border of a translation unit.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#include "lib/relax/brick_springs.h"
#include "lib/relax/link_table.h"
#include "volumes/base/simd.h"

namespace supple {

using NodeRow = Pack<double, 8>;
using FloatRow = Pack<float, 8>;
using Quad = Pack<float, 4>;
using MaskRow = Pack<std::int64_t, 8>;

inline NodeRow load(const double* values) {
  return load_pack<NodeRow>(values);
}

/// Eight links side by side.
struct LinkRow {
  NodeRow stiffness, upper, lower, yield;
};

/// Looks eight links up; limits become 2^-32 voxel.
inline LinkRow look_up(const LinkValues* table, const std::int32_t* entries) {
  Quad columns[2][4];
  for (int half = 0; half < 2; ++half) {
    Quad links[4];
    for (int n = 0; n < 4; ++n) std::memcpy(&links[n], table + entries[4 * half + n], sizeof(Quad));
    const Quad ab = __builtin_shufflevector(links[0], links[1], 0, 4, 1, 5);
    const Quad cd = __builtin_shufflevector(links[2], links[3], 0, 4, 1, 5);
    columns[half][0] = __builtin_shufflevector(ab, cd, 0, 1, 4, 5);
    columns[half][1] = __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
    const Quad last_ab = __builtin_shufflevector(links[0], links[1], 2, 6, 3, 7);
    const Quad last_cd = __builtin_shufflevector(links[2], links[3], 2, 6, 3, 7);
    columns[half][2] = __builtin_shufflevector(last_ab, last_cd, 0, 1, 4, 5);
    columns[half][3] = __builtin_shufflevector(last_ab, last_cd, 2, 3, 6, 7);
  }
  const auto widened = [&](int column) {
    const FloatRow row =
        __builtin_shufflevector(columns[0][column], columns[1][column], 0, 1, 2, 3, 4, 5, 6, 7);
    return __builtin_convertvector(row, NodeRow);
  };
  return {widened(0), widened(1) * kFinePerUnit, widened(2) * kFinePerUnit,
          widened(3) * kFinePerUnit};
}

inline NodeRow chosen(unsigned bits, NodeRow row) {
  constexpr MaskRow kBit = {1, 2, 4, 8, 16, 32, 64, 128};
  const MaskRow set = (MaskRow{} + std::int64_t(bits)) & kBit;
  return set != 0 ? row : NodeRow{};
}

/// Stiffness of a node without links, whose step is then 0 / kNoStiffness.
constexpr double kNoStiffness = 1e-300;

}  // namespace supple
