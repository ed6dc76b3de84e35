// Links of the voxel lattice that are absent though both their ends are elements: where tissue has
// been cut, and at which place of the link, where a surface did it. Memory: nothing while nothing
// is cut, then 4 bytes per brick up to the last cut one, 192 bytes per brick with a cut, and 3 kB
// more where places are known.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "volumes/grid/brick_topology.h"

namespace supple {

/// Bricks and offsets are those of the BrickTopology of the elements. A link belongs to its end at
/// the lower index: axis a of a voxel is the link to the next voxel along index axis a.
class LinkCuts {
 public:
  /// Per axis, the voxels of a brick whose link to the next voxel is absent.
  using BrickCuts = std::array<BrickMask, 3>;
  /// The place where a surface crosses a link, from 1 at its lower end to kPlaces at its upper one;
  /// 0: unknown.
  using Place = std::uint16_t;
  static constexpr int kPlaces = 511;

  /// The place at a fraction of a link, 0 to 1, and back, to a thousandth; the middle if unknown.
  static Place place_of(double fraction);
  static double fraction_of(Place place) { return place == 0 ? 0.5 : (place - 0.5) / kPlaces; }

  bool empty() const { return m_records.empty(); }
  /// Cuts of brick b, which may be any number; null where no link of its voxels is cut.
  const BrickCuts* brick(std::size_t b) const {
    if (b >= m_record_of.size() || m_record_of[b] < 0) return nullptr;
    return &m_records[std::size_t(m_record_of[b])];
  }
  bool is_cut(std::size_t b, int offset, int axis) const {
    const BrickCuts* cuts = brick(b);
    return cuts != nullptr && mask_test((*cuts)[axis], offset);
  }
  /// Marks the link as absent; whether it exists is for the caller to know. False when it already
  /// was: then the place that is known first stays.
  bool cut(std::size_t b, int offset, int axis, Place place = 0);
  /// Place of a cut; 0 where the link is not cut or the place is unknown.
  Place place(std::size_t b, int offset, int axis) const {
    if (b >= m_record_of.size() || m_record_of[b] < 0) return 0;
    const std::size_t record = std::size_t(m_record_of[b]);
    if (record >= m_places.size() || m_places[record].empty()) return 0;
    return m_places[record][std::size_t(axis) * kBrickVoxels + std::size_t(offset)];
  }

  /// A brick number at and beyond which no brick has a cut link.
  std::size_t brick_end() const { return m_record_of.size(); }
  /// Links that are cut.
  std::int64_t count() const { return m_count; }
  std::size_t bytes() const;

  /// The same links at the same places, in whatever order they were cut.
  bool operator==(const LinkCuts& other) const;
  bool operator!=(const LinkCuts& other) const { return !(*this == other); }

 private:
  std::vector<std::int32_t> m_record_of;  // per brick, index into m_records or -1
  std::vector<BrickCuts> m_records;
  std::vector<std::vector<Place>> m_places;  // as m_records; shorter, or empty, where none is known
  std::int64_t m_count = 0;
};

}  // namespace supple
