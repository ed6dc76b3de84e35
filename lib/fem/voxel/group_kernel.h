// K u of eight elements side by side, one per vector lane: the inner loop of the operator.
//
// A voxel: corners to Hadamard modes (72 additions), the blocks of element_matrix.h (171
// multiply-adds), and back. A coarse cell of one material: the same with the sum of its children's
// matrices (blocks of 12 and 9). A coarse cell of several materials: its 27 nodes by interpolation,
// eight voxels, and the transpose of the interpolation.
#pragma once

#include <array>

#include "lib/fem/voxel/element_groups.h"
#include "lib/fem/voxel/element_matrix.h"
#include "volumes/base/simd.h"

namespace supple {

template <class T>
using ElementLanes = AliasingPack<T, kGroup>;
template <class T>
using LanesAnywhere = PackAnywhere<T, kGroup>;

/// Eight points x y z x y z ... to a vector per component.
template <class T, class X>
inline void read_points(const X* from, ElementLanes<T>* to) {
  using V = ElementLanes<X>;
  const auto* parts = reinterpret_cast<const LanesAnywhere<X>*>(from);
  const V a = parts[0], b = parts[1], c = parts[2];
  const V x = __builtin_shufflevector(a, b, 0, 3, 6, 9, 12, 15, 0, 0);
  const V y = __builtin_shufflevector(a, b, 1, 4, 7, 10, 13, 0, 0, 0);
  const V z = __builtin_shufflevector(a, b, 2, 5, 8, 11, 14, 0, 0, 0);
  const V points[3] = {__builtin_shufflevector(x, c, 0, 1, 2, 3, 4, 5, 10, 13),
                       __builtin_shufflevector(y, c, 0, 1, 2, 3, 4, 8, 11, 14),
                       __builtin_shufflevector(z, c, 0, 1, 2, 3, 4, 9, 12, 15)};
  for (int n = 0; n < 3; ++n) to[n] = __builtin_convertvector(points[n], ElementLanes<T>);
}
/// Adds a vector per component times `sign` to eight points.
template <class T>
inline void add_points(const ElementLanes<T>& x, const ElementLanes<T>& y, const ElementLanes<T>& z,
                       T sign, T* to) {
  using V = ElementLanes<T>;
  auto* parts = reinterpret_cast<LanesAnywhere<T>*>(to);
  const V a = __builtin_shufflevector(x, y, 0, 8, 0, 1, 9, 0, 2, 10);
  const V b = __builtin_shufflevector(x, y, 0, 3, 11, 0, 4, 12, 0, 5);
  const V c = __builtin_shufflevector(x, y, 13, 0, 6, 14, 0, 7, 15, 0);
  parts[0] += sign * __builtin_shufflevector(a, z, 0, 1, 8, 3, 4, 9, 6, 7);
  parts[1] += sign * __builtin_shufflevector(b, z, 10, 1, 2, 11, 4, 5, 12, 7);
  parts[2] += sign * __builtin_shufflevector(c, z, 0, 13, 2, 3, 14, 5, 6, 15);
}

/// Material of a group of elements; no inertia where K stands alone.
template <class T>
struct LaneMaterial {
  ElementLanes<T> shear, bulk, inertia;
  bool has_inertia;
};

/// Blocks of K in modes; M and A as in element_matrix.h.
template <class T>
struct VoxelKernel {
  T shear_linear[9][9], shear_bilinear[9][9], shear_trilinear[3][3];
  T gradient[9];                                // sqrt(V) b in modes
  T bulk_bilinear[9][9], bulk_trilinear[3][3];  // zero under mean dilatation
  T mass[8];                                    // in the order of kModes
  bool is_pointwise;

  explicit VoxelKernel(const ElementMatrix& matrix);
};

/// The same of a coarse cell with eight children of one class.
template <class T>
struct AlikeKernel {
  T shear_odd[12][12], bulk_odd[12][12];  // linear and trilinear modes
  T shear_even[9][9], bulk_even[9][9];    // bilinear ones
  T mass[8];

  explicit AlikeKernel(const ElementMatrix& matrix);
};

/// Values at corners [3 corner + component] become modes [3 corner number of the mode + component].
template <class V>
inline void to_modes(V* x) {
#pragma GCC unroll 3
  for (int bit = 12; bit >= 3; bit /= 2) {
#pragma GCC unroll 24
    for (int n = 0; n < 24; ++n) {
      if ((n / 3 & bit / 3) != 0) continue;
      const V lo = x[n], hi = x[n + bit];
      x[n] = hi + lo;
      x[n + bit] = hi - lo;
    }
  }
}
/// Applies the transpose of that.
template <class V>
inline void from_modes(V* x) {
#pragma GCC unroll 3
  for (int bit = 12; bit >= 3; bit /= 2) {
#pragma GCC unroll 24
    for (int n = 0; n < 24; ++n) {
      if ((n / 3 & bit / 3) != 0) continue;
      const V sum = x[n], difference = x[n + bit];
      x[n] = sum - difference;
      x[n + bit] = sum + difference;
    }
  }
}

/// Row n of a block of the matrix times modes; `first` is the place of the block in kModes.
template <int Size, class T, class V>
inline V block_row(const T (&row)[Size], const V* x, int first) {
  V sum = x[3 * kModes[first]] * row[0];
#pragma GCC unroll 12
  for (int m = 1; m < Size; ++m) sum += x[3 * kModes[first + m / 3] + m % 3] * row[m];
  return sum;
}

/// Modes x become those of forces: y of K, of all modes but the constant ones, and c M x.
template <class T>
inline void take_modes(const LaneMaterial<T>& of, const T* mass, const ElementLanes<T>* y,
                       ElementLanes<T>* x) {
  if (!of.has_inertia) {
    x[0] = x[1] = x[2] = ElementLanes<T>{};
    for (int n = 0; n < 21; ++n) x[3 * kModes[1 + n / 3] + n % 3] = y[n];
    return;
  }
  for (int a = 0; a < 3; ++a) x[a] *= of.inertia * mass[0];
  for (int n = 0; n < 21; ++n) {
    ElementLanes<T>& value = x[3 * kModes[1 + n / 3] + n % 3];
    value = y[n] + of.inertia * mass[1 + n / 3] * value;
  }
}

/// x -> K x in place.
template <class T>
inline void apply_voxel(const VoxelKernel<T>& kernel, const LaneMaterial<T>& of,
                        ElementLanes<T>* x) {
  using V = ElementLanes<T>;
  const V shear = of.shear, bulk = of.bulk;
  to_modes(x);
  V y[21];
  V dilatation = block_row(kernel.gradient, x, 1);
  dilatation *= bulk;
#pragma GCC unroll 9
  for (int n = 0; n < 9; ++n) {
    y[n] = shear * block_row(kernel.shear_linear[n], x, 1) + dilatation * kernel.gradient[n];
    y[9 + n] = shear * block_row(kernel.shear_bilinear[n], x, 4);
    if (n < 3) y[18 + n] = shear * block_row(kernel.shear_trilinear[n], x, 7);
  }
  if (kernel.is_pointwise) {
    for (int n = 0; n < 9; ++n) {
      y[9 + n] += bulk * block_row(kernel.bulk_bilinear[n], x, 4);
      if (n < 3) y[18 + n] += bulk * block_row(kernel.bulk_trilinear[n], x, 7);
    }
  }
  take_modes(of, kernel.mass, y, x);
  from_modes(x);
}

template <class T>
inline void apply_alike(const AlikeKernel<T>& kernel, const LaneMaterial<T>& of,
                        ElementLanes<T>* x) {
  using V = ElementLanes<T>;
  const V shear = of.shear, bulk = of.bulk;
  to_modes(x);
  V odd[12], y[21];
  for (int n = 0; n < 12; ++n) odd[n] = x[3 * kModes[n < 9 ? 1 + n / 3 : 7] + n % 3];
  for (int n = 0; n < 12; ++n) {
    V by_shear = odd[0] * kernel.shear_odd[n][0], by_bulk = odd[0] * kernel.bulk_odd[n][0];
#pragma GCC unroll 11
    for (int m = 1; m < 12; ++m) {
      by_shear += odd[m] * kernel.shear_odd[n][m];
      by_bulk += odd[m] * kernel.bulk_odd[n][m];
    }
    y[n < 9 ? n : 9 + n] = shear * by_shear + bulk * by_bulk;
  }
  for (int n = 0; n < 9; ++n) {
    y[9 + n] =
        shear * block_row(kernel.shear_even[n], x, 4) + bulk * block_row(kernel.bulk_even[n], x, 4);
  }
  take_modes(of, kernel.mass, y, x);
  from_modes(x);
}

/// Children of a mixed cell: moduli, 0 where there is none, and held corners as bits 3 corner +
/// component; null: none are held.
template <class T>
struct ChildLanes {
  LaneMaterial<T> child[8];
  const std::uint32_t* held = nullptr;  // [child][lane]
};

constexpr int kCellStride[3] = {9, 3, 1};

/// Values at the 8 corners of a cell to its 27 nodes.
template <class V>
inline void interpolate_cell(const V* corners, V (*nodes)[3]) {
  for (int c = 0; c < 8; ++c) {
    V* node = nodes[2 * (9 * (c >> 2) + 3 * (c >> 1 & 1) + (c & 1))];
    for (int a = 0; a < 3; ++a) node[a] = corners[3 * c + a];
  }
  const auto halve = [&](int node, int stride) {
    for (int a = 0; a < 3; ++a) {
      nodes[node][a] = (nodes[node - stride][a] + nodes[node + stride][a]) * 0.5f;
    }
  };
  for (int n = 0; n < 4; ++n) halve(18 * (n >> 1) + 6 * (n & 1) + 1, 1);
  for (int n = 0; n < 6; ++n) halve(18 * (n / 3) + 3 + n % 3, 3);
  for (int n = 0; n < 9; ++n) halve(9 + n, 9);
}
/// Applies the transpose of that; overwrites `nodes`.
template <class V>
inline void restrict_cell(V (*nodes)[3], V* corners) {
  const auto share = [&](int node, int stride) {
    for (int a = 0; a < 3; ++a) {
      const V half = nodes[node][a] * 0.5f;
      nodes[node - stride][a] += half;
      nodes[node + stride][a] += half;
    }
  };
  for (int n = 0; n < 9; ++n) share(9 + n, 9);
  for (int n = 0; n < 6; ++n) share(18 * (n / 3) + 3 + n % 3, 3);
  for (int n = 0; n < 4; ++n) share(18 * (n >> 1) + 6 * (n & 1) + 1, 1);
  for (int c = 0; c < 8; ++c) {
    const V* node = nodes[2 * (9 * (c >> 2) + 3 * (c >> 1 & 1) + (c & 1))];
    for (int a = 0; a < 3; ++a) corners[3 * c + a] = node[a];
  }
}

/// Node of a cell's 27 that is a corner of a child.
constexpr int cell_node(int child, int corner) {
  return 9 * ((child >> 2) + (corner >> 2)) + 3 * ((child >> 1 & 1) + (corner >> 1 & 1)) +
         (child & 1) + (corner & 1);
}

/// Sets lanes whose value is held to zero.
template <class V>
inline void clear_held(const std::uint32_t* held, V* x) {
  for (int lane = 0; lane < kGroup; ++lane) {
    for (std::uint32_t bits = held[lane]; bits != 0; bits &= bits - 1) {
      x[__builtin_ctz(bits)][lane] = 0;
    }
  }
}

template <class T>
inline void apply_mixed(const VoxelKernel<T>& kernel, const ChildLanes<T>& children,
                        ElementLanes<T>* x) {
  using V = ElementLanes<T>;
  V values[27][3], forces[27][3];
  interpolate_cell(x, values);
  for (auto& force : forces) force[0] = force[1] = force[2] = V{};
  for (int child = 0; child < 8; ++child) {
    V local[24];
    for (int c = 0; c < 8; ++c) {
      for (int a = 0; a < 3; ++a) local[3 * c + a] = values[cell_node(child, c)][a];
    }
    if (children.held != nullptr) clear_held(children.held + kGroup * child, local);
    apply_voxel(kernel, children.child[child], local);
    if (children.held != nullptr) clear_held(children.held + kGroup * child, local);
    for (int c = 0; c < 8; ++c) {
      for (int a = 0; a < 3; ++a) forces[cell_node(child, c)][a] += local[3 * c + a];
    }
  }
  restrict_cell(forces, x);
}

}  // namespace supple
