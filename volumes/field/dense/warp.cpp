#include "volumes/field/dense/warp.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <sstream>

#include "volumes/base/parallel.h"
#include "volumes/field/dense/grid_positions.h"

namespace supple {

WarpVectors::WarpVectors(std::size_t count)
    : m_count(count), m_runs((count + kBrickVoxels - 1) / kBrickVoxels) {}

WarpVectors::WarpVectors(const std::vector<Vec3f>& all) : WarpVectors(all.size()) {
  put(0, all.data(), all.size());
}

std::vector<Vec3f> WarpVectors::all() const {
  std::vector<Vec3f> vectors(m_count);
  for (std::size_t n = 0; n < m_count; ++n) vectors[n] = m_runs.at(n);
  return vectors;
}

void WarpVectors::put(std::size_t first, const Vec3f* vectors, std::size_t count) {
  for (std::size_t done = 0; done < count;) {
    const std::size_t run = (first + done) / kBrickVoxels, at = (first + done) % kBrickVoxels;
    const std::size_t part = std::min(count - done, std::size_t(kBrickVoxels) - at);
    const Vec3f* const from = vectors + done;
    const bool is_still = std::memcmp(from, kZeroBrickOf<Vec3f>, part * sizeof(Vec3f)) == 0;
    if (!is_still || m_runs.brick(run) != nullptr) std::copy_n(from, part, m_runs.touch(run) + at);
    done += part;
  }
}

namespace {

constexpr double kMaxBricks = 1 << 24;
// Lattice coordinates beyond this are no voxels.
constexpr double kMaxLatticeCoordinate = 1e8;

/// Offsets of single voxels of the source lattice.
class WarpSampler {
 public:
  WarpSampler(const Warp& warp, const Geometry& source)
      : m_warp(warp), m_source(source), m_positions(source, warp.geometry) {}

  /// Offset in voxels of the source; false where the voxel is void.
  bool offset_at(const Vec3i& voxel, Vec3f& offset) const {
    Vec3d vector_mm;
    if (!sample(m_positions.at(voxel.x, voxel.y, voxel.z), vector_mm)) return false;
    const bool is_still = vector_mm == Vec3d(0);
    const Vec3d o = is_still ? Vec3d(0) : m_source.index_vector_from_world(vector_mm);
    for (int a = 0; a < 3; ++a) {
      const double target = voxel[a] + o[a];
      if (!(target > -1 && target < m_source.dims()[a])) return false;
    }
    offset = Vec3f(o);
    return true;
  }

 private:
  /// Trilinear; false outside the grid points' hull. Corners without weight are not read.
  bool sample(const Vec3d& pos, Vec3d& vector) const {
    const Vec3i& dims = m_warp.geometry.dims();
    Vec3i lo;
    Vec3d weight[2];
    for (int a = 0; a < 3; ++a) {
      if (!(pos[a] >= 0 && pos[a] <= dims[a] - 1)) return false;
      lo[a] = int(pos[a]);
      weight[1][a] = pos[a] - lo[a];
      weight[0][a] = 1 - weight[1][a];
    }
    const auto at = [&](int x, int y, int z) {
      const std::size_t row = (std::size_t(lo.z) + z) * dims.y + lo.y + y;
      return Vec3d(m_warp.vectors[row * dims.x + lo.x + x]);
    };
    if (weight[1] == Vec3d(0)) {
      vector = at(0, 0, 0);
      return true;
    }
    vector = Vec3d(0);
    for (int corner = 0; corner < 8; ++corner) {
      const int x = corner & 1, y = (corner >> 1) & 1, z = corner >> 2;
      const double w = weight[x].x * weight[y].y * weight[z].z;
      if (w == 0) continue;
      vector += at(x, y, z) * w;
    }
    return true;
  }

  const Warp& m_warp;
  const Geometry& m_source;
  GridPositions m_positions;
};

/// Bricks of the source lattice, lowest and highest, in steps of bricks, that hold the warp's grid.
IndexBox spanned_bricks(const Warp& warp, const Geometry& source) {
  const GridPositions positions(warp.geometry, source);
  Vec3d lo(kMaxLatticeCoordinate), hi(-kMaxLatticeCoordinate);
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3i last = warp.geometry.dims() - Vec3i(1);
    const Vec3d pos =
        positions.at((corner & 1) * last.x, ((corner >> 1) & 1) * last.y, (corner >> 2) * last.z);
    for (int a = 0; a < 3; ++a) {
      lo[a] = std::min(lo[a], pos[a]);
      hi[a] = std::max(hi[a], pos[a]);
    }
  }
  IndexBox bricks;
  double count = 1;
  bool in_range = true;
  for (int a = 0; a < 3; ++a) {
    in_range = in_range && lo[a] > -kMaxLatticeCoordinate && hi[a] < kMaxLatticeCoordinate;
    if (!in_range) break;
    bricks.lo[a] = int(std::floor(lo[a])) >> 3;
    bricks.hi[a] = int(std::ceil(hi[a])) >> 3;
    count *= bricks.hi[a] - bricks.lo[a] + 1;
  }
  if (in_range && count <= kMaxBricks) return bricks;
  std::ostringstream found;
  found << "a grid over voxels " << lo << " to " << hi << " of the volume";
  throw InputError({warp.path, "grid", found.str(), "a grid of about the volume's size"});
}

/// Voxels with an offset, and the bricks in which some offset is not 0.
struct Sampled {
  BrickTopology valid;
  std::vector<std::size_t> moving;
};

Sampled find_valid(const WarpSampler& sampler, const IndexBox& bricks, Progress* progress) {
  const Vec3i count = bricks.hi - bricks.lo + Vec3i(1);
  const std::size_t layer = std::size_t(count.y) * count.z;
  std::vector<Vec3i> origins(layer * count.x);
  std::vector<BrickMask> masks(layer * count.x, BrickMask{});
  std::vector<std::uint8_t> moves(layer * count.x, 0);
  for (int x = 0; x < count.x; ++x) {
    report(progress, double(x) / count.x);
    parallel_for(layer, [&](std::size_t n) {
      const Vec3i step(x, int(n / count.z), int(n % count.z));
      const Vec3i origin = (bricks.lo + step) * kBrickDim;
      BrickMask& mask = masks[x * layer + n];
      bool is_moving = false;
      Vec3f offset;
      for (int local = 0; local < kBrickVoxels; ++local) {
        if (!sampler.offset_at(origin + brick_local(local), offset)) continue;
        mask_set(mask, local);
        is_moving = is_moving || offset != Vec3f(0);
      }
      origins[x * layer + n] = origin;
      moves[x * layer + n] = std::uint8_t(is_moving);
    });
  }
  Sampled sampled{BrickTopology(std::move(origins), std::move(masks)), {}};
  for (std::size_t b = 0; b < sampled.valid.brick_count(); ++b) {
    const Vec3i step = sampled.valid.origin(b) / kBrickDim - bricks.lo;
    const std::size_t n = (std::size_t(step.x) * count.y + step.y) * count.z + step.z;
    if (moves[n]) sampled.moving.push_back(b);
  }
  return sampled;
}

}  // namespace

OffsetField offsets_from_warp(const Warp& warp, const Geometry& source, Progress* progress) {
  if (warp.direction == WarpDirection::material) {
    throw InputError({warp.path, "direction", "a material-direction warp",
                      "a resample-direction warp, which supple export writes by default"});
  }
  if (progress != nullptr) progress->stage("offsets");
  const WarpSampler sampler(warp, source);
  OffsetField field{source, {}, {}};
  VectorBricks& o = field.o;
  const Sampled sampled = find_valid(sampler, spanned_bricks(warp, source), progress);
  o.topology = sampled.valid;

  // Offsets are sampled a second time rather than kept, so that no brick is in memory twice.
  o.vectors.resize(o.topology.brick_count());
  o.vectors.reserve(sampled.moving.size());
  for (const std::size_t b : sampled.moving) o.vectors.touch(b);
  parallel_for(sampled.moving.size(), [&](std::size_t n) {
    const std::size_t b = sampled.moving[n];
    Vec3f* const vectors = o.vectors.touch(b);
    for_each_active(o.topology.mask(b), [&](int local) {
      sampler.offset_at(o.topology.origin(b) + brick_local(local), vectors[local]);
    });
  });
  report(progress, 1.0);
  return field;
}

}  // namespace supple
