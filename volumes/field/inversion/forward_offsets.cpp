#include "volumes/field/inversion/forward_offsets.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "volumes/base/parallel.h"
#include "volumes/field/brick_nodes.h"
#include "volumes/field/inversion/displacement_range.h"
#include "volumes/field/inversion/reachable_bricks.h"
#include "volumes/grid/cell.h"

namespace supple {

namespace {

constexpr double kLastStep = 0.002;  // voxels
constexpr int kMaxNewtonSteps = 12;
constexpr int kMaxHalvings = 3;
constexpr double kMaxStep = 4;  // voxels
constexpr double kLeastDet = 1e-3;
constexpr int kSeedSpacing = 4;
// Newton may go so far beyond the border of the volume on its way, in voxels.
constexpr double kCarriedOn = 1.5;

Vec3d to_vector(const Float4& v) {
  return {double(v[0]), double(v[1]), double(v[2])};
}
Vec3i brick_origin(const Vec3i& voxel) {
  return {voxel.x & ~7, voxel.y & ~7, voxel.z & ~7};
}
int octant_of(const Vec3i& voxel) {
  return (voxel.x & 4) | (voxel.y & 4) >> 1 | (voxel.z & 4) >> 2;
}
double largest(const Vec3d& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

/// The inverse of F = I + grad u by its rows.
struct InverseGradient {
  Vec3d rows[3];

  /// False where the cell is flat. `along`: the columns of grad u.
  bool set(const Vec3d along[3]) {
    const Vec3d c0 = along[0] + Vec3d(1, 0, 0), c1 = along[1] + Vec3d(0, 1, 0),
                c2 = along[2] + Vec3d(0, 0, 1);
    rows[0] = c1.cross(c2);
    rows[1] = c2.cross(c0);
    rows[2] = c0.cross(c1);
    const double det = c0.dot(rows[0]);
    if (!(std::abs(det) > kLeastDet)) return false;
    for (Vec3d& row : rows) row /= det;
    return true;
  }
  Vec3d times(const Vec3d& v) const { return {rows[0].dot(v), rows[1].dot(v), rows[2].dot(v)}; }
  Vec3d transposed_times(const Vec3d& v) const {
    return rows[0] * v.x + rows[1] * v.y + rows[2] * v.z;
  }
};

}  // namespace

struct ForwardOffsets::Corners {
  Float4 of[8];
};

ForwardOffsets::ForwardOffsets(const Displacement& displacement, const BrickTopology* elements)
    : m_u(displacement.u),
      m_dims(displacement.geometry.dims()),
      m_elements(elements),
      m_ranges(std::make_unique<DisplacementRanges>(m_dims)),
      m_reach(m_u.topology.brick_count()),
      m_still(m_u.topology.brick_count()) {
  for (std::size_t b = 0; m_elements != nullptr && b < m_still.size(); ++b) {
    m_tissue_of.push_back(m_elements->find(m_u.topology.origin(b)));
  }
  std::vector<std::int32_t> all(m_u.topology.brick_count());
  std::iota(all.begin(), all.end(), 0);
  update(all);
}

ForwardOffsets::~ForwardOffsets() = default;

void ForwardOffsets::update(const std::vector<std::int32_t>& changed) {
  find_ranges(changed);
  find_reached();
}

void ForwardOffsets::find_ranges(const std::vector<std::int32_t>& changed) {
  m_ranges->update(m_u, changed);
  const std::vector<std::int32_t> touched = with_lower_neighbours(m_u.topology, changed);
  parallel_for(touched.size(), [&](std::size_t n) {
    const std::size_t b = std::size_t(touched[n]);
    m_reach[b] = m_ranges->reach(m_u.topology, b);
    m_still[b] = m_ranges->is_still(m_u.topology, b);
  });
}

/// The output bricks that cells of moving bricks reach, and those that such bricks have left.
void ForwardOffsets::find_reached() {
  BrickIndex index;
  std::vector<Reached> reached;
  const auto add = [&](const Vec3i& origin, const IndexBox& cells) {
    const std::size_t n = index.add(origin);
    if (n == reached.size()) reached.emplace_back();
    reached[n].source = join(reached[n].source, cells);
  };
  for (std::size_t b = 0; b < m_still.size(); ++b) {
    if (m_still[b]) continue;
    const Vec3i& origin = m_u.topology.origin(b);
    const IndexBox cells{origin, origin + Vec3i(kBrickDim)};
    add(origin, cells);
    // A sample may lie in a cell whose upper corners only are nodes in reach.
    const IndexBox& reach = m_reach[b];
    for (int x = (reach.lo.x - 1) & ~7; x <= reach.hi.x; x += kBrickDim) {
      for (int y = (reach.lo.y - 1) & ~7; y <= reach.hi.y; y += kBrickDim) {
        for (int z = (reach.lo.z - 1) & ~7; z <= reach.hi.z; z += kBrickDim) add({x, y, z}, cells);
      }
    }
  }
  for (std::size_t b = 0; b < m_still.size(); ++b) {
    if (!m_still[b]) plant_seeds(b, index, reached);
  }

  std::vector<Vec3i> origins = index.origins();
  std::sort(origins.begin(), origins.end(), voxel_less);
  m_reached.clear();
  for (const Vec3i& origin : origins) m_reached.push_back(reached[std::size_t(index.find(origin))]);
  set_bricks(std::move(origins));
}

/// True if the voxel nearest to y is an element.
bool ForwardOffsets::is_tissue(const Vec3d& y) const {
  return m_elements == nullptr || m_elements->is_active(floor_voxel(y + Vec3d(0.5)));
}

/// The same near a place in that piece.
bool ForwardOffsets::is_tissue(const Vec3d& y, int piece) const {
  if (m_elements == nullptr) return true;
  const std::size_t b = std::size_t(piece / kBrickVoxels);
  const Vec3i voxel = floor_voxel(y + Vec3d(0.5));
  if (brick_origin(voxel) != m_u.topology.origin(b)) return m_elements->is_active(voxel);
  const std::int32_t same = m_tissue_of[b];
  return same >= 0 && mask_test(m_elements->mask(std::size_t(same)), brick_offset(voxel));
}

/// A node of brick b in the octant above `low` to begin at: its middle, or else the first element;
/// -1 where there is no displacement.
int ForwardOffsets::seed_node(std::size_t b, const Vec3i& low) const {
  const BrickMask& known = m_u.topology.mask(b);
  const int middle = brick_offset(low + Vec3i(kSeedSpacing / 2));
  const std::int32_t same = m_elements == nullptr ? -1 : m_elements->find(m_u.topology.origin(b));
  const auto is_element = [&](int node) {
    return mask_test(known, node) && mask_test(m_elements->mask(std::size_t(same)), node);
  };
  if (same >= 0 && !is_element(middle)) {
    for (int n = 0; n < kSeedSpacing * kSeedSpacing * kSeedSpacing; ++n) {
      const int node = brick_offset(low + Vec3i(n >> 4, n >> 2 & 3, n & 3));
      if (is_element(node)) return node;
    }
  }
  return mask_test(known, middle) ? middle : -1;
}

/// Plants some nodes of a moving brick where they go, for samples there to begin with; tissue goes
/// before air, then the shortest way wins.
void ForwardOffsets::plant_seeds(std::size_t b, const BrickIndex& index,
                                 std::vector<Reached>& reached) const {
  const Vec3i& origin = m_u.topology.origin(b);
  for (int n = 0; n < kSeeds; ++n) {
    const int node = seed_node(b, cell_corner(n) * kSeedSpacing);
    if (node < 0) continue;
    const Vec3i at = origin + brick_local(node);
    const Vec3f offset = -m_u.vectors.brick_or_zero(b)[node];
    const Vec3i image = floor_voxel(Vec3d(at) - Vec3d(offset));
    const std::int32_t brick = index.find(image);
    if (brick < 0) continue;
    const int octant = octant_of(image);
    Vec3f& seed = reached[brick].seed[octant];
    bool& before = reached[brick].is_tissue[octant];
    const bool now = is_tissue(Vec3d(at));
    if (before && !now) continue;
    if (before == now && seed.length2() <= offset.length2()) continue;
    seed = offset;
    before = now;
  }
}

/// The displacements around the cell of a voxel in brick b, x slowest; false where one is missing.
bool ForwardOffsets::corners_at(std::size_t b, const Vec3i& voxel, Corners& corners) const {
  const BrickTopology& topology = m_u.topology;
  const auto read = [&](std::size_t brick, int offset) {
    const Vec3f& u = m_u.vectors.brick_or_zero(brick)[offset];
    return Float4{u.x, u.y, u.z, 0};
  };
  const Vec3i local = voxel - topology.origin(b);
  if (std::max({local.x, local.y, local.z}) < kBrickDim - 1) {
    constexpr std::uint64_t kSquare = 0x303;  // the four corners in a layer
    const int shift = local.y * kBrickDim + local.z;
    const std::uint64_t layers = topology.mask(b)[local.x] & topology.mask(b)[local.x + 1];
    if ((layers >> shift & kSquare) != kSquare) return false;
    const int low = brick_offset(local);
    for (int n = 0; n < 8; ++n) {
      corners.of[n] = read(b, low + (n >> 2 & 1) * 64 + (n >> 1 & 1) * 8 + (n & 1));
    }
    return true;
  }
  for (int n = 0; n < 8; ++n) {
    const Vec3i corner = voxel + cell_corner(n);
    const Vec3i at = local + cell_corner(n);
    const bool is_here = std::max({at.x, at.y, at.z}) < kBrickDim;
    const std::int32_t brick = is_here ? std::int32_t(b) : topology.find(corner);
    const int offset = brick_offset(corner);
    if (brick < 0 || !mask_test(topology.mask(std::size_t(brick)), offset)) return false;
    corners.of[n] = read(std::size_t(brick), offset);
  }
  return true;
}

/// False where a corner of the cell has no displacement. `brick`: one that is likely to hold y, or
/// -1; then the one that does.
bool ForwardOffsets::place_at(const Vec3d& y, std::int32_t& brick, Place& place) const {
  Vec3i voxel = floor_voxel(y);
  for (int a = 0; a < 3; ++a) {
    const int last_cell = std::max(m_dims[a] - 2, 0);
    if (y[a] < 0 && y[a] >= -kCarriedOn) voxel[a] = 0;
    if (voxel[a] > last_cell && y[a] <= m_dims[a] - 1 + kCarriedOn) voxel[a] = last_cell;
  }
  if (brick < 0 || m_u.topology.origin(std::size_t(brick)) != brick_origin(voxel)) {
    brick = m_u.topology.find(voxel);
  }
  const std::int32_t b = brick;
  if (b < 0) return false;
  place.piece = b * kBrickVoxels + brick_offset(voxel);
  if (m_still[b]) {
    place.u = place.along[0] = place.along[1] = place.along[2] = Vec3d(0);
    return true;
  }
  Corners corners;
  if (!corners_at(std::size_t(b), voxel, corners)) return false;
  set_derivatives(corners, Vec3f(y - Vec3d(voxel)), place);
  return true;
}

void ForwardOffsets::set_derivatives(const Corners& corners, const Vec3f& f, Place& place) {
  const NodeDerivatives d = derivatives_of(corners.of, f.x, f.y, f.z);
  place.u = to_vector(d.value);
  place.along[0] = to_vector(d.along_x);
  place.along[1] = to_vector(d.along_y);
  place.along[2] = to_vector(d.along_z);
}

/// True where not even border voxels reach, half a voxel beyond their centres.
bool ForwardOffsets::is_beyond_border(const Vec3d& y) const {
  for (int a = 0; a < 3; ++a) {
    if (y[a] < -kBeyondBorder || y[a] > m_dims[a] - 1 + kBeyondBorder) return true;
  }
  return false;
}

/// Newton from x + offset; steps that leave the material are halved.
bool ForwardOffsets::solve(const Vec3d& x, const Vec3d& offset, Sample& found) const {
  Vec3d y = x + offset, before = y;
  std::int32_t brick = found.piece >= 0 ? found.piece / kBrickVoxels : -1;
  int halvings = 0;
  for (int n = 0; n < kMaxNewtonSteps; ++n) {
    Place place;
    if (!place_at(y, brick, place)) {
      if (n == 0 || ++halvings > kMaxHalvings) return false;
      y = (y + before) / 2;
      continue;
    }
    Vec3d step = y + place.u - x;
    if (!m_still[place.piece / kBrickVoxels]) {
      InverseGradient inverse;
      if (!inverse.set(place.along)) return false;
      step = inverse.times(step);
    }
    before = y;
    const double size = largest(step);
    if (size <= kLastStep) {
      found = {y - step - x, place.piece};
      return !is_beyond_border(y - step);
    }
    y -= size > kMaxStep ? step * (kMaxStep / size) : step;
  }
  return false;
}

bool ForwardOffsets::sample(std::size_t b, const Vec3d& x, Sample& found) const {
  const Vec3d before = found.offset;
  bool has_air = false;
  Sample air;
  // Once air is found, only what may lead to tissue is tried.
  const auto finds_tissue = [&](const Vec3d& offset) {
    if (has_air && !is_tissue(x + offset)) return false;
    if (!solve(x, offset, found)) return false;
    if (is_tissue(x + found.offset, found.piece)) return true;
    if (!has_air) air = found;
    has_air = true;
    return false;
  };
  if (found.piece >= 0 && finds_tissue(before)) return true;
  const Reached& reached = m_reached[b];
  const int octant = octant_of(floor_voxel(x));
  for (int n = 0; n < kSeeds; ++n) {
    const Vec3f& seed = reached.seed[octant ^ n];
    if (seed.length2() >= 0 && finds_tissue(Vec3d(seed))) return true;
  }
  if (finds_tissue(Vec3d(0))) return true;
  if (has_air) found = air;
  return has_air;
}

void ForwardOffsets::source_box(std::size_t b, Vec3d& lo, Vec3d& hi) const {
  const Vec3i& origin = bricks().origin(b);
  const IndexBox box = join(m_reached[b].source, {origin, origin + Vec3i(kBrickDim)});
  lo = Vec3d(box.lo);
  hi = Vec3d(box.hi);
}

Vec3d ForwardOffsets::pull_back(int piece, const Vec3d& /*x*/, const Vec3d& y,
                                const Vec3d& gradient) const {
  const std::size_t b = std::size_t(piece / kBrickVoxels);
  const Vec3i low = m_u.topology.origin(b) + brick_local(piece % kBrickVoxels);
  Corners corners;
  if (m_still[b] || !corners_at(b, low, corners)) return gradient;
  Place place;
  set_derivatives(corners, Vec3f(y - Vec3d(low)), place);
  InverseGradient inverse;
  return inverse.set(place.along) ? inverse.transposed_times(gradient) : gradient;
}

std::size_t ForwardOffsets::bytes() const {
  return bricks().bytes() + m_reached.capacity() * sizeof(Reached) + m_ranges->bytes() +
         m_reach.capacity() * (sizeof(IndexBox) + 1) +
         m_tissue_of.capacity() * sizeof(std::int32_t);
}

}  // namespace supple
