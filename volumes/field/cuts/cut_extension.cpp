#include "volumes/field/cuts/cut_extension.h"

#include <algorithm>
#include <utility>

#include "volumes/base/parallel.h"
#include "volumes/grid/cell.h"
#include "volumes/grid/mask_steps.h"
#include "volumes/grid/padded_rows.h"

namespace supple {

namespace {

constexpr int kRings = 2;
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

/// Copies a brick; does nothing where both are zeros that are not stored.
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

/// The ring of a voxel of a brick that touch() has made.
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
  keep(air_in(m_voxels, m_elements, b), beside);
  return beside;
}

/// The bricks in which other air is beside parted cells than before.
BrickList CutExtension::find_beside(const CutBody& body, const BrickList& parted_cells) {
  BrickList parted;  // of the voxels
  for (const std::int32_t c : parted_cells) {
    for (int n = 0; n < 27; ++n) {
      const std::int32_t b =
          m_voxels.find(body.cells().origin(std::size_t(c)) + surrounding_step(n) * kBrickDim);
      if (b >= 0) parted.push_back(b);
    }
  }
  std::sort(parted.begin(), parted.end());
  parted.erase(std::unique(parted.begin(), parted.end()), parted.end());
  std::vector<BrickMask> beside(parted.size());
  parallel_for(parted.size(),
               [&](std::size_t n) { beside[n] = beside_parted(body, std::size_t(parted[n])); });
  BrickList changed;
  for (std::size_t n = 0; n < parted.size(); ++n) {
    const auto b = std::size_t(parted[n]);
    if (beside[n] == (m_bricks[b] ? m_bricks[b]->beside : BrickMask{})) continue;
    touch(b).beside = beside[n];
    changed.push_back(parted[n]);
  }
  return changed;
}

/// The bricks with air beside parted cells, now or before, that see a change: four rings see eight
/// voxels far.
BrickList CutExtension::filled_beside(const BrickList& seen, const BrickList& changed) const {
  return bricks_where(with_neighbours(m_voxels, seen), [&](std::size_t b) {
    return m_bricks[b] && (mask_count(m_bricks[b]->beside) > 0 ||
                           std::binary_search(changed.begin(), changed.end(), std::int32_t(b)));
  });
}

/// Voxels of lower rings around one, on its own side.
std::vector<CutExtension::Carrier> CutExtension::carriers_of(const CutBody& body,
                                                             const Vec3i& voxel, int ring) const {
  const auto leads = [&](const Vec3i& from, const Vec3i& to) {
    return m_voxels.is_active(to) && ring_at(to) < ring && body.connects(from, to);
  };
  const auto place_of = [&](const Vec3i& at) { return Place{m_voxels.find(at), brick_offset(at)}; };
  std::vector<Carrier> carriers;
  for (int n = 0; n < 27; ++n) {
    const Vec3i near = voxel + surrounding_step(n), behind = 2 * near - voxel;
    if (n == 13 || !leads(voxel, near)) continue;
    carriers.push_back({place_of(near), leads(near, behind) ? place_of(behind) : Place()});
  }
  return carriers;
}

/// Plans the rings of air beside parted cells, and which voxels carry on to it.
void CutExtension::plan(const CutBody& body, const BrickList& bricks) {
  for (const std::int32_t b : with_neighbours(m_voxels, bricks)) touch(std::size_t(b));
  for (const std::int32_t b : bricks) {
    OfBrick& brick = *m_bricks[std::size_t(b)];
    brick.rings = brick.at_first;
    for (auto& filled : brick.filled) filled.clear();
    for (auto& carriers : brick.carriers) carriers.clear();
  }
  for (int ring = 1; ring <= kRingsOfSide; ++ring) {
    std::vector<std::vector<int>> later(bricks.size());  // next to no voxel of their own side yet
    parallel_for(bricks.size(), [&](std::size_t n) {
      const auto b = std::size_t(bricks[n]);
      OfBrick& brick = *m_bricks[b];
      std::vector<Carrier>& all = brick.carriers[std::size_t(ring)];
      for_each_active(brick.beside, [&](int offset) {
        if (brick.rings[std::size_t(offset)] != ring) return;
        const std::vector<Carrier> own =
            carriers_of(body, m_voxels.origin(b) + brick_local(offset), ring);
        all.insert(all.end(), own.begin(), own.end());
        if (own.empty()) {
          later[n].push_back(offset);
        } else {
          brick.filled[std::size_t(ring)].push_back({offset, std::int32_t(all.size())});
        }
      });
    });
    for (std::size_t n = 0; n < bricks.size(); ++n) {
      Rings& rings = m_bricks[std::size_t(bricks[n])]->rings;
      for (const int offset : later[n]) ++rings[std::size_t(offset)];
    }
  }
}

void CutExtension::fill(VectorBricks& u, const BrickList& bricks) const {
  const auto at = [&](const Place& place) {
    return u.vectors.brick_or_zero(std::size_t(place.brick))[place.offset];
  };
  for (std::size_t ring = 1; ring <= kRingsOfSide; ++ring) {
    std::vector<std::vector<Vec3f>> values(bricks.size());
    parallel_for(bricks.size(), [&](std::size_t n) {
      const OfBrick& brick = *m_bricks[std::size_t(bricks[n])];
      std::int32_t next = 0;
      for (const Filled& filled : brick.filled[ring]) {
        Extrapolation extrapolation;
        for (; next < filled.end; ++next) {
          const Carrier& carrier = brick.carriers[ring][std::size_t(next)];
          if (carrier.behind.brick < 0) {
            extrapolation.add(at(carrier.near));
          } else {
            extrapolation.add_row(at(carrier.near), at(carrier.behind));
          }
        }
        values[n].push_back(extrapolation.value());
      }
    });
    for (std::size_t n = 0; n < bricks.size(); ++n) {
      const auto b = std::size_t(bricks[n]);
      const std::vector<Filled>& filled = m_bricks[b]->filled[ring];
      for (std::size_t v = 0; v < filled.size(); ++v) {
        const int offset = filled[v].offset;
        if (values[n][v] != u.vectors.brick_or_zero(b)[offset]) {
          u.vectors.touch(b)[offset] = values[n][v];
        }
      }
    }
  }
}

DisplacedBricks CutExtension::follow(VectorBricks& u, const VectorBricks& plain,
                                     const CutBody& body, const CutBody::Changes& changes,
                                     const BrickList& given) {
  const BrickList changed = find_beside(body, changes.parted);
  plan(body, filled_beside(unite(changes.links, changed), changed));
  const BrickList bricks = filled_beside(unite(unite(given, changes.links), changed), changed);
  m_filled = std::int64_t(bricks.size());
  const BrickList copied = unite(given, bricks);
  KeptVectors before(u, copied);
  for (const std::int32_t b : copied) {
    copy_brick(plain.vectors.brick_or_zero(std::size_t(b)), std::size_t(b), u.vectors);
  }
  fill(u, bricks);
  return before.moved(u);
}

void extend_beside_cuts(VectorBricks& u, const CutBody& body) {
  CutExtension extension(body.voxels(), body.elements());
  const CutBody::Changes all{all_bricks(body.voxels()), all_bricks(body.cells())};
  const VectorBricks plain = u;
  extension.follow(u, plain, body, all, {});
}

}  // namespace supple
