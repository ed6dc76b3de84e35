// Sparse loading: slabs stream past, and only bricks that can matter are kept (design.md, "The
// air"). Memory grows with the active voxels; two slabs of floats are the only dense part.
#include <algorithm>
#include <sstream>

#include "volumes/base/error.h"
#include "volumes/io/brick_store.h"
#include "volumes/io/slab_reader.h"

namespace supple {

namespace {

/// Keeps the bricks within reach of elements. A slab is settled once the slab above it is known,
/// since elements there reach down into it; hence `rings` of at most a brick.
class ElementCollector {
 public:
  ElementCollector(double lo, double hi, int rings) : m_lo(lo), m_hi(hi), m_rings(rings) {}

  /// Takes the next slab's content; `slab` is left with memory to use again.
  void add(Slab& slab) {
    const std::size_t bricks = std::size_t(slab.bricks_x()) * slab.bricks_y();
    m_reached_here = std::move(m_reached_above);
    m_reached_here.resize(bricks, 0);
    m_reached_above.assign(bricks, 0);
    for (int bj = 0; bj < slab.bricks_y(); ++bj) {
      for (int bi = 0; bi < slab.bricks_x(); ++bi) find_elements(slab, bi, bj);
    }
    settle();
    std::swap(m_held, slab);
    m_reached_below = std::move(m_reached_here);
  }

  void finish() { settle(); }

  BrickTopology take_elements() { return {std::move(m_origins), std::move(m_masks)}; }
  BrickStore& store() { return m_store; }

 private:
  void find_elements(const Slab& slab, int bi, int bj) {
    float values[kBrickVoxels];
    slab.gather(bi, bj, values);
    BrickMask mask{};
    for (int offset = 0; offset < kBrickVoxels; ++offset) {
      const bool element = values[offset] >= m_lo && values[offset] <= m_hi;
      mask[offset >> 6] |= std::uint64_t(element) << (offset & 63);
    }
    if (mask_count(mask) == 0) return;
    m_origins.push_back(slab.brick_origin(bi, bj));
    m_masks.push_back(mask);
    mark_reach(slab, bi, bj, mask);
  }

  /// Marks the bricks that the dilated bounds of a brick's elements touch.
  void mark_reach(const Slab& slab, int bi, int bj, const BrickMask& mask) {
    Vec3i lo(kBrickDim), hi(-1);
    for_each_active(mask, [&](int offset) {
      const Vec3i p = brick_local(offset);
      for (int a = 0; a < 3; ++a) {
        lo[a] = std::min(lo[a], p[a]);
        hi[a] = std::max(hi[a], p[a]);
      }
    });
    const auto first = [&](int a) { return lo[a] < m_rings ? -1 : 0; };
    const auto last = [&](int a) { return hi[a] + m_rings >= kBrickDim ? 1 : 0; };
    std::vector<char>* const layers[3] = {&m_reached_below, &m_reached_here, &m_reached_above};
    for (int dz = first(2); dz <= last(2); ++dz) {
      std::vector<char>& layer = *layers[dz + 1];
      if (layer.empty()) continue;
      for (int y = std::max(0, bj + first(1)); y <= std::min(slab.bricks_y() - 1, bj + last(1));
           ++y) {
        for (int x = std::max(0, bi + first(0)); x <= std::min(slab.bricks_x() - 1, bi + last(0));
             ++x) {
          layer[std::size_t(y) * slab.bricks_x() + x] = 1;
        }
      }
    }
  }

  /// Stores the reached bricks of the slab that is held back.
  void settle() {
    if (m_reached_below.empty()) return;
    m_store.add(m_held, [&](int bi, int bj) {
      return m_reached_below[std::size_t(bj) * m_held.bricks_x() + bi] != 0;
    });
    m_reached_below.clear();
  }

  double m_lo, m_hi;
  int m_rings;
  Slab m_held;
  std::vector<char> m_reached_below, m_reached_here, m_reached_above;
  std::vector<Vec3i> m_origins;
  std::vector<BrickMask> m_masks;
  BrickStore m_store;
};

Volume describe(const VolumeFile& file, const SlabReader& reader) {
  Volume volume;
  volume.geometry = file.header().geometry;
  volume.statistics = reader.statistics();
  volume.format = file.header().format;
  // Scaled values need not fit the type that they were stored in.
  const bool scaled = file.header().slope != 1 || file.header().intercept != 0;
  volume.value_type = numpy_name(scaled ? ValueType::float32 : file.header().type);
  return volume;
}

[[noreturn]] void throw_no_elements(const Volume& volume, const std::string& path, double lo,
                                    double hi) {
  std::ostringstream found, expected;
  found << "densities from " << volume.statistics.min << " to " << volume.statistics.max;
  expected << "at least one voxel within " << lo << " to " << hi;
  throw InputError({path, "elements", found.str(), expected.str()});
}

}  // namespace

Volume load_volume(VolumeFile& file, Progress* progress) {
  SlabReader reader(file, progress);
  BrickStore store;
  Slab slab;
  while (reader.next(slab)) store.add(slab, [](int, int) { return true; });
  slab = Slab();
  Volume volume = describe(file, reader);
  const float background = float(volume.statistics.min);
  volume.density = store.take_grid(store.above(background), background);
  return volume;
}

ElementVolume load_elements(VolumeFile& file, double lo, double hi, int components, int rings,
                            Progress* progress) {
  SlabReader reader(file, progress);
  ElementCollector collector(lo, hi, rings);
  {
    Slab slab;
    while (reader.next(slab)) collector.add(slab);
    collector.finish();
  }
  ElementVolume result;
  result.volume = describe(file, reader);
  result.elements = collector.take_elements();
  if (result.elements.empty()) throw_no_elements(result.volume, file.header().path, lo, hi);
  if (components > 0) result.elements = largest_components(result.elements, components);

  // The store holds voxels of the box only, which clips the shell.
  const float background = float(result.volume.statistics.min);
  result.volume.density = collector.store().take_grid(dilate(result.elements, rings), background);
  return result;
}

Volume load_volume(const std::string& path, const ReadOptions& options, Progress* progress) {
  return load_volume(*open_volume(path, options), progress);
}

ElementVolume load_elements(const std::string& path, const ReadOptions& options, double lo,
                            double hi, int components, int rings, Progress* progress) {
  return load_elements(*open_volume(path, options), lo, hi, components, rings, progress);
}

}  // namespace supple
