#include "volumes/grid/b_spline.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "volumes/base/parallel.h"

namespace supple {

namespace {

/// Pole of the filter that turns densities into coefficients.
const double kSplinePole = std::sqrt(3.0) - 2;
/// Terms of a power of the pole that count: 0.268^28 is 1e-16.
constexpr int kPoleTerms = 28;
/// Voxels beyond the active ones that hold the background: 0.268^3 of a step is left there.
constexpr int kRingsAround = 3;

/// Turns densities of a row into coefficients, in place; the row is mirrored at both ends.
void filter_row(std::vector<double>& row) {
  const double z = kSplinePole;
  const int n = int(row.size());
  if (n < 2) return;
  // The sum over all mirrored densities before the first, then recursion forwards.
  const int terms = std::min(n - 1, kPoleTerms);
  double first = row[0], power = z;
  if (n - 1 <= kPoleTerms) {
    const double round = std::pow(z, 2 * n - 2);
    for (int k = 1; k < n - 1; ++k, power *= z) {
      first += (power + round / power) * row[std::size_t(k)];
    }
    first = (first + power * row[std::size_t(n - 1)]) / (1 - round);
  } else {
    for (int k = 1; k <= terms; ++k, power *= z) first += power * row[std::size_t(k)];
  }
  row[0] = 6 * first;
  for (std::size_t k = 1; k < row.size(); ++k) row[k] = 6 * row[k] + z * row[k - 1];
  const std::size_t last = row.size() - 1;
  row[last] = z / (z * z - 1) * (row[last] + z * row[last - 1]);
  for (std::size_t k = last; k-- > 0;) row[k] = z * (row[k + 1] - row[k]);
}

/// Filters every run of active, finite voxels along an axis in a column of bricks, in ascending
/// order.
void filter_column(const BrickTopology& where, const std::vector<std::size_t>& column, int axis,
                   std::vector<float>& nodes) {
  std::vector<double> row;
  std::vector<float*> places;
  const auto end_run = [&] {
    filter_row(row);
    for (std::size_t n = 0; n < row.size(); ++n) *places[n] = float(row[n]);
    row.clear();
    places.clear();
  };
  for (int line = 0; line < 64; ++line) {
    int next = 0;  // coordinate at which a run would go on
    for (const std::size_t b : column) {
      for (int n = 0; n < kBrickDim; ++n) {
        Vec3i local(0);
        local[axis] = n;
        local[(axis + 1) % 3] = line % 8;
        local[(axis + 2) % 3] = line / 8;
        const int offset = brick_offset(local);
        float& node = nodes[b * kBrickVoxels + std::size_t(offset)];
        const int coordinate = where.origin(b)[axis] + n;
        const bool is_known = mask_test(where.mask(b), offset) && std::isfinite(node);
        if (!is_known || coordinate != next) end_run();
        next = coordinate + 1;
        if (!is_known) continue;
        row.push_back(double(node));
        places.push_back(&node);
      }
    }
    end_run();
  }
}

int mirrored(int voxel, int dim) {
  if (dim == 1) return 0;
  if (voxel < 0) voxel = -voxel;
  if (voxel >= dim) voxel = 2 * dim - 2 - voxel;
  return std::clamp(voxel, 0, dim - 1);
}

std::vector<const float*> values_under(const BrickTopology& where, const DensityGrid& grid) {
  std::vector<const float*> values(where.brick_count());
  for (std::size_t b = 0; b < values.size(); ++b) {
    const std::int32_t from = grid.bricks().find(where.origin(b));
    if (from >= 0) values[b] = grid.values(std::size_t(from));
  }
  return values;
}

std::vector<float> copied(const std::vector<const float*>& values, float background) {
  std::vector<float> nodes(values.size() * kBrickVoxels, background);
  for (std::size_t b = 0; b < values.size(); ++b) {
    if (values[b] != nullptr) {
      std::copy_n(values[b], kBrickVoxels, &nodes[b * kBrickVoxels]);
    }
  }
  return nodes;
}

}  // namespace

std::array<double, 4> b_spline_weights(double t) {
  const double s = 1 - t;
  return {s * s * s / 6, 2.0 / 3 - t * t * (1 - t / 2), 2.0 / 3 - s * s * (1 - s / 2),
          t * t * t / 6};
}

double cardinal_spline(double distance) {
  // The coefficients of a single 1 are -6 z / (1 - z^2) z^|n|.
  const double z = kSplinePole, at_one = -6 * z / (1 - z * z);
  const double low = std::floor(distance);
  const std::array<double, 4> weights = b_spline_weights(distance - low);
  double sum = 0;
  for (std::size_t n = 0; n < 4; ++n) {
    sum += weights[n] * at_one * std::pow(z, std::abs(low + double(n) - 1));
  }
  return sum;
}

std::vector<float> b_spline_coefficients(const BrickTopology& where,
                                         const std::vector<const float*>& values,
                                         float background) {
  std::vector<float> nodes = copied(values, background);
  for (int axis = 0; axis < 3; ++axis) {
    std::map<std::pair<int, int>, std::vector<std::size_t>> columns;
    for (std::size_t b = 0; b < where.brick_count(); ++b) {
      const Vec3i& origin = where.origin(b);
      columns[{origin[(axis + 1) % 3], origin[(axis + 2) % 3]}].push_back(b);
    }
    std::vector<std::vector<std::size_t>*> all;
    for (auto& [place, column] : columns) all.push_back(&column);
    parallel_for(all.size(), [&](std::size_t n) { filter_column(where, *all[n], axis, nodes); });
  }
  return nodes;
}

SplineDensity::SplineDensity(const DensityGrid& grid, const Vec3i& dims, bool interpolates)
    : m_dims(dims),
      m_where(dilate_inside(grid.bricks(), kRingsAround, dims)),
      m_background(grid.background()) {
  const std::vector<const float*> values = values_under(m_where, grid);
  m_nodes = interpolates ? b_spline_coefficients(m_where, values, m_background)
                         : copied(values, m_background);
}

float SplineDensity::node(Vec3i voxel) const {
  for (int a = 0; a < 3; ++a) voxel[a] = mirrored(voxel[a], m_dims[a]);
  const std::int32_t b = m_where.find(voxel);
  if (b < 0) return m_background;
  return m_nodes[std::size_t(b) * kBrickVoxels + std::size_t(brick_offset(voxel))];
}

double SplineDensity::at(const Vec3d& index) const {
  Vec3i low;
  std::array<std::array<double, 4>, 3> weights;
  for (int a = 0; a < 3; ++a) {
    low[a] = int(std::floor(index[a]));
    weights[std::size_t(a)] = b_spline_weights(index[a] - low[a]);
  }
  double sum = 0;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      const double across = weights[0][std::size_t(i)] * weights[1][std::size_t(j)];
      for (int k = 0; k < 4; ++k) {
        sum += across * weights[2][std::size_t(k)] * double(node(low + Vec3i(i - 1, j - 1, k - 1)));
      }
    }
  }
  return sum;
}

}  // namespace supple
