#include "volumes/field/inversion/hidden_elements.h"

#include <algorithm>
#include <cmath>

#include "volumes/base/parallel.h"
#include "volumes/field/inversion/reachable_bricks.h"
#include "volumes/field/inversion/source_window.h"
#include "volumes/field/split_offsets.h"
#include "volumes/grid/cell.h"
#include "volumes/grid/voxel_sets.h"

namespace supple {

namespace {

// Distance of places that are a voxel apart, with room for rounding; voxels.
constexpr double kApart = 1 + 1e-4;

/// The offset at x of those nodes around that hold one; false where none does.
bool sample_of_some(const VectorBricks& o, const Vec3d& x, Vec3d& offset) {
  const Vec3i low = floor_voxel(x);
  const Vec3d t = x - Vec3d(low);
  Vec3d sum(0);
  double weights = 0;
  for (int n = 0; n < 8; ++n) {
    const Vec3i step = cell_corner(n);
    double weight = 1;
    for (int a = 0; a < 3; ++a) weight *= step[a] ? t[a] : 1 - t[a];
    Vec3f corner;
    if (weight == 0 || !o.at(low + step, corner)) continue;
    sum += Vec3d(corner) * weight;
    weights += weight;
  }
  if (weights == 0) return false;
  offset = sum / weights;
  return true;
}

/// Counts in one source brick after the other, with the memory for it.
class HiddenCount {
 public:
  HiddenCount(const VectorBricks& u, const OffsetField& field,
              const std::function<bool(const Vec3i& origin)>& wants)
      : m_u(u), m_field(field), m_wants(wants) {}

  /// `elements`: of the brick at `origin`.
  int count(const Vec3i& origin, const BrickMask& elements) {
    const std::int32_t b = m_u.topology.find(origin);
    if (b < 0) return mask_count(elements);
    const Vec3f* u = m_u.vectors.brick_or_zero(std::size_t(b));
    if (is_still(origin, elements, u) || is_elsewhere(origin, elements, u)) return 0;
    // The equation of the inverse, with the fields in each other's place: |u + o(X + u)|.
    const bool measured = m_field.split == nullptr &&
                          m_window.measure(m_field.o, {}, origin, elements, u, m_distances);
    int hidden = 0;
    for_each_active(elements, [&](int n) {
      const double distance = measured ? double(m_distances[n]) : SourceWindow::kUnknown;
      const Vec3d at(origin + brick_local(n));
      hidden += distance >= 0 ? distance > kApart : is_hidden(at, Vec3d(u[n]));
    });
    return hidden;
  }

 private:
  /// True if all elements are where they were and are seen there.
  bool is_still(const Vec3i& origin, const BrickMask& elements, const Vec3f* u) const {
    if (m_field.split != nullptr) return false;
    const std::int32_t b = m_field.o.topology.find(origin);
    if (b < 0) return false;
    if (!holds(m_field.o.topology.mask(std::size_t(b)), elements)) return false;
    const Vec3f* o = m_field.o.vectors.brick_or_zero(std::size_t(b));
    return are_zeros(u) && are_zeros(o);
  }

  /// True if all elements went where no offsets are wanted.
  bool is_elsewhere(const Vec3i& origin, const BrickMask& elements, const Vec3f* u) const {
    if (!m_wants) return false;
    Vec3d lo(HUGE_VAL), hi(-HUGE_VAL);
    for_each_active(elements, [&](int n) {
      const Vec3d x = Vec3d(origin + brick_local(n)) + Vec3d(u[n]);
      for (int a = 0; a < 3; ++a) {
        lo[a] = std::min(lo[a], x[a]);
        hi[a] = std::max(hi[a], x[a]);
      }
    });
    std::vector<Vec3i> origins;
    add_box(floor_voxel(lo), floor_voxel(hi) + Vec3i(1), origins);
    return std::none_of(origins.begin(), origins.end(), m_wants);
  }

  /// True if offsets are wanted at all nodes around a place.
  bool is_wanted(const Vec3d& x) const {
    if (!m_wants) return true;
    const Vec3i low = floor_voxel(x);
    for (int n = 0; n < 8; ++n) {
      const Vec3i node = low + cell_corner(n);
      if (!m_wants({node.x & ~7, node.y & ~7, node.z & ~7})) return false;
    }
    return true;
  }

  bool is_hidden(const Vec3d& at, const Vec3d& moved) const {
    const Vec3d x = at + moved;
    if (!is_wanted(x)) return false;
    Vec3d offset;
    const bool in_split =
        m_field.split != nullptr && m_field.split->bricks().find(floor_voxel(x)) >= 0;
    const bool is_seen =
        in_split ? m_field.sample(x, offset) : sample_of_some(m_field.o, x, offset);
    return !is_seen || (moved + offset).length() > kApart;
  }

  const VectorBricks& m_u;
  const OffsetField& m_field;
  const std::function<bool(const Vec3i& origin)>& m_wants;
  SourceWindow m_window;
  std::array<float, kBrickVoxels> m_distances;
};

}  // namespace

std::int64_t count_hidden(const Displacement& displacement, const BrickTopology& elements,
                          const OffsetField& offsets,
                          const std::function<bool(const Vec3i& origin)>& wants) {
  PerThread<HiddenCount> counts([&] { return HiddenCount(displacement.u, offsets, wants); });
  return parallel_reduce(
      elements.brick_count(), Grain{16}, std::int64_t(0),
      [&](std::size_t b, std::int64_t& sum) {
        sum += counts.local().count(elements.origin(b), elements.mask(b));
      },
      std::plus<std::int64_t>());
}

}  // namespace supple
