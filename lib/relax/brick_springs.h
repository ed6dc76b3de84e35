// The links of one brick and to its six neighbours, as entries of a LinkTable; and a brick of any
// values with the faces of its neighbours around it.
#pragma once

#include <cstdint>

#include "lib/body/body.h"
#include "lib/body/brick_faces.h"
#include "lib/body/slot_set.h"

namespace supple {

/// Offsets in 2^-32 voxel: integers below 2^47, exact as double, and so are their differences. A
/// node that has come to rest on a fraction of 2^-16 voxel does not lose it (design.md section 3).
constexpr double kFinePerUnit = 65536.0;

/// 8^3 values and one layer around them, edges and corners left out: rows of 8 along k at a
/// multiple of 64 bytes, the layer's values just before and after.
template <class T>
struct PaddedBrick {
  static constexpr int kRowStride = 16;
  static constexpr int kFirst = 8;  // of a row
  alignas(64) T values[100 * kRowStride + kFirst];

  /// Row (i, j), each from -1 to 8; [-1] and [8] are the layer along k.
  T* row(int i, int j) { return values + (10 * (i + 1) + j + 1) * kRowStride + kFirst; }
  const T* row(int i, int j) const { return values + (10 * (i + 1) + j + 1) * kRowStride + kFirst; }
};

/// Fills `out`: `source_of(brick)` gives a function that reads that brick's value at an offset, and
/// `absent` stands beyond the body.
template <class T, class SourceOf>
void pad_brick(const BrickTopology& elements, std::size_t b, T absent, SourceOf&& source_of,
               PaddedBrick<T>& out) {
  const auto own = source_of(b);
  for (int i = 0; i < 8; ++i) {
    for (int j = 0; j < 8; ++j) {
      T* row = out.row(i, j);
      for (int k = 0; k < 8; ++k) row[k] = own(64 * i + 8 * j + k);
    }
  }
  for (int face = 0; face < 6; ++face) {
    const std::int32_t other = elements.neighbour(b, face);
    const int outside = is_high_face(face) ? 8 : -1, layer = is_high_face(face) ? 0 : 7;
    const int axis = axis_of_face(face);
    const auto put = [&](auto&& value) {
      for (int m = 0; m < 8; ++m) {
        T* row = axis == 0 ? out.row(outside, m) : out.row(m, outside);
        for (int n = 0; n < 8; ++n) {
          if (axis == 2) {
            out.row(m, n)[outside] = value(64 * m + 8 * n + layer);
          } else {
            row[n] = value(axis == 0 ? 64 * layer + 8 * m + n : 64 * m + 8 * layer + n);
          }
        }
      }
    };
    if (other >= 0) {
      put(source_of(std::size_t(other)));
    } else {
      put([&](int) { return absent; });
    }
  }
}

/// Entries of a LinkTable. Index 0 of i, j and low_k is the link that enters the brick.
struct BrickSprings {
  alignas(32) std::int32_t i[9][8][8];
  alignas(32) std::int32_t j[8][9][8];
  alignas(32) std::int32_t k[8][8][8];  // each voxel's link to the next
  std::int32_t low_k[8][8];
};

/// Rest stretches of the same links in 2^-32 voxel.
struct BrickRest {
  alignas(64) double i[9][8][8];
  alignas(64) double j[8][9][8];
  alignas(64) double k[8][8][8];
  double low_k[8][8];
};

/// Reads rest stretches of a brick's links in one coordinate; `rest` gives them per axis of link.
void find_rest(const BrickTopology& elements, const std::array<const BrickValues*, 3>& rest,
               std::size_t b, BrickRest& out);

/// Finds the links of a brick and those that enter it; `missing` is the entry of an absent link.
void find_links(const Body& body, std::size_t b, std::int32_t missing, BrickSprings& links);

}  // namespace supple
