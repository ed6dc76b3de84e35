#include "volumes/field/dense/resample.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "volumes/base/parallel.h"
#include "volumes/field/dense/grid_positions.h"
#include "volumes/field/dense/nearest_void.h"
#include "volumes/field/dense/unfolded_extension.h"
#include "volumes/field/ring_fill.h"
#include "volumes/field/split_offsets.h"
#include "volumes/grid/density_grid.h"
#include "volumes/grid/voxel_sets.h"

namespace supple {

VectorSlabs::VectorSlabs(const VectorBricks& field, const Vec3i& first, const Vec3i& dims,
                         std::function<bool(const Vec3i& origin)> leaves_out)
    : m_field(field),
      m_first(first),
      m_dims(dims),
      m_leaves_out(std::move(leaves_out)),
      m_slab((first.z >> 3) - 1) {}

const Vec3f* VectorSlabs::slice(int k) {
  const int z = m_first.z + k;
  if ((z >> 3) != m_slab) turn(z >> 3);
  return m_slices.data() + std::size_t(z & 7) * m_dims.x * m_dims.y;
}

void VectorSlabs::turn(int slab) {
  m_slab = slab;
  m_slices.resize(std::size_t(kBrickDim) * m_dims.x * m_dims.y);
  const Vec3i last = m_first + m_dims - Vec3i(1);
  parallel_for(m_first.y >> 3, (last.y >> 3) + 1, [&](int by) {
    for (int bx = m_first.x >> 3; bx <= last.x >> 3; ++bx) {
      turn_brick(Vec3i(bx, by, slab) * kBrickDim);
    }
  });
}

void VectorSlabs::turn_brick(const Vec3i& origin) {
  const Vec3f invalid(std::numeric_limits<float>::quiet_NaN());
  const std::int32_t b = m_leaves_out(origin) ? -1 : m_field.topology.find(origin);
  const Vec3f* const vectors = m_field.vectors.brick_or_zero(std::size_t(b));
  const BrickMask mask = b < 0 ? BrickMask{} : m_field.topology.mask(std::size_t(b));
  Vec3i lo, hi;  // of the brick's voxels inside the box
  for (int a = 0; a < 2; ++a) {
    lo[a] = std::max(0, m_first[a] - origin[a]);
    hi[a] = std::min(kBrickDim, m_first[a] + m_dims[a] - origin[a]);
  }
  const Vec3i in_box = origin - m_first;
  for (int k = 0; k < kBrickDim; ++k) {
    for (int j = lo.y; j < hi.y; ++j) {
      Vec3f* const row =
          m_slices.data() + (std::size_t(k) * m_dims.y + in_box.y + j) * m_dims.x + in_box.x;
      for (int i = lo.x; i < hi.x; ++i) {
        const int offset = (i << 6) | (j << 3) | k;
        row[i] = mask_test(mask, offset) ? vectors[offset] : invalid;
      }
    }
  }
}

namespace {

// How far beyond the source box `outside` leads, in voxels.
constexpr double kClearMargin = 10;
// Voxel coordinates beyond this are never looked up.
constexpr double kMaxVoxelCoordinate = 1e8;

bool is_on_lattice_range(const Vec3d& pos) {
  return std::max({std::abs(pos.x), std::abs(pos.y), std::abs(pos.z)}) < kMaxVoxelCoordinate;
}

/// Offsets that grid points without material read.
class VoidOffsets {
 public:
  VoidOffsets(const OffsetField& offsets, const BrickTopology& source, VoidMode mode,
              const BrickTopology* elements)
      : m_source(source), m_dims(offsets.geometry.dims()), m_mode(mode) {
    if (mode == VoidMode::extend) {
      m_extension = std::make_unique<UnfoldedExtension>(offsets, elements);
    }
    if (mode != VoidMode::nearest) return;
    // Source voxels that were left, and those that a reading between voxels may round to.
    const BrickTopology wanted = subtract(source, eroded(offsets.o.topology));
    m_nearest = nearest_void(source, wanted, m_dims, offsets.geometry.spacing_mm());
  }

  /// True if the extension replaces the field there, which would fold in the air.
  bool is_instead(const Vec3d& pos) const {
    return m_extension != nullptr && m_extension->is_replaced(pos);
  }
  Vec3d at(const Vec3d& pos) const {
    switch (m_mode) {
      case VoidMode::extend:
        return m_extension->sample(pos);
      case VoidMode::outside:
        return out_of_the_box(pos);
      default:
        return to_nearest_void(pos);
    }
  }

 private:
  Vec3d to_nearest_void(const Vec3d& pos) const {
    const IndexBox box{Vec3i(0), m_dims - Vec3i(1)};
    const Vec3i voxel = nearest_voxel(pos);
    if (!box.contains(voxel) || !touches(m_source, pos)) return Vec3d(0);
    Vec3f step(0);
    if (m_source.is_active(voxel) && !m_nearest.at(voxel, step)) return Vec3d(0);
    return Vec3d(voxel) + Vec3d(step) - pos;
  }
  /// Offset that leads out through the nearest face of the box.
  Vec3d out_of_the_box(const Vec3d& pos) const {
    Vec3d best(0);
    double shortest = -1;
    for (int a = 0; a < 3; ++a) {
      for (const double target : {-kClearMargin, m_dims[a] - 1 + kClearMargin}) {
        const double step = target - pos[a];
        const bool beyond = target < 0 ? step >= 0 : step <= 0;
        if (beyond) return Vec3d(0);
        if (shortest >= 0 && std::abs(step) >= shortest) continue;
        shortest = std::abs(step);
        best = Vec3d(0);
        best[a] = step;
      }
    }
    return best;
  }

  const BrickTopology& m_source;
  Vec3i m_dims;
  VoidMode m_mode;
  VectorBricks m_nearest;
  std::unique_ptr<UnfoldedExtension> m_extension;
};

}  // namespace

namespace {

/// True when the points of `grid` are voxels of the frame's lattice, with the same axes; `first` is
/// then that of point 0.
bool is_same_lattice(const Geometry& grid, const GridPositions& positions, Vec3i& first) {
  const Vec3d origin = positions.at(0, 0, 0);
  if (!is_on_lattice_range(origin)) return false;
  first = nearest_voxel(origin);
  const Vec3i last = grid.dims() - Vec3i(1);
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3i p((corner & 1) * last.x, ((corner >> 1) & 1) * last.y, (corner >> 2) * last.z);
    if (positions.at(p.x, p.y, p.z) != Vec3d(first + p)) return false;
  }
  return true;
}

}  // namespace

VectorSliceSource dense_offsets(const OffsetField& offsets, const BrickTopology& source,
                                const Geometry& grid, VoidMode mode,
                                const BrickTopology* elements) {
  const GridPositions positions(grid, offsets.geometry);
  const auto elsewhere = std::make_shared<const VoidOffsets>(offsets, source, mode, elements);
  const Vec3i& dims = grid.dims();
  const auto sampled = [&offsets, positions, elsewhere](int i, int j, int k) {
    const Vec3d pos = positions.at(i, j, k);
    Vec3d o(0);
    if (!is_on_lattice_range(pos)) return o;
    if (elsewhere->is_instead(pos) || !offsets.sample(pos, o)) o = elsewhere->at(pos);
    return o;
  };
  Vec3i first(0);
  std::shared_ptr<VectorSlabs> slabs;
  if (is_same_lattice(grid, positions, first)) {
    slabs = std::make_shared<VectorSlabs>(
        offsets.o, first, dims, [split = offsets.split](const Vec3i& origin) {
          return split != nullptr && split->bricks().find(origin) >= 0;
        });
  }
  return [&offsets, sampled, slabs, dims, elsewhere, first](int k, Vec3f* out) {
    const Vec3f* const known = slabs == nullptr ? nullptr : slabs->slice(k);
    parallel_for(dims.y, [&](int j) {
      for (int i = 0; i < dims.x; ++i) {
        const std::size_t n = std::size_t(j) * dims.x + i;
        const bool is_known = known != nullptr && !std::isnan(known[n].x) &&
                              !elsewhere->is_instead(Vec3d(first + Vec3i(i, j, k)));
        const Vec3d o = is_known ? Vec3d(known[n]) : sampled(i, j, k);
        out[n] = Vec3f(offsets.geometry.world_vector_from_index(o));
      }
    });
  };
}

VectorSliceSource dense_displacement(const Displacement& extended) {
  const Vec3i dims = extended.geometry.dims();
  const auto slabs =
      std::make_shared<VectorSlabs>(extended.u, Vec3i(0), dims, [](const Vec3i&) { return false; });
  return [&extended, slabs, dims](int k, Vec3f* out) {
    const Vec3f* const known = slabs->slice(k);
    parallel_for(dims.y, [&](int j) {
      for (std::size_t n = std::size_t(j) * dims.x; n < std::size_t(j + 1) * dims.x; ++n) {
        const Vec3d u = std::isnan(known[n].x) ? Vec3d(0) : Vec3d(known[n]);
        out[n] = Vec3f(extended.geometry.world_vector_from_index(u));
      }
    });
  };
}

namespace {

/// Vectors of the stored bricks of `first`, and of `second` where that has none, in mm; none when
/// these are more than a quarter of the box.
std::optional<VectorBricks> in_millimetres(const VectorBricks& first, const VectorBricks& second,
                                           const Geometry& geometry) {
  std::vector<Vec3i> origins;
  for (const VectorBricks* field : {&first, &second}) {
    for (std::size_t b = 0; b < field->topology.brick_count(); ++b) {
      if (field->vectors.brick(b) != nullptr) origins.push_back(field->topology.origin(b));
    }
  }
  sort_unique(origins);
  constexpr std::int64_t kLargestPart = 4;
  if (std::int64_t(origins.size()) * kBrickVoxels * kLargestPart > geometry.voxel_count()) {
    return std::nullopt;
  }
  BrickMask all;
  all.fill(~std::uint64_t(0));
  std::vector<BrickMask> masks(origins.size(), all);
  VectorBricks result{BrickTopology(origins, std::move(masks)), BrickVectors(origins.size())};
  result.vectors.touch_all();
  parallel_for(origins.size(), [&](std::size_t b) {
    Vec3f* const out = result.vectors.touch(b);
    for (int n = 0; n < kBrickVoxels; ++n) {
      const Vec3i voxel = result.topology.origin(b) + brick_local(n);
      Vec3f vector(0);
      if (!first.at(voxel, vector)) second.at(voxel, vector);
      out[n] = Vec3f(geometry.world_vector_from_index(Vec3d(vector)));
    }
  });
  return result;
}

}  // namespace

std::optional<VectorBricks> sparse_offsets(const OffsetField& offsets,
                                           const BrickTopology& source) {
  if (offsets.split != nullptr) return std::nullopt;
  const Geometry& geometry = offsets.geometry;
  const BrickTopology wanted = subtract(source, offsets.o.topology);
  const VectorBricks left = nearest_void(source, wanted, geometry.dims(), geometry.spacing_mm());
  return in_millimetres(offsets.o, left, geometry);
}

std::optional<VectorBricks> sparse_displacement(const Displacement& extended) {
  return in_millimetres(extended.u, {}, extended.geometry);
}

ScalarSliceSource dense_resampled(const OffsetField& offsets, const DensityGrid& density,
                                  const Geometry& grid, float fill) {
  const auto trilinear = [&density, fill](const Vec3d& index) {
    return sample_trilinear(density, index, fill);
  };
  return dense_resampled(offsets, trilinear, grid, fill);
}

ScalarSliceSource dense_resampled(const OffsetField& offsets, const SourceDensity& density,
                                  const Geometry& grid, float fill) {
  const GridPositions positions(grid, offsets.geometry);
  const Vec3i& dims = grid.dims();
  return [&offsets, density, positions, dims, fill](int k, float* out) {
    parallel_for(dims.y, [&](int j) {
      for (int i = 0; i < dims.x; ++i) {
        Vec3d source;
        const bool is_seen = offsets.source_of(positions.at(i, j, k), source);
        out[std::size_t(j) * dims.x + i] = is_seen ? density(source) : fill;
      }
    });
  };
}

std::int64_t count_outside(const Displacement& material, const Geometry& grid) {
  const BrickTopology& bricks = material.u.topology;
  std::int64_t count = 0;
  const bool is_own = grid == material.geometry;
  for (std::size_t b = 0; b < bricks.brick_count(); ++b) {
    if (is_own && material.u.vectors.brick(b) == nullptr) continue;  // at rest, and so inside
    for_each_active(bricks.mask(b), [&](int offset) {
      const Vec3d moved = Vec3d(bricks.origin(b) + brick_local(offset)) +
                          Vec3d(material.u.vectors.brick_or_zero(b)[offset]);
      const Vec3d pos = grid.index_from_world(material.geometry.world_from_index(moved));
      bool inside = true;
      for (int a = 0; a < 3; ++a) {
        inside = inside && pos[a] >= -0.5 - kNodeSnap && pos[a] <= grid.dims()[a] - 0.5 + kNodeSnap;
      }
      count += !inside;
    });
  }
  return count;
}

Geometry with_margin(const Geometry& geometry, double margin_mm) {
  const Vec3d spacing = geometry.spacing_mm();
  Vec3i dims = geometry.dims(), margin;
  for (int a = 0; a < 3; ++a) {
    const double voxels = std::ceil(margin_mm / spacing[a] - kNodeSnap);
    if (!(voxels >= 0 && voxels < kMaxVoxelCoordinate)) {
      throw InputError(
          {"", "margin", number_text(margin_mm) + " mm", "a length from 0 mm to 10^8 voxels"});
    }
    margin[a] = int(voxels);
    dims[a] += 2 * margin[a];
  }
  return {dims, geometry.world_from_index(-Vec3d(margin)), geometry.axes_mm()};
}

}  // namespace supple
