#include <algorithm>
#include <array>
#include <cmath>

#include "volumes/io/transform/transform_chain.h"

namespace supple {

namespace {

/// Weights of a tensor product along the three axes, and the grid point that the first ones belong
/// to.
struct Stencil {
  std::array<int, 3> first;
  std::array<std::array<double, 4>, 3> weights;
};

/// Vectors on a grid; sums of them.
class GridVectors {
 public:
  GridVectors(const Geometry& grid, std::vector<Vec3d> vectors)
      : m_grid(grid), m_vectors(std::move(vectors)) {}

  const Geometry& grid() const { return m_grid; }

  Vec3d sum(const Stencil& stencil, int width) const {
    const Vec3i& dims = m_grid.dims();
    Vec3d total(0);
    for (int k = 0; k < width; ++k) {
      for (int j = 0; j < width; ++j) {
        const double weight =
            stencil.weights[2][std::size_t(k)] * stencil.weights[1][std::size_t(j)];
        const std::size_t row =
            (std::size_t(clamped(stencil, 2, k)) * dims.y + std::size_t(clamped(stencil, 1, j))) *
            std::size_t(dims.x);
        for (int i = 0; i < width; ++i) {
          total += m_vectors[row + std::size_t(clamped(stencil, 0, i))] *
                   (weight * stencil.weights[0][std::size_t(i)]);
        }
      }
    }
    return total;
  }

 private:
  int clamped(const Stencil& stencil, int axis, int n) const {
    return std::clamp(stencil.first[std::size_t(axis)] + n, 0, m_grid.dims()[axis] - 1);
  }

  Geometry m_grid;
  std::vector<Vec3d> m_vectors;
};

class AffinePoints : public PointMap {
 public:
  explicit AffinePoints(const Geometry& map) : m_map(map) {}
  Vec3d at(const Vec3d& lps_mm) const override { return m_map.world_from_index(lps_mm); }

 private:
  Geometry m_map;
};

class FieldPoints : public PointMap {
 public:
  explicit FieldPoints(GridVectors vectors) : m_vectors(std::move(vectors)) {}

  Vec3d at(const Vec3d& lps_mm) const override {
    const Vec3d index = m_vectors.grid().index_from_world(lps_mm);
    Stencil stencil{};
    for (int a = 0; a < 3; ++a) {
      if (!(index[a] >= -0.5 && index[a] < m_vectors.grid().dims()[a] - 0.5)) return lps_mm;
      const auto axis = std::size_t(a);
      stencil.first[axis] = int(std::floor(index[a]));
      const double behind = index[a] - stencil.first[axis];
      stencil.weights[axis] = {1 - behind, behind};
    }
    return lps_mm + m_vectors.sum(stencil, 2);
  }

 private:
  GridVectors m_vectors;
};

/// The uniform B-splines that reach a place, `t` behind the first knot of its interval.
std::array<double, 4> bspline_weights(int order, double t) {
  const double s = 1 - t;
  if (order == 1) return {s, t};
  if (order == 2) return {s * s / 2, 0.5 + t * s, t * t / 2};
  return {s * s * s / 6, 2.0 / 3 - t * t * (2 - t) / 2, 2.0 / 3 - s * s * (2 - s) / 2,
          t * t * t / 6};
}

class BsplinePoints : public PointMap {
 public:
  BsplinePoints(GridVectors coefficients, int order)
      : m_coefficients(std::move(coefficients)), m_order(order) {}

  Vec3d at(const Vec3d& lps_mm) const override {
    const Vec3d index = m_coefficients.grid().index_from_world(lps_mm);
    const double rim = 0.5 * (m_order - 1);
    constexpr double kTolerance = 1e-9;  // a grid often ends where an image does
    Stencil stencil{};
    for (int a = 0; a < 3; ++a) {
      const int intervals = m_coefficients.grid().dims()[a] - m_order;
      const double from_first = index[a] - rim;
      if (!(from_first >= -kTolerance && from_first <= intervals + kTolerance)) return lps_mm;
      const auto axis = std::size_t(a);
      stencil.first[axis] = std::clamp(int(std::floor(from_first)), 0, std::max(0, intervals - 1));
      stencil.weights[axis] = bspline_weights(m_order, from_first - stencil.first[axis]);
    }
    return lps_mm + m_coefficients.sum(stencil, m_order + 1);
  }

 private:
  GridVectors m_coefficients;
  int m_order;
};

/// A chain as one map: what it adds is relative to where it begins.
class ChainPoints : public PointMap {
 public:
  explicit ChainPoints(std::vector<TransformChain::Link> links) : m_chain{std::move(links), {}} {}

  Vec3d at(const Vec3d& lps_mm) const override { return m_chain.at(lps_mm); }

 private:
  TransformChain m_chain;
};

}  // namespace

std::unique_ptr<PointMap> affine_map(const Geometry& map) {
  return std::make_unique<AffinePoints>(map);
}

std::unique_ptr<PointMap> field_map(const Geometry& grid, std::vector<Vec3d> vectors_mm) {
  return std::make_unique<FieldPoints>(GridVectors(grid, std::move(vectors_mm)));
}

std::unique_ptr<PointMap> bspline_map(const Geometry& grid, int order,
                                      std::vector<Vec3d> coefficients_mm) {
  return std::make_unique<BsplinePoints>(GridVectors(grid, std::move(coefficients_mm)), order);
}

Vec3d TransformChain::at(const Vec3d& lps_mm) const {
  Vec3d place = lps_mm;
  for (const Link& link : links) {
    place = link.adds ? place + link.map->at(lps_mm) - lps_mm : link.map->at(place);
  }
  return place;
}

TransformChain compose(std::vector<TransformChain> chains) {
  TransformChain all;
  for (auto chain = chains.rbegin(); chain != chains.rend(); ++chain) {
    if (!all.grid) all.grid = chain->grid;
    all.links.push_back({std::make_unique<ChainPoints>(std::move(chain->links)), false});
  }
  return all;
}

}  // namespace supple
