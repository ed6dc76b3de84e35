// Dense volumes and warps as sparse OpenVDB grids: FloatGrid "density", or Vec3SGrid "offset" or
// "displacement" in mm LPS. The commonest value of uniform bricks becomes the background; every
// voxel that differs from it is active, so that values come back to the bit. The dims, the value
// type and, where OpenVDB refuses it, the affine are metadata; a trailer seals the file.
//
// Renderers want a fog: densities 0 to 1 on a background of 0 (WriteOptions::range), no mirrored
// grid, and the velocity of what they see in a grid "v".
//
// OpenVDB programs expect floats: numbers that no float holds are rounded and counted.
// Cost: the bricks that are not uniform, 4 or 12 bytes per voxel, and a slab of eight slices.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>
#include <type_traits>

#include "volumes/base/error.h"
#include "volumes/base/text.h"
#include "volumes/geometry/geometry_text.h"
#include "volumes/io/bytes/value_type.h"
#include "volumes/io/format/dense_writer.h"
#include "volumes/io/vdb/vdb_seal.h"
#include "volumes/io/vdb/vdb_stream.h"

namespace supple {

namespace {

constexpr double kLeastVoxelVolume = 3e-15;  // openvdb/math/Maps.h

template <class Grid>
class VdbWriter : public DenseWriter {
 public:
  using Value = typename Grid::ValueType;
  using Leaf = typename Grid::TreeType::LeafNodeType;
  using VelocityLeaf = openvdb::Vec3SGrid::TreeType::LeafNodeType;

  VdbWriter(const std::string& path, const DenseImage& image, const WriteOptions& options)
      : m_file(path),
        m_image(image),
        m_options(options),
        m_is_flipped(options.range && image.geometry.determinant() < 0) {
    if (m_is_flipped) m_image.geometry = flipped(image.geometry);
    require_large_voxels(path);
  }

  void write_slice(const void* values) override {
    m_slab.resize(slice_values() * kBrickDim);
    m_numbers.resize(slice_values() * m_image.components);
    to_floats(static_cast<const char*>(values), &m_slab[slice_values() * m_depth]);
    if constexpr (std::is_same_v<Value, float>) finish_fog();
    ++m_depth;
    ++m_next_k;
    if (m_depth == kBrickDim || m_next_k == m_image.geometry.dims().z) flush_slab();
  }

  bool write_bricks(const VectorBricks& vectors) override {
    if constexpr (std::is_same_v<Value, openvdb::Vec3f>) {
      const Vec3i& dims = m_image.geometry.dims();
      for (int k0 = 0; k0 < dims.z; k0 += kBrickDim) {
        for (int j0 = 0; j0 < dims.y; j0 += kBrickDim) {
          for (int i0 = 0; i0 < dims.x; i0 += kBrickDim) take_vectors(vectors, {i0, j0, k0});
        }
      }
      return true;
    }
    return false;
  }

  void commit() override {
    std::vector<OutgoingGrid> grids = {{make_grid(), nullptr}};
    if (m_options.velocity) grids.push_back({make_velocity(), nullptr});
    write_vdb_stream(m_file, grids, make_metadata());
    seal_vdb(m_file.path(), VdbKind::volume);
    m_file.commit();
  }

  std::vector<std::string> warnings() const override {
    if (m_rounded == 0) return {};
    return {std::to_string(m_rounded) + " values were rounded to 32-bit floats"};
  }

 private:
  /// OpenVDB has no map from voxels to smaller ones: their volume counts as none.
  void require_large_voxels(const std::string& path) const {
    const double volume = std::abs(scene_geometry().determinant()), edge = std::cbrt(volume);
    if (m_options.scale == 1 || volume > kLeastVoxelVolume) return;
    const double least = m_options.scale * std::cbrt(kLeastVoxelVolume) / edge;
    throw InputError({path, "scale",
                      number_text(m_options.scale) + ", voxels of " + number_text(edge),
                      "at least " + number_text(least) + " for this volume, a limit of OpenVDB"});
  }

  /// Bricks in a row along i, each of one value.
  struct Uniform {
    Vec3i origin;
    Value value;
    int count;
  };
  /// Values by their bits, so that -0 and NaN are told apart from others.
  struct LessBits {
    bool operator()(const Value& a, const Value& b) const {
      return std::memcmp(&a, &b, sizeof(Value)) < 0;
    }
  };

  std::size_t slice_values() const {
    return std::size_t(m_image.geometry.dims().x) * m_image.geometry.dims().y;
  }

  void to_floats(const char* stored, Value* out) {
    if (m_image.type == ValueType::float32 && m_image.slope == 1 && m_image.intercept == 0) {
      std::memcpy(out, stored, m_numbers.size() * sizeof(float));
      return;
    }
    scale_values_of(m_image.type)(stored, m_numbers.size(), m_image.slope, m_image.intercept,
                                  m_numbers.data());
    float* floats = reinterpret_cast<float*>(out);
    for (std::size_t n = 0; n < m_numbers.size(); ++n) {
      floats[n] = float(m_numbers[n]);
      m_rounded += double(floats[n]) != m_numbers[n] && m_numbers[n] == m_numbers[n];
    }
  }

  /// The grid counted from the other end of i.
  static Geometry flipped(const Geometry& geometry) {
    const auto& axes = geometry.axes_mm();
    return {geometry.dims(),
            geometry.origin_lps_mm() + axes[0] * double(geometry.dims().x - 1),
            {-axes[0], axes[1], axes[2]}};
  }

  template <class T>
  void flip_rows(T* slice) const {
    const Vec3i& dims = m_image.geometry.dims();
    for (int j = 0; m_is_flipped && j < dims.y; ++j) {
      std::reverse(slice + std::size_t(j) * dims.x, slice + std::size_t(j + 1) * dims.x);
    }
  }

  /// The slice just read as 0 to 1, and its velocities.
  void finish_fog() {
    float* const slice = &m_slab[slice_values() * m_depth];
    if (m_options.range) {
      const double lo = m_options.range->first, width = m_options.range->second - lo;
      for (std::size_t n = 0; n < slice_values(); ++n) {
        const double part = (slice[n] - lo) / width;
        slice[n] = part > 0 ? float(std::min(part, 1.0)) : 0.0f;  // NaN is 0, too
      }
    }
    flip_rows(slice);
    if (!m_options.velocity) return;
    m_velocities.resize(slice_values() * kBrickDim);
    m_options.velocity(m_next_k, &m_velocities[slice_values() * m_depth]);
    flip_rows(&m_velocities[slice_values() * m_depth]);
  }

  static bool same(const Value& a, const Value& b) {
    return std::memcmp(&a, &b, sizeof(Value)) == 0;
  }

  void flush_slab() {
    const Vec3i& dims = m_image.geometry.dims();
    const int k0 = m_next_k - m_depth;
    for (int j0 = 0; j0 < dims.y; j0 += kBrickDim) {
      for (int i0 = 0; i0 < dims.x; i0 += kBrickDim) take_brick({i0, j0, k0});
    }
    m_depth = 0;
  }

  /// Part of the brick inside the box.
  Vec3i extent_of(const Vec3i& origin) const {
    const Vec3i& dims = m_image.geometry.dims();
    return {std::min(kBrickDim, dims.x - origin.x), std::min(kBrickDim, dims.y - origin.y),
            std::min(kBrickDim, dims.z - origin.z)};
  }

  template <class Visit>
  void for_each_voxel(const Vec3i& origin, Visit&& visit) const {
    const Vec3i extent = extent_of(origin);
    for (int k = 0; k < extent.z; ++k) {
      for (int j = 0; j < extent.y; ++j) {
        for (int i = 0; i < extent.x; ++i) visit(openvdb::Index((i << 6) | (j << 3) | k), i, j, k);
      }
    }
  }

  void take_brick(const Vec3i& origin) {
    const Vec3i& dims = m_image.geometry.dims();
    const Value* first = &m_slab[std::size_t(origin.y) * dims.x + origin.x];
    if constexpr (std::is_same_v<Value, float>) take_velocities(origin, first);
    take_values(origin, [&](int i, int j, int k) -> const Value& {
      return first[(std::size_t(k) * dims.y + j) * dims.x + i];
    });
  }

  /// Velocities in units of the scene per second, where there is density.
  void take_velocities(const Vec3i& origin, const float* density) {
    if (!m_options.velocity) return;
    const Vec3i& dims = m_image.geometry.dims();
    const Vec3f* first = &m_velocities[std::size_t(origin.y) * dims.x + origin.x];
    auto leaf = std::make_unique<VelocityLeaf>(to_coord(origin), openvdb::Vec3f(0));
    for_each_voxel(origin, [&](openvdb::Index offset, int i, int j, int k) {
      const std::size_t n = (std::size_t(k) * dims.y + j) * dims.x + i;
      if (density[n] == 0) return;
      const Vec3f v = first[n] * float(m_options.scale);
      leaf->setValueOn(offset, openvdb::Vec3f(v.x, v.y, v.z));
    });
    if (!leaf->isEmpty()) m_velocity_leaves.push_back(std::move(leaf));
  }

  openvdb::GridBase::Ptr make_velocity() {
    auto grid = supple::make_grid<openvdb::Vec3SGrid>(openvdb::Vec3f(0));
    for (auto& leaf : m_velocity_leaves) grid->tree().addLeaf(leaf.release());
    grid->setName("v");
    grid->setVectorType(openvdb::VEC_CONTRAVARIANT_RELATIVE);
    attach_affine(*grid, scene_geometry());
    grid->setSaveFloatAsHalf(m_options.half);
    return grid;
  }

  /// In units of the scene.
  Geometry scene_geometry() const {
    const double scale = m_options.scale;
    const auto& axes = m_image.geometry.axes_mm();
    return {m_image.geometry.dims(),
            m_image.geometry.origin_lps_mm() * scale,
            {axes[0] * scale, axes[1] * scale, axes[2] * scale}};
  }

  void take_vectors(const VectorBricks& vectors, const Vec3i& origin) {
    const std::int32_t b = vectors.topology.find(origin);
    const Vec3f* const stored = vectors.vectors.brick(std::size_t(b));
    if (stored == nullptr) {
      add_uniform(origin, Value(0));
      return;
    }
    take_values(origin, [&](int i, int j, int k) {
      const Vec3f& v = stored[(i << 6) | (j << 3) | k];
      return Value(v.x, v.y, v.z);
    });
  }

  void add_uniform(const Vec3i& origin, const Value& value) {
    if (!m_uniform.empty()) {
      Uniform& last = m_uniform.back();
      const Vec3i next = last.origin + Vec3i(kBrickDim * last.count, 0, 0);
      if (next == origin && same(last.value, value)) {
        ++last.count;
        return;
      }
    }
    m_uniform.push_back({origin, value, 1});
  }

  /// `at(i, j, k)`: of the brick.
  template <class At>
  void take_values(const Vec3i& origin, const At& at) {
    const Value first = at(0, 0, 0);
    bool uniform = true;
    for_each_voxel(origin, [&](openvdb::Index, int i, int j, int k) {
      uniform = uniform && same(at(i, j, k), first);
    });
    if (uniform) {
      add_uniform(origin, first);
      return;
    }
    auto leaf = std::make_unique<Leaf>(to_coord(origin), Value(0));
    for_each_voxel(origin, [&](openvdb::Index offset, int i, int j, int k) {
      leaf->setValueOn(offset, at(i, j, k));
    });
    m_leaves.push_back(std::move(leaf));
  }

  Value background() const {
    if (m_options.range) return Value(0);
    std::map<Value, std::size_t, LessBits> counts;
    for (const Uniform& row : m_uniform) counts[row.value] += std::size_t(row.count);
    Value commonest(0);
    std::size_t most = 0;
    for (const auto& [value, count] : counts) {
      if (count <= most || !(value == value)) continue;
      commonest = value;
      most = count;
    }
    return commonest;
  }

  openvdb::GridBase::Ptr make_grid() {
    const Value background_value = background();
    auto grid = supple::make_grid<Grid>(background_value);
    for (const Uniform& row : m_uniform) {
      if (same(row.value, background_value)) continue;
      for (int n = 0; n < row.count; ++n) {
        const Vec3i origin = row.origin + Vec3i(kBrickDim * n, 0, 0);
        auto leaf = std::make_unique<Leaf>(to_coord(origin), background_value);
        for_each_voxel(origin, [&](openvdb::Index offset, int, int, int) {
          leaf->setValueOn(offset, row.value);
        });
        grid->tree().addLeaf(leaf.release());
      }
    }
    for (std::unique_ptr<Leaf>& leaf : m_leaves) {
      for (auto value = leaf->beginValueAll(); value; ++value) {
        if (value.isValueOn() && !same(*value, background_value)) continue;
        value.setValueOff();
        value.setValue(background_value);
      }
      grid->tree().addLeaf(leaf.release());
    }
    describe(*grid);
    return grid;
  }

  void describe(Grid& grid) const {
    attach_affine(grid, scene_geometry());
    grid.setSaveFloatAsHalf(m_options.half);
    const bool is_mm = m_options.scale == 1;
    grid.insertMeta("units", openvdb::StringMetadata(
                                 is_mm ? "mm" : "1/" + number_text(m_options.scale) + " mm"));
    grid.insertMeta("frame", openvdb::StringMetadata("LPS"));
    if (m_image.components == 1) {
      grid.setName("density");
      grid.setGridClass(openvdb::GRID_FOG_VOLUME);
      return;
    }
    grid.setName(m_image.direction == "resample" ? "offset" : "displacement");
    grid.setVectorType(openvdb::VEC_CONTRAVARIANT_RELATIVE);
    grid.insertMeta("direction", openvdb::StringMetadata(m_image.direction));
  }

  openvdb::MetaMap make_metadata() const {
    openvdb::MetaMap metadata;
    const auto insert = [&](const char* name, const std::string& text) {
      metadata.insertMeta(std::string(kVolumeMetadataPrefix) + name, openvdb::StringMetadata(text));
    };
    insert("format", "volume 1");
    insert("geometry", geometry_to_json(m_image.geometry));
    const bool scaled = m_image.slope != 1 || m_image.intercept != 0;
    insert("type", numpy_name(scaled || m_rounded > 0 || m_options.range || m_options.half
                                  ? ValueType::float32
                                  : m_image.type));
    if (!m_image.direction.empty()) insert("direction", m_image.direction);
    if (!m_image.certificate.empty()) insert("certificate", m_image.certificate);
    return metadata;
  }

  AtomicFile m_file;
  DenseImage m_image;
  const WriteOptions m_options;
  const bool m_is_flipped;
  std::vector<Value> m_slab;
  std::vector<double> m_numbers;
  int m_depth = 0;   // slices in the slab
  int m_next_k = 0;  // slices so far
  std::int64_t m_rounded = 0;
  std::vector<Uniform> m_uniform;
  std::vector<std::unique_ptr<Leaf>> m_leaves;
  std::vector<Vec3f> m_velocities;  // of the slab
  std::vector<std::unique_ptr<VelocityLeaf>> m_velocity_leaves;
};

}  // namespace

std::unique_ptr<DenseWriter> create_vdb(const std::string& path, const std::string&,
                                        const DenseImage& image, const WriteOptions& options) {
  if (image.components == 1) {
    return std::make_unique<VdbWriter<openvdb::FloatGrid>>(path, image, options);
  }
  return std::make_unique<VdbWriter<openvdb::Vec3SGrid>>(path, image, options);
}

}  // namespace supple
