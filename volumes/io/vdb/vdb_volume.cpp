// OpenVDB files as volumes: those of vdb_writer.cpp, sealed and with their dims, and fog volumes of
// other programs, whose box is that of the active voxels and whose world frame counts as LPS mm.
// One FloatGrid (scalars) or Vec3SGrid (vectors) is read; of several, the one called "density".
// Cost: the sparse grids of the file and a slab of eight slices.
#include <new>
#include <sstream>

#include <openvdb/tools/Dense.h>

#include "volumes/base/error.h"
#include "volumes/base/process.h"
#include "volumes/geometry/geometry_text.h"
#include "volumes/io/bytes/byte_source.h"
#include "volumes/io/bytes/text_header.h"
#include "volumes/io/bytes/value_type.h"
#include "volumes/io/format/formats.h"
#include "volumes/io/vdb/vdb_seal.h"
#include "volumes/io/vdb/vdb_stream.h"

namespace supple {

namespace {

/// A grid in its box: index `lo` of the grid is voxel (0, 0, 0).
template <class Grid>
class VdbVolume : public VolumeFile {
 public:
  using Value = typename Grid::ValueType;

  VdbVolume(VolumeHeader header, typename Grid::ConstPtr grid, const Vec3i& lo)
      : m_grid(std::move(grid)), m_lo(lo) {
    m_header = std::move(header);
  }

  void read_slice(void* out) override {
    const Vec3i& dims = m_header.geometry.dims();
    const std::size_t slice = std::size_t(dims.x) * dims.y;
    if (m_next_k % kBrickDim == 0) fill_slab();
    const Value* values = &m_slab[slice * (m_next_k % kBrickDim)];
    store_values(m_header.type, reinterpret_cast<const float*>(values), slice * m_header.components,
                 static_cast<char*>(out));
    ++m_next_k;
  }

 private:
  void fill_slab() {
    const Vec3i& dims = m_header.geometry.dims();
    const int depth = std::min(kBrickDim, dims.z - m_next_k);
    m_slab.resize(std::size_t(dims.x) * dims.y * depth);
    const Vec3i lo = m_lo + Vec3i(0, 0, m_next_k);
    const openvdb::CoordBBox box(to_coord(lo),
                                 to_coord(lo + Vec3i(dims.x - 1, dims.y - 1, depth - 1)));
    openvdb::tools::Dense<Value, openvdb::tools::LayoutXYZ> dense(box, m_slab.data());
    openvdb::tools::copyToDense(*m_grid, dense);
  }

  typename Grid::ConstPtr m_grid;
  Vec3i m_lo;
  std::vector<Value> m_slab;
  int m_next_k = 0;
};

std::string names_of(const openvdb::GridPtrVec& grids) {
  std::string names;
  for (const openvdb::GridBase::Ptr& grid : grids) {
    names += (names.empty() ? "" : ", ") + grid->getName() + " (" + grid->valueType() + ")";
  }
  return names.empty() ? "no grid" : printable(names);
}

bool is_readable(const openvdb::GridBase& grid) {
  return grid.isType<openvdb::FloatGrid>() || grid.isType<openvdb::Vec3SGrid>();
}

openvdb::GridBase::Ptr choose_grid(const openvdb::GridPtrVec& grids, const std::string& path) {
  openvdb::GridBase::Ptr only, density;
  int count = 0, densities = 0;
  for (const openvdb::GridBase::Ptr& grid : grids) {
    if (!is_readable(*grid)) continue;
    only = grid;
    ++count;
    if (grid->getName() != "density") continue;
    density = grid;
    ++densities;
  }
  if (count == 1) return only;
  if (densities > 1) {
    throw InputError(
        {path, "grids", names_of(grids) + ": two grids called density", "one of them"});
  }
  if (density != nullptr) return density;
  throw InputError({path, "grids", names_of(grids), "one grid of floats, or one called density"});
}

std::string text_of(const openvdb::MetaMap& metadata, const std::string& name) {
  const auto text = metadata.getMetadata<openvdb::StringMetadata>(name);
  return text ? text->value() : "";
}

/// Dims and place of a grid that says nothing but its transform: the box of its active voxels.
Geometry geometry_of_grid(const openvdb::GridBase& grid, const std::string& path, Vec3i& lo) {
  const openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
  if (box.empty()) throw InputError({path, "grid", "no active voxel", "a grid with values"});
  if (!grid.transform().isLinear()) {
    throw InputError({path, "transform", grid.transform().mapType(), "a linear transform"});
  }
  lo = to_vec(box.min());
  std::array<std::int64_t, 3> sizes;
  std::string text;
  for (int a = 0; a < 3; ++a) {
    sizes[a] = std::int64_t(box.max()[a]) - box.min()[a] + 1;
    text += std::to_string(sizes[a]) + " ";
  }
  const Vec3i dims = dims_from({path, "active box", text}, {sizes[0], sizes[1], sizes[2]});
  const auto world = [&](const openvdb::Vec3d& index) {
    const openvdb::Vec3d place = grid.transform().indexToWorld(index);
    return Vec3d(place.x(), place.y(), place.z());
  };
  const openvdb::Vec3d first = box.min().asVec3d();
  const Vec3d origin = world(first);
  return make_geometry(path, dims, origin,
                       {world(first + openvdb::Vec3d(1, 0, 0)) - origin,
                        world(first + openvdb::Vec3d(0, 1, 0)) - origin,
                        world(first + openvdb::Vec3d(0, 0, 1)) - origin});
}

/// Reads what our own writer records beside the grid.
void read_metadata(const openvdb::MetaMap& metadata, VolumeHeader& header) {
  const std::string prefix = kVolumeMetadataPrefix;
  header.geometry = geometry_from_json(text_of(metadata, prefix + "geometry"), header.path);
  const std::string type = text_of(metadata, prefix + "type");
  if (!find_numpy_type(type, header.type)) {
    throw InputError({header.path, "type", printable(type), "a type such as int16"});
  }
  header.warp_direction = text_of(metadata, prefix + "direction");
  header.certificate = text_of(metadata, prefix + "certificate");
}

template <class Grid>
std::unique_ptr<VolumeFile> open_grid(VolumeHeader header, const openvdb::GridBase::Ptr& grid,
                                      const Vec3i& lo) {
  return std::make_unique<VdbVolume<Grid>>(std::move(header), openvdb::gridPtrCast<Grid>(grid), lo);
}

VdbContent all_grids(const std::string& path, VdbTrust trust) {
  return read_vdb_grids(path, trust, [](const std::string&) { return false; });
}

/// No checksum vouches for the lengths that such a file claims: OpenVDB allocates strings of 4 GiB,
/// and writes past its buffers before it finds out. So the file is read twice.
VdbContent foreign_grids(const std::string& path) {
  constexpr std::int64_t kLeast = std::int64_t(256) << 20, kMost = std::int64_t(1) << 40;
  constexpr std::int64_t kBytesPerSecond = 16 << 20;
  const std::int64_t bytes = InputFile(path).size();
  const ChildBounds bounds{kLeast + std::min(256 * bytes, kMost), int(3 + bytes / kBytesPerSecond)};
  run_in_child({path, "grids", "", "intact OpenVDB grids"}, bounds, [&] {
    try {
      all_grids(path, VdbTrust::foreign);
    } catch (const SystemError&) {  // out of memory
      throw std::bad_alloc();
    }
  });
  return all_grids(path, VdbTrust::foreign);
}

}  // namespace

std::unique_ptr<VolumeFile> open_vdb(const std::string& path) {
  const VdbKind kind = vdb_kind(path);
  if (kind == VdbKind::state) {
    throw InputError({path, "format", "a deformed body",
                      "a volume (supple resample and supple export make one of it)"});
  }
  if (kind == VdbKind::volume) verify_vdb_seal(path, kind);
  initialize_vdb();
  const VdbContent content =
      kind == VdbKind::volume ? all_grids(path, VdbTrust::sealed) : foreign_grids(path);
  const openvdb::GridBase::Ptr grid = choose_grid(content.grids, path);

  VolumeHeader header;
  header.path = path;
  header.format = "vdb";
  header.type = ValueType::float32;
  header.components = grid->isType<openvdb::FloatGrid>() ? 1 : 3;
  Vec3i lo(0, 0, 0);
  if (kind == VdbKind::volume) {
    read_metadata(content.metadata, header);
  } else {
    header.geometry = geometry_of_grid(*grid, path, lo);
    header.warp_direction = text_of(*grid, "direction");
  }
  if (header.components == 1) return open_grid<openvdb::FloatGrid>(std::move(header), grid, lo);
  return open_grid<openvdb::Vec3SGrid>(std::move(header), grid, lo);
}

}  // namespace supple
