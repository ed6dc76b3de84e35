#include "volumes/field/dense/block_warp.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <type_traits>
#include <vector>

#include "volumes/base/error.h"

namespace supple {

namespace {

// Rounding of places and of offsets as floats, in voxels.
constexpr double kRoundingOfPlaces = 1e-3;
// Axes whose places differ by less over the whole grid are parallel, in nodes.
constexpr double kParallel = 1e-7;

struct RealBox {
  Vec3d lo{INFINITY, INFINITY, INFINITY};
  Vec3d hi{-INFINITY, -INFINITY, -INFINITY};
  void add(const Vec3d& place) {
    for (int a = 0; a < 3; ++a) {
      lo[a] = std::min(lo[a], place[a]);
      hi[a] = std::max(hi[a], place[a]);
    }
  }
};

/// Places in another frame of a box of voxels.
RealBox places_of(const GridPositions& positions, const IndexBox& box) {
  RealBox places;
  for (int corner = 0; corner < 8; ++corner) {
    places.add(positions.at((corner & 1) != 0 ? box.hi.x : box.lo.x,
                            (corner & 2) != 0 ? box.hi.y : box.lo.y,
                            (corner & 4) != 0 ? box.hi.z : box.lo.z));
  }
  return places;
}

Vec3i dims_of(const IndexBox& box) {
  return box.hi - box.lo + Vec3i(1);
}

void require_within(const char* what, const IndexBox& needed, const IndexBox& given) {
  if (needed.empty() || (given.contains(needed.lo) && given.contains(needed.hi))) return;
  std::ostringstream found, expected;
  found << "a part from " << given.lo << " to " << given.hi;
  expected << "one with " << needed.lo << " to " << needed.hi << ", which the block reads";
  throw InputError({"", what, found.str(), expected.str()});
}

/// Cell and weight of a place between the nodes 0 … last.
struct NodeStep {
  int cell = -1;  // outside the nodes
  double weight = 0;
};

NodeStep step_to(double place, int last) {
  if (!(place >= 0 && place <= last)) return {};
  const int cell = std::max(std::min(int(place), last - 1), 0);
  return {cell, place - cell};
}

/// Offsets of rows of a block, interpolated between nodes in doubles and rounded to floats.
class RowOffsets {
 public:
  RowOffsets(const GridPositions& positions, const Geometry& volume, const Geometry& field,
             const BlockOf<Vec3f>& vectors, bool is_aligned)
      : m_positions(positions),
        m_volume(volume),
        m_last(field.dims() - Vec3i(1)),
        m_vectors(vectors),
        m_is_aligned(is_aligned) {
    for (int a = 0; a < 3; ++a) {
      Vec3d axis(0);
      axis[a] = 1;
      m_to_index[a] = volume.index_vector_from_world(axis);
    }
  }

  /// NaN where the field says nothing.
  void fill(const IndexBox& box, int j, int k, RowPlaces& places) {
    if (m_vectors.box.empty()) {
      fill_void(places);
    } else if (m_is_aligned) {
      fill_row(box, j, k, places);
    } else {
      for (int i = box.lo.x; i <= box.hi.x; ++i) {
        const Vec3d o = at(m_positions.at(i, j, k));
        for (int a = 0; a < 3; ++a) places.offset[a][std::size_t(i - box.lo.x)] = float(o[a]);
      }
    }
  }

 private:
  const float* nodes(int y, int z) const {
    return &m_vectors.values[index_in(m_vectors.box, m_vectors.box.lo.x, y, z)].x;
  }

  /// A row of nodes between the four rows around a place.
  void blend(const NodeStep& at_y, const NodeStep& at_z) {
    const int y = at_y.cell, above_y = std::min(y + 1, m_last.y);
    const int z = at_z.cell, above_z = std::min(z + 1, m_last.z);
    const float* const rows[4] = {nodes(y, z), nodes(above_y, z), nodes(y, above_z),
                                  nodes(above_y, above_z)};
    const double weights[4] = {(1 - at_y.weight) * (1 - at_z.weight),
                               at_y.weight * (1 - at_z.weight), (1 - at_y.weight) * at_z.weight,
                               at_y.weight * at_z.weight};
    const auto count = std::size_t(m_vectors.box.hi.x - m_vectors.box.lo.x) + 1;
    double* __restrict const mm = m_mm.data();
    for (std::size_t n = 0; n < 3 * count; ++n) {
      mm[n] = rows[0][n] * weights[0] + rows[1][n] * weights[1] + rows[2][n] * weights[2] +
              rows[3][n] * weights[3];
    }
    for (int a = 0; a < 3; ++a) {
      double* __restrict const row = m_row[a].data();
      for (std::size_t n = 0; n < count; ++n) row[n] = mm[3 * n + std::size_t(a)];
      row[count] = row[count - 1];
    }
  }

  void fill_row(const IndexBox& box, int j, int k, RowPlaces& places) {
    const Vec3d at_row = m_positions.at(box.lo.x, j, k);
    const NodeStep at_y = step_to(at_row.y, m_last.y), at_z = step_to(at_row.z, m_last.z);
    if (at_y.cell < 0 || at_z.cell < 0) return fill_void(places);
    if (m_cell.empty()) find_cells(box);
    blend(at_y, at_z);
    const double *const l = m_row[0].data(), *const p = m_row[1].data(), *const q = m_row[2].data();
    const int* const cell = m_cell.data();
    const double* const weight = m_weight.data();
    const Vec3d to_l = m_to_index[0], to_p = m_to_index[1], to_s = m_to_index[2];
    float* __restrict const x = places.offset[0].data();
    float* __restrict const y = places.offset[1].data();
    float* __restrict const z = places.offset[2].data();
    for (std::size_t n = 0; n < places.count; ++n) {
      const int low = cell[n];
      const double up = weight[n], down = 1 - up;
      const double mm_l = l[low] * down + l[low + 1] * up;
      const double mm_p = p[low] * down + p[low + 1] * up;
      const double mm_s = q[low] * down + q[low + 1] * up;
      x[n] = float(to_l.x * mm_l + to_p.x * mm_p + to_s.x * mm_s);
      y[n] = float(to_l.y * mm_l + to_p.y * mm_p + to_s.y * mm_s);
      z[n] = float(to_l.z * mm_l + to_p.z * mm_p + to_s.z * mm_s);
    }
  }

  Vec3d at(const Vec3d& place) const {
    const NodeStep x = step_to(place.x, m_last.x), y = step_to(place.y, m_last.y),
                   z = step_to(place.z, m_last.z);
    if (x.cell < 0 || y.cell < 0 || z.cell < 0) return Vec3d(NAN);
    Vec3d mm(0);
    for (int corner = 0; corner < 8; ++corner) {
      const auto [cx, cy, cz] = cell_corner(corner);
      const double weight = (cx != 0 ? x.weight : 1 - x.weight) *
                            (cy != 0 ? y.weight : 1 - y.weight) *
                            (cz != 0 ? z.weight : 1 - z.weight);
      mm += Vec3d(m_vectors.values[index_in(m_vectors.box, std::min(x.cell + cx, m_last.x),
                                            std::min(y.cell + cy, m_last.y),
                                            std::min(z.cell + cz, m_last.z))]) *
            weight;
    }
    return m_volume.index_vector_from_world(mm);
  }

  static void fill_void(RowPlaces& places) {
    for (auto& axis : places.offset) std::fill(axis.begin(), axis.end(), NAN);
  }

  void find_cells(const IndexBox& box) {
    const int first = m_vectors.box.lo.x;
    const auto nodes_of_row = std::size_t(dims_of(m_vectors.box).x);
    for (auto& row : m_row) row.resize(nodes_of_row + 1);
    m_mm.resize(3 * nodes_of_row);
    for (int i = box.lo.x; i <= box.hi.x; ++i) {
      const NodeStep x = step_to(m_positions.at(i, 0, 0).x, m_last.x);
      m_cell.push_back(x.cell < 0 ? 0 : x.cell - first);
      m_weight.push_back(x.cell < 0 ? NAN : x.weight);
    }
  }

  const GridPositions& m_positions;
  const Geometry& m_volume;
  Vec3i m_last;
  const BlockOf<Vec3f>& m_vectors;
  bool m_is_aligned;
  std::array<Vec3d, 3> m_to_index;  // of 1 mm along L, P and S
  std::vector<int> m_cell;          // of a row's voxels, from the first node of the part
  std::vector<double> m_weight;
  std::vector<double> m_mm;  // of a row of nodes
  std::array<std::vector<double>, 3> m_row;
};

bool are_parallel(const GridPositions& positions, const Vec3i& dims) {
  const Vec3d origin = positions.at(0, 0, 0);
  for (int a = 0; a < 3; ++a) {
    Vec3i end(0);
    end[a] = dims[a] - 1;
    Vec3d way = positions.at(end.x, end.y, end.z) - origin;
    way[a] = 0;
    if (way.length() > kParallel) return false;
  }
  return true;
}

}  // namespace

BlockWarp::BlockWarp(const Geometry& volume, const Geometry& target,
                     const std::optional<Geometry>& field)
    : m_volume(volume),
      m_target(target),
      m_field(field),
      m_in_volume(target, volume),
      m_in_field(target, field.value_or(volume)),
      m_is_same_grid(volume == target),
      m_is_aligned(are_parallel(m_in_field, target.dims())) {}

Vec3d BlockWarp::offset_of(const Vec3f& vector_mm) const {
  return m_volume.index_vector_from_world(Vec3d(vector_mm));
}

IndexBox BlockWarp::nodes_of(const IndexBox& box) const {
  if (!m_field) return {};
  const RealBox places = places_of(m_in_field, box);
  IndexBox nodes;
  for (int a = 0; a < 3; ++a) {
    const int last = m_field->dims()[a] - 1;
    nodes.lo[a] = int(std::clamp(std::floor(places.lo[a]), 0.0, double(last) + 1));
    nodes.hi[a] = int(std::clamp(std::floor(places.hi[a]) + 1, -1.0, double(last)));
    nodes.lo[a] = std::min(nodes.lo[a], std::max(nodes.hi[a] - 1, 0));
  }
  return nodes.empty() ? IndexBox() : nodes;
}

IndexBox BlockWarp::voxels_of(const IndexBox& box, const BlockOf<Vec3f>& vectors) const {
  RealBox read = places_of(m_in_volume, box);
  if (m_field) {
    // A place between nodes moves to between the places of these, as it lies between them.
    const IndexBox nodes = nodes_of(box);
    require_within("field", nodes, vectors.box);
    RealBox offsets, moved;
    const GridPositions places(*m_field, m_volume);
    for (int z = nodes.lo.z; z <= nodes.hi.z; ++z) {
      for (int y = nodes.lo.y; y <= nodes.hi.y; ++y) {
        for (int x = nodes.lo.x; x <= nodes.hi.x; ++x) {
          const Vec3d o = offset_of(vectors.values[index_in(vectors.box, x, y, z)]);
          if (!std::isfinite(o.x + o.y + o.z)) continue;  // void
          offsets.add(o);
          moved.add(places.at(x, y, z) + o);
        }
      }
    }
    for (int a = 0; a < 3; ++a) {
      read.lo[a] = std::max(read.lo[a] + offsets.lo[a], moved.lo[a]);
      read.hi[a] = std::min(read.hi[a] + offsets.hi[a], moved.hi[a]);
    }
  }
  IndexBox voxels;
  for (int a = 0; a < 3; ++a) {
    const int last = m_volume.dims()[a] - 1;
    if (!(read.hi[a] >= -1 && read.lo[a] <= last + 1)) return {};
    const double lo = std::floor(read.lo[a] - kRoundingOfPlaces);
    const double hi = std::floor(read.hi[a] + kRoundingOfPlaces) + 1;
    voxels.lo[a] = int(std::clamp(lo, 0.0, std::max(last - 1.0, 0.0)));
    voxels.hi[a] = int(std::clamp(hi, std::min(voxels.lo[a] + 1.0, double(last)), double(last)));
  }
  return voxels;
}

template <class T>
void BlockWarp::resample(const IndexBox& box, const BlockOf<Vec3f>& vectors,
                         const BlockOf<T>& source, bool is_nearest, double fill, T* out) const {
  if (m_field) require_within("field", nodes_of(box), vectors.box);
  const Vec3i dims = dims_of(box);
  const auto count = std::size_t(dims.x);
  if (source.box.empty()) {
    require_within("source", voxels_of(box, vectors), source.box);
    std::fill(out, out + count * std::size_t(dims.y) * std::size_t(dims.z), stored_as<T>(fill));
    return;
  }
  RowPlaces places(count);
  std::optional<RowOffsets> offsets;
  if (m_field) offsets.emplace(m_in_field, m_volume, *m_field, vectors, m_is_aligned);
  const RowSource<T> reader(source, m_volume.dims(), fill);
  for (int k = box.lo.z; k <= box.hi.z; ++k) {
    for (int j = box.lo.y; j <= box.hi.y; ++j) {
      if (offsets) offsets->fill(box, j, k, places);
      place_row(box, j, k, places);
      if (!reader.read(places, is_nearest, out)) {
        require_within("source", voxels_of(box, vectors), source.box);
        throw std::logic_error("a block reads more than voxels_of() says");
      }
      out += count;
    }
  }
}

void BlockWarp::place_row(const IndexBox& box, int j, int k, RowPlaces& places) const {
  for (std::size_t n = 0; n < places.count; ++n) {
    const int i = box.lo.x + int(n);
    const Vec3d place = m_is_same_grid ? Vec3d(i, j, k) : m_in_volume.at(i, j, k);
    for (int a = 0; a < 3; ++a) places.place[a][n] = place[a];
  }
}

#define SUPPLE_BLOCKS_OF(T)                                                                    \
  template void BlockWarp::resample(const IndexBox&, const BlockOf<Vec3f>&, const BlockOf<T>&, \
                                    bool, double, std::add_pointer_t<T>) const;
SUPPLE_BLOCKS_OF(std::int8_t)
SUPPLE_BLOCKS_OF(std::uint8_t)
SUPPLE_BLOCKS_OF(std::int16_t)
SUPPLE_BLOCKS_OF(std::uint16_t)
SUPPLE_BLOCKS_OF(std::int32_t)
SUPPLE_BLOCKS_OF(std::uint32_t)
SUPPLE_BLOCKS_OF(std::int64_t)
SUPPLE_BLOCKS_OF(std::uint64_t)
SUPPLE_BLOCKS_OF(float)
SUPPLE_BLOCKS_OF(double)
#undef SUPPLE_BLOCKS_OF

}  // namespace supple
