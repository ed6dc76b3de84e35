// Sparse loading: slabs stream past, and only bricks that can matter are kept (design.md, "The
// air"). Memory grows with the active voxels; two slabs as they are stored, one of floats and a bit
// per brick are the only dense part.
#include "volumes/io/load/load.h"

#include <algorithm>
#include <functional>
#include <sstream>

#include "volumes/base/error.h"
#include "volumes/base/parallel.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/load/brick_store.h"
#include "volumes/io/load/slab_reader.h"

namespace supple {

namespace {

/// Keeps the bricks that hold more than the lowest density. That one is known at the end only, so
/// that bricks of nothing but the lowest so far are air until a lower one comes: a bit each.
class VolumeCollector {
 public:
  /// Takes the next slab's content; `lowest` is the lowest density up to its end.
  void add(const Slab& slab, float lowest) {
    if (lowest != m_lowest) {
      keep_air(slab);
      m_lowest = lowest;
    }
    std::vector<SlabBrick> bricks = bricks_of(slab);
    for (SlabBrick& brick : bricks) {
      m_is_air.push_back(brick.is_all(m_lowest));
      if (!m_is_air.back() && !brick.is_void()) m_store.keep(std::move(brick));
    }
  }

  BrickStore& store() { return m_store; }

 private:
  /// Stores the bricks that were air below the slab.
  void keep_air(const Slab& slab) {
    const std::size_t across = std::size_t(slab.bricks_x()), count = across * slab.bricks_y();
    for (std::size_t n = 0; n < m_is_air.size(); ++n) {
      if (!m_is_air[n]) continue;
      const Vec3i origin(int(n % across) * kBrickDim, int(n % count / across) * kBrickDim,
                         m_first_k + int(n / count) * kBrickDim);
      m_store.keep(constant_brick(origin, slab.dims, m_lowest));
    }
    m_is_air.clear();
    m_first_k = slab.k0;
  }

  float m_lowest = 0;
  int m_first_k = 0;           // of the slab with the first of m_is_air
  std::vector<bool> m_is_air;  // bricks as they came
  BrickStore m_store;
};

/// Keeps the bricks within reach of elements. A slab is settled once the slab above it is known,
/// since elements there reach down into it; hence `rings` of at most a brick.
class ElementCollector {
 public:
  ElementCollector(double lo, double hi, int rings) : m_lo(lo), m_hi(hi), m_rings(rings) {}

  /// Takes the next slab's content.
  void add(const Slab& slab) {
    m_across = slab.bricks_x();
    m_down = slab.bricks_y();
    std::vector<SlabBrick> bricks = bricks_of(slab);
    m_reached_here = std::move(m_reached_above);
    m_reached_here.resize(bricks.size(), 0);
    m_reached_above.assign(bricks.size(), 0);
    find_elements(bricks);
    settle();
    m_held = std::move(bricks);
    m_reached_below = std::move(m_reached_here);
  }

  void finish() { settle(); }

  BrickTopology take_elements() { return {std::move(m_origins), std::move(m_masks)}; }
  BrickStore& store() { return m_store; }

 private:
  void find_elements(const std::vector<SlabBrick>& bricks) {
    std::vector<BrickMask> masks(bricks.size());
    parallel_for(bricks.size(), [&](std::size_t n) { masks[n] = bricks[n].within(m_lo, m_hi); });
    for (std::size_t n = 0; n < bricks.size(); ++n) {
      const IndexBox box = mask_bounds(masks[n]);
      if (box.empty()) continue;
      m_origins.push_back(bricks[n].origin);
      m_masks.push_back(masks[n]);
      mark_reach(int(n) % m_across, int(n) / m_across, box);
    }
  }

  /// Marks the bricks that the dilated bounds of a brick's elements touch.
  void mark_reach(int bi, int bj, const IndexBox& box) {
    const auto first = [&](int a) { return box.lo[a] < m_rings ? -1 : 0; };
    const auto last = [&](int a) { return box.hi[a] + m_rings >= kBrickDim ? 1 : 0; };
    std::vector<char>* const layers[3] = {&m_reached_below, &m_reached_here, &m_reached_above};
    for (int dz = first(2); dz <= last(2); ++dz) {
      std::vector<char>& layer = *layers[dz + 1];
      if (layer.empty()) continue;
      for (int y = std::max(0, bj + first(1)); y <= std::min(m_down - 1, bj + last(1)); ++y) {
        for (int x = std::max(0, bi + first(0)); x <= std::min(m_across - 1, bi + last(0)); ++x) {
          layer[std::size_t(y) * m_across + x] = 1;
        }
      }
    }
  }

  /// Stores the reached bricks of the slab that is held back.
  void settle() {
    for (std::size_t n = 0; n < m_held.size(); ++n) {
      if (m_reached_below[n] && !m_held[n].is_void()) m_store.keep(std::move(m_held[n]));
    }
    m_held.clear();
    m_reached_below.clear();
  }

  double m_lo, m_hi;
  int m_rings;
  int m_across = 0, m_down = 0;  // bricks of a slab along i and j
  std::vector<SlabBrick> m_held;
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

/// Adds the voxels of a slab.
void count(const Slab& slab, CountedRange& range) {
  const float lo = float(range.lo), hi = float(range.hi);
  range.voxels += parallel_reduce(
      slab.values.size(), Grain{1}, std::int64_t(0),
      [&](std::size_t n, std::int64_t& sum) {
        sum += slab.values[n] >= lo && slab.values[n] <= hi;
      },
      std::plus<>());
}

}  // namespace

Volume load_volume(VolumeFile& file, Progress* progress) {
  SlabReader reader(file, progress);
  VolumeCollector collector;
  {
    Slab slab;
    while (reader.next(slab)) collector.add(slab, float(reader.statistics().min));
  }
  Volume volume = describe(file, reader);
  volume.density = collector.store().take_above(float(volume.statistics.min));
  return volume;
}

ElementVolume load_elements(VolumeFile& file, double lo, double hi, int components, int rings,
                            Progress* progress, std::vector<CountedRange>* counted) {
  SlabReader reader(file, progress);
  ElementCollector collector(lo, hi, rings);
  {
    Slab slab;
    while (reader.next(slab)) {
      collector.add(slab);
      if (counted == nullptr) continue;
      for (CountedRange& range : *counted) count(slab, range);
    }
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
