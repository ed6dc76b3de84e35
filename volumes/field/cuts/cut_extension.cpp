#include "volumes/field/cuts/cut_extension.h"

#include <algorithm>
#include <utility>

#include <tbb/parallel_for.h>

#include "volumes/grid/cell.h"
#include "volumes/grid/mask_steps.h"
#include "volumes/grid/padded_rows.h"

namespace supple {

namespace {

constexpr int kRings = 2;
// Beside a cut a voxel may be this many rings from the elements of its own side.
constexpr int kRingsOfSide = 4;
// Air this near to a corner of a parted cell is filled anew, in voxels.
constexpr int kBesideParted = 3;

/// Sets the voxels of a box that lie in the brick at `origin`.
void set_box(const Vec3i& lo, const Vec3i& hi, const Vec3i& origin, BrickMask& mask) {
  Vec3i first, last;
  for (int a = 0; a < 3; ++a) {
    first[a] = std::max(lo[a] - origin[a], 0);
    last[a] = std::min(hi[a] - origin[a], kBrickDim - 1);
    if (first[a] > last[a]) return;
  }
  const std::uint64_t row = (0xffu >> (kBrickDim - 1 - last.z)) & (0xffu << first.z);
  std::uint64_t plane = 0;
  for (int y = first.y; y <= last.y; ++y) plane |= row << (8 * y);
  for (int x = first.x; x <= last.x; ++x) mask[std::size_t(x)] |= plane;
}

/// Nothing where both are zeros that are not stored.
void copy_brick(const Vec3f* from, std::size_t b, BrickVectors& to) {
  if (from == kZeroBrickOf<Vec3f> && to.brick(b) == nullptr) return;
  std::copy_n(from, kBrickVoxels, to.touch(b));
}

}  // namespace

CutExtension::CutExtension(const BrickTopology& voxels, const BrickTopology& elements)
    : m_voxels(voxels), m_elements(elements), m_bricks(voxels.brick_count()) {}

CutExtension::OfBrick& CutExtension::touch(std::size_t b) {
  if (!m_bricks[b]) {
    m_bricks[b] = std::make_unique<OfBrick>();
    m_bricks[b]->at_first = rings_of(b);
    m_bricks[b]->rings = m_bricks[b]->at_first;
  }
  return *m_bricks[b];
}

CutExtension::Rings CutExtension::rings_of(std::size_t b) const {
  static constexpr BrickMask kNone{};
  const Vec3i& origin = m_voxels.origin(b);
  const PaddedRows<kRings> elements([&](int n) -> const BrickMask* {
    const std::int32_t around = m_elements.find(origin + surrounding_step(n) * kBrickDim);
    return around < 0 ? &kNone : &m_elements.mask(std::size_t(around));
  });
  Rings rings;
  for (int n = 0; n < kBrickVoxels; ++n) {
    const Vec3i at = brick_local(n);
    int ring = 0;
    for (; ring <= kRings; ++ring) {
      unsigned bits = 0;
      for (int x = -ring; x <= ring; ++x) {
        for (int y = -ring; y <= ring; ++y) {
          bits |= elements.rows[at.x + x + kRings][at.y + y + kRings];
        }
      }
      if (bits >> (at.z + kRings - ring) & ((2u << (2 * ring)) - 1)) break;
    }
    rings[std::size_t(n)] = std::uint8_t(ring);
  }
  return rings;
}

/// Of a voxel of a brick that touch() has made.
int CutExtension::ring_at(const Vec3i& voxel) const {
  const auto b = std::size_t(m_voxels.find(voxel));
  return m_bricks[b]->rings[std::size_t(brick_offset(voxel))];
}

BrickMask CutExtension::beside_parted(const CutBody& body, std::size_t b) const {
  const Vec3i& origin = m_voxels.origin(b);
  BrickMask beside{};
  for (int n = 0; n < 27; ++n) {
    const std::int32_t around = body.cells().find(origin + surrounding_step(n) * kBrickDim);
    if (around < 0) continue;
    for (const PartedCell& parted : body.parted_in(std::size_t(around))) {
      set_box(parted.cell - Vec3i(kBesideParted), parted.cell + Vec3i(1 + kBesideParted), origin,
              beside);
    }
  }
  keep(m_voxels.mask(b), beside);
  if (const std::int32_t own = m_elements.find(origin); own >= 0) {
    for (std::size_t word = 0; word < beside.size(); ++word) {
      beside[word] &= ~m_elements.mask(std::size_t(own))[word];
    }
  }
  return beside;
}

/// The bricks with air beside parted cells, now or before, that see a change: four rings see eight
/// voxels far.
BrickList CutExtension::seen_from(const CutBody& body, const CutBody::Changes& changes,
                                  const BrickList& plain) {
  BrickList parted;  // of the voxels
  for (const std::int32_t c : changes.parted) {
    for (int n = 0; n < 27; ++n) {
      const std::int32_t b =
          m_voxels.find(body.cells().origin(std::size_t(c)) + surrounding_step(n) * kBrickDim);
      if (b >= 0) parted.push_back(b);
    }
  }
  std::sort(parted.begin(), parted.end());
  parted.erase(std::unique(parted.begin(), parted.end()), parted.end());
  std::vector<BrickMask> beside(parted.size());
  tbb::parallel_for(std::size_t(0), parted.size(), [&](std::size_t n) {
    beside[n] = beside_parted(body, std::size_t(parted[n]));
  });
  BrickList changed;
  for (std::size_t n = 0; n < parted.size(); ++n) {
    const auto b = std::size_t(parted[n]);
    if (beside[n] == (m_bricks[b] ? m_bricks[b]->beside : BrickMask{})) continue;
    touch(b).beside = beside[n];
    changed.push_back(parted[n]);
  }
  const BrickList seen = with_neighbours(m_voxels, unite(unite(plain, changes.links), changed));
  return bricks_where(seen, [&](std::size_t b) {
    return m_bricks[b] && (mask_count(m_bricks[b]->beside) > 0 ||
                           std::binary_search(changed.begin(), changed.end(), std::int32_t(b)));
  });
}

void CutExtension::fill(VectorBricks& u, const CutBody& body, const BrickList& bricks) {
  for (const std::int32_t b : with_neighbours(m_voxels, bricks)) touch(std::size_t(b));
  for (const std::int32_t b : bricks) {
    m_bricks[std::size_t(b)]->rings = m_bricks[std::size_t(b)]->at_first;
  }
  // Of lower rings, on the own side.
  const auto value_at = [&](const Vec3i& from, const Vec3i& to, int ring, Vec3f& value) {
    return u.at(to, value) && ring_at(to) < ring && body.connects(from, to);
  };
  const auto extrapolated = [&](const Vec3i& voxel, int ring) {
    Extrapolation extrapolation;
    for (int n = 0; n < 27; ++n) {
      const Vec3i beside = voxel + surrounding_step(n);
      Vec3f near, far;
      if (n == 13 || !value_at(voxel, beside, ring, near)) continue;
      if (value_at(beside, 2 * beside - voxel, ring, far)) {
        extrapolation.add_row(near, far);
      } else {
        extrapolation.add(near);
      }
    }
    return extrapolation;
  };
  struct Found {
    std::vector<std::pair<int, Vec3f>> values;
    std::vector<int> later;  // next to no voxel of their own side yet
  };
  for (int ring = 1; ring <= kRingsOfSide; ++ring) {
    std::vector<Found> found(bricks.size());
    tbb::parallel_for(std::size_t(0), found.size(), [&](std::size_t n) {
      const auto b = std::size_t(bricks[n]);
      for_each_active(m_bricks[b]->beside, [&](int offset) {
        if (m_bricks[b]->rings[std::size_t(offset)] != ring) return;
        const Extrapolation own = extrapolated(m_voxels.origin(b) + brick_local(offset), ring);
        if (own.empty()) {
          found[n].later.push_back(offset);
        } else {
          found[n].values.emplace_back(offset, own.value());
        }
      });
    });
    for (std::size_t n = 0; n < found.size(); ++n) {
      const auto b = std::size_t(bricks[n]);
      for (const auto& [offset, value] : found[n].values) {
        if (value != u.vectors.brick_or_zero(b)[offset]) u.vectors.touch(b)[offset] = value;
      }
      for (const int offset : found[n].later) ++m_bricks[b]->rings[std::size_t(offset)];
    }
  }
}

BrickList CutExtension::follow(VectorBricks& u, const VectorBricks& plain, const CutBody& body,
                               const CutBody::Changes& changes, const BrickList& given) {
  const BrickList bricks = seen_from(body, changes, given);
  m_filled = std::int64_t(bricks.size());
  std::vector<std::vector<Vec3f>> before(bricks.size());
  tbb::parallel_for(std::size_t(0), bricks.size(), [&](std::size_t n) {
    const Vec3f* const vectors = u.vectors.brick_or_zero(std::size_t(bricks[n]));
    before[n].assign(vectors, vectors + kBrickVoxels);
  });
  for (const std::int32_t b : unite(given, bricks)) {
    copy_brick(plain.vectors.brick_or_zero(std::size_t(b)), std::size_t(b), u.vectors);
  }
  fill(u, body, bricks);
  std::size_t n = 0;
  BrickList changed;
  for (const std::int32_t b : bricks) {
    const Vec3f* const now = u.vectors.brick_or_zero(std::size_t(b));
    if (!std::equal(now, now + kBrickVoxels, before[n++].begin())) changed.push_back(b);
  }
  for (const std::int32_t b : given) {
    if (!std::binary_search(bricks.begin(), bricks.end(), b)) changed.push_back(b);
  }
  std::sort(changed.begin(), changed.end());
  return changed;
}

void extend_beside_cuts(VectorBricks& u, const CutBody& body) {
  CutExtension extension(body.voxels(), body.elements());
  const CutBody::Changes all{all_bricks(body.voxels()), all_bricks(body.cells())};
  const VectorBricks plain = u;
  extension.follow(u, plain, body, all, {});
}

}  // namespace supple
