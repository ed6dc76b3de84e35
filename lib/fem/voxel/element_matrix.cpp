#include "lib/fem/voxel/element_matrix.h"

#include <cmath>

namespace supple {

namespace {

/// Rows of the inverse of the matrix whose columns are the axes.
std::array<Vec3d, 3> inverse_rows(const std::array<Vec3d, 3>& axes, double& determinant) {
  determinant = axes[0].dot(axes[1].cross(axes[2]));
  return {axes[1].cross(axes[2]) / determinant, axes[2].cross(axes[0]) / determinant,
          axes[0].cross(axes[1]) / determinant};
}

double sign(int corner, int axis) {
  return (corner >> (2 - axis) & 1) != 0 ? 1 : -1;
}

double hadamard(int mode, int corner) {
  double product = 1;
  for (int axis = 0; axis < 3; ++axis) {
    if ((mode >> (2 - axis) & 1) != 0) product *= sign(corner, axis);
  }
  return product;
}

/// Adds weight * (2 dev e(n, a) : dev e(m, b)) and weight * tr e(n, a) tr e(m, b), where e(n, a) is
/// the strain of corner n moving along a.
void add_point(const std::array<Vec3d, 8>& g, double weight, ElementMatrix& out) {
  for (int n = 0; n < 8; ++n) {
    for (int m = 0; m < 8; ++m) {
      const double gg = g[n].dot(g[m]);
      for (int a = 0; a < 3; ++a) {
        for (int b = 0; b < 3; ++b) {
          // 2 e:e = delta_ab g_n.g_m + g_n[b] g_m[a];  2/3 tr tr is the volumetric part of it.
          const double full = (a == b ? gg : 0) + g[n][b] * g[m][a];
          const double trace = g[n][a] * g[m][b];
          out.shear[3 * n + a][3 * m + b] += weight * (full - 2.0 / 3 * trace);
          out.bulk[3 * n + a][3 * m + b] += weight * trace;
        }
      }
    }
  }
}

}  // namespace

std::array<Vec3d, 8> shape_gradients(const std::array<Vec3d, 3>& axes_mm, const Vec3d& reference) {
  double determinant;
  const std::array<Vec3d, 3> inverse = inverse_rows(axes_mm, determinant);
  std::array<Vec3d, 8> gradients;
  for (int n = 0; n < 8; ++n) {
    gradients[n] = Vec3d(0);
    for (int axis = 0; axis < 3; ++axis) {
      // N = product of (1 + s x)/2, and one step of the index is two of the reference cube.
      double slope = sign(n, axis);
      for (int other = 0; other < 3; ++other) {
        if (other != axis) slope *= (1 + sign(n, other) * reference[other]) / 2;
      }
      gradients[n] += inverse[axis] * slope;
    }
  }
  return gradients;
}

GaussGeometry::GaussGeometry(const std::array<Vec3d, 3>& axes_mm, Dilatation dilatation)
    : is_pointwise(dilatation == Dilatation::pointwise) {
  double determinant;
  const std::array<Vec3d, 3> inverse = inverse_rows(axes_mm, determinant);
  volume_mm3 = std::abs(determinant);
  // An eighth for the modes, and two units of the reference cube per voxel.
  for (int axis = 0; axis < 3; ++axis) {
    for (int d = 0; d < 3; ++d) slope[axis][d] = inverse[axis][d] / 4;
  }
}

ElementMatrix element_matrix(const std::array<Vec3d, 3>& axes_mm, Dilatation dilatation) {
  ElementMatrix out{};
  double determinant;
  inverse_rows(axes_mm, determinant);
  out.volume_mm3 = std::abs(determinant);
  out.dilatation = dilatation;
  const double gauss = 1 / std::sqrt(3.0);
  for (int point = 0; point < 8; ++point) {
    const Vec3d at(sign(point, 0) * gauss, sign(point, 1) * gauss, sign(point, 2) * gauss);
    add_point(shape_gradients(axes_mm, at), out.volume_mm3 / 8, out);
  }
  for (int n = 0; n < 8; ++n) {
    for (int m = 0; m < 8; ++m) {
      // Along each axis 1/3 for the same end, 1/6 for the other one.
      const int other_ends = __builtin_popcount(unsigned(n ^ m));
      for (int a = 0; a < 3; ++a) {
        out.mass[3 * n + a][3 * m + a] = out.volume_mm3 / 27 / (1 << other_ends);
      }
    }
  }
  const std::array<Vec3d, 8> mean = shape_gradients(axes_mm, Vec3d(0));
  for (int n = 0; n < 24; ++n) out.gradient[n] = mean[n / 3][n % 3];
  if (dilatation == Dilatation::mean) {
    for (int n = 0; n < 24; ++n) {
      for (int m = 0; m < 24; ++m) {
        out.bulk[n][m] = out.volume_mm3 * out.gradient[n] * out.gradient[m];
      }
    }
  }
  return out;
}

Matrix24 in_modes(const Matrix24& matrix) {
  Matrix24 half{}, out{};
  for (int mode = 0; mode < 8; ++mode) {
    for (int n = 0; n < 8; ++n) {
      const double h = hadamard(kModes[mode], n);
      for (int a = 0; a < 3; ++a) {
        for (int m = 0; m < 24; ++m) half[3 * mode + a][m] += h * matrix[3 * n + a][m];
      }
    }
  }
  for (int mode = 0; mode < 8; ++mode) {
    for (int m = 0; m < 8; ++m) {
      const double h = hadamard(kModes[mode], m) / 64;
      for (int row = 0; row < 24; ++row) {
        for (int b = 0; b < 3; ++b) out[row][3 * mode + b] += h * half[row][3 * m + b];
      }
    }
  }
  return out;
}

std::array<double, 8> corner_weights(const Vec3d& fraction) {
  std::array<double, 8> weights;
  for (int n = 0; n < 8; ++n) {
    weights[n] = 1;
    for (int axis = 0; axis < 3; ++axis) {
      weights[n] *= sign(n, axis) > 0 ? fraction[axis] : 1 - fraction[axis];
    }
  }
  return weights;
}

Matrix24 on_parent(const Matrix24& child_matrix, int child) {
  std::array<std::array<double, 8>, 8> weights;  // [child corner][parent corner]
  for (int n = 0; n < 8; ++n) {
    Vec3d fraction;
    for (int axis = 0; axis < 3; ++axis) {
      fraction[axis] = ((child >> (2 - axis) & 1) + (n >> (2 - axis) & 1)) / 2.0;
    }
    weights[n] = corner_weights(fraction);
  }
  Matrix24 half{}, out{};
  for (int n = 0; n < 8; ++n) {
    for (int parent = 0; parent < 8; ++parent) {
      const double w = weights[n][parent];
      if (w == 0) continue;
      for (int a = 0; a < 3; ++a) {
        for (int m = 0; m < 24; ++m) half[3 * parent + a][m] += w * child_matrix[3 * n + a][m];
      }
    }
  }
  for (int m = 0; m < 8; ++m) {
    for (int parent = 0; parent < 8; ++parent) {
      const double w = weights[m][parent];
      if (w == 0) continue;
      for (int row = 0; row < 24; ++row) {
        for (int b = 0; b < 3; ++b) out[row][3 * parent + b] += w * half[row][3 * m + b];
      }
    }
  }
  return out;
}

}  // namespace supple
