// The OpenVDB side of the state file (design.md section 7). OpenVDB 10's io::File loses errors on
// full disks and truncated files, so this is io::Stream over an fstream that throws, never delayed.
//
// Grids, in this order: `q` (Vec3I, only voxels that moved), `element` (Bool), `density` (Float),
// `rest_i`, `rest_j`, `rest_k` (Vec3I, only where links to the next voxel have flowed), `velocity`
// (Vec3D, mm/s LPS, only where something moves), `cut_links`
// (Int32, only when links are cut; bits 0, 1, 2: the link to the next voxel along i, j, k is
// absent; bits 3 to 11, 12 to 20, 21 to 29: where along it, LinkCuts::Place), `label` (Int32, only
// when there are any; 1 to 65535), `piece` (Int32, only when there are rigid pieces, from 1, whose
// poses are metadata), and derived for other programs `displacement` (Vec3S, material direction,
// extended over the shell) and `offset` (Vec3S, resample direction), in mm LPS. Those before stay
// in index space; the others carry the affine where OpenVDB takes it, and neither they nor what
// follows them is read back. The nodes of all trees are those of bricks, so that the file depends
// on the content alone.
//
// Cost with Blosc, 3.5 million elements that all moved, one core: 0.5 s and 46 MB to write (0.75 s
// and 69 MB with offsets), 0.25 s to read.
#include <algorithm>

#include "volumes/base/atomic_file.h"
#include "volumes/geometry/geometry_text.h"
#include "volumes/grid/density_grid_vdb.h"
#include "volumes/grid/labels.h"
#include "volumes/io/vdb/vdb_seal.h"
#include "volumes/io/vdb/vdb_stream.h"
#include "volumes/state/anchor_text.h"
#include "volumes/state/state.h"

namespace supple {

namespace {

using openvdb::BoolGrid;
using openvdb::FloatGrid;
using openvdb::Int32Grid;
using openvdb::Vec3DGrid;
using openvdb::Vec3IGrid;
using openvdb::Vec3SGrid;

constexpr const char* kFormatVersion = "state 1";

// Grids that are derived from the others, for other programs. They come last, are three quarters of
// the values of a dragged body, and are not read.
constexpr const char* kDisplacementGrid = "displacement";
constexpr const char* kOffsetGrid = "offset";

constexpr const char* kVelocityGrid = "velocity";

bool is_derived(const std::string& name) {
  return name == kDisplacementGrid || name == kOffsetGrid;
}

/// Three integers per element, of which at least one is not 0.
openvdb::GridBase::Ptr make_fixed(const std::string& name, const State& state,
                                  const std::array<BrickValues, 3>& values) {
  return make_vdb_grid<Vec3IGrid>(name.c_str(), state.elements, openvdb::Vec3i(0),
                                  [&](auto& leaf, std::size_t b) {
                                    const std::int32_t* x = values[0].brick_or_zero(b);
                                    const std::int32_t* y = values[1].brick_or_zero(b);
                                    const std::int32_t* z = values[2].brick_or_zero(b);
                                    for_each_active(state.elements.mask(b), [&](int offset) {
                                      const openvdb::Vec3i value(x[offset], y[offset], z[offset]);
                                      if (value != openvdb::Vec3i(0))
                                        leaf.setValueOn(openvdb::Index(offset), value);
                                    });
                                  });
}

openvdb::GridBase::Ptr make_velocity(const State& state) {
  const Velocities& velocity = state.velocity_mm_s;
  return make_vdb_grid<Vec3DGrid>(
      kVelocityGrid, state.elements, openvdb::Vec3d(0), [&](auto& leaf, std::size_t b) {
        for_each_active(state.elements.mask(b), [&](int offset) {
          const std::size_t slot = b * kBrickVoxels + std::size_t(offset);
          const openvdb::Vec3d value(velocity[0].at(slot), velocity[1].at(slot),
                                     velocity[2].at(slot));
          if (value != openvdb::Vec3d(0)) leaf.setValueOn(openvdb::Index(offset), value);
        });
      });
}

template <class T>
bool is_empty(const std::array<BrickArray<T>, 3>& values) {
  return std::all_of(values.begin(), values.end(), [](const auto& c) { return c.empty(); });
}

openvdb::GridBase::Ptr make_element_mask(const State& state) {
  return make_vdb_grid<BoolGrid>("element", state.elements, false, [&](auto& leaf, std::size_t b) {
    for_each_active(state.elements.mask(b),
                    [&](int offset) { leaf.setValueOn(openvdb::Index(offset), true); });
  });
}

/// The state's own tree: nothing writes to it, and its nodes are those of its bricks. A tree with
/// other nodes, such as leaves without active voxels, is built anew.
openvdb::GridBase::Ptr make_density(const DensityGrid& density) {
  const FloatGrid& own = *vdb_grid(density);
  if (own.tree().leafCount() == density.bricks().brick_count()) {
    const auto tree = openvdb::ConstPtrCast<FloatGrid::TreeType>(own.constTreePtr());
    auto grid = make_grid<FloatGrid>(density.background());
    grid->setTree(tree);
    grid->setName("density");
    return grid;
  }
  return make_vdb_grid<FloatGrid>("density", density.bricks(), density.background(),
                                  [&](auto& leaf, std::size_t b) {
                                    const float* values = density.values(b);
                                    for_each_active(density.bricks().mask(b), [&](int offset) {
                                      leaf.setValueOn(openvdb::Index(offset), values[offset]);
                                    });
                                  });
}

/// The lowest bit of the place of a cut link.
int place_shift(int axis) {
  return 3 + 9 * axis;
}

openvdb::GridBase::Ptr make_cut_links(const State& state) {
  return make_vdb_grid<Int32Grid>("cut_links", state.elements, 0, [&](auto& leaf, std::size_t b) {
    const LinkCuts::BrickCuts* cuts = state.cuts.brick(b);
    if (cuts == nullptr) return;
    for (int offset = 0; offset < kBrickVoxels; ++offset) {
      int bits = 0;
      for (int axis = 0; axis < 3; ++axis) {
        if (!mask_test((*cuts)[axis], offset)) continue;
        bits |= 1 << axis | state.cuts.place(b, offset, axis) << place_shift(axis);
      }
      if (bits != 0) leaf.setValueOn(openvdb::Index(offset), bits);
    }
  });
}

openvdb::GridBase::Ptr make_numbers(const char* name, const State& state,
                                    const BrickValues& numbers) {
  return make_vdb_grid<Int32Grid>(name, state.elements, 0, [&](auto& leaf, std::size_t b) {
    const std::int32_t* values = numbers.brick_or_zero(b);
    for (int offset = 0; offset < kBrickVoxels; ++offset) {
      if (values[offset] != 0) leaf.setValueOn(openvdb::Index(offset), values[offset]);
    }
  });
}

/// A vector field in voxels of the index frame as a grid in mm LPS.
openvdb::GridBase::Ptr make_vectors(const char* name, const char* direction,
                                    const VectorBricks& field, const Geometry& geometry) {
  auto grid = make_vdb_grid<Vec3SGrid>(
      name, field.topology, openvdb::Vec3f(0), [&](auto& leaf, std::size_t b) {
        for_each_active(field.topology.mask(b), [&](int offset) {
          const Vec3f& v = field.vectors[b * kBrickVoxels + offset];
          const Vec3f mm(geometry.world_vector_from_index(Vec3d(v)));
          leaf.setValueOn(openvdb::Index(offset), openvdb::Vec3f(mm.x, mm.y, mm.z));
        });
      });
  grid->setVectorType(openvdb::VEC_CONTRAVARIANT_RELATIVE);
  grid->insertMeta("direction", openvdb::StringMetadata(direction));
  grid->insertMeta("units", openvdb::StringMetadata("mm"));
  grid->insertMeta("frame", openvdb::StringMetadata("LPS"));
  attach_affine(*grid, geometry);
  return grid;
}

openvdb::MetaMap make_metadata(const State& state) {
  openvdb::MetaMap metadata;
  const auto insert = [&](const std::string& name, const std::string& text) {
    metadata.insertMeta(kStateMetadataPrefix + name, openvdb::StringMetadata(text));
  };
  insert("format", kFormatVersion);
  insert("anchors", anchors_to_json({state.anchors, state.anchor_labels, state.anchor_selections}));
  insert("configuration", state.configuration);
  insert("frame", "LPS");
  insert("geometry", geometry_to_json(state.geometry));
  insert("material", state.material_toml);
  if (!state.piece_texts.empty()) insert("pieces", pieces_to_json(state.piece_texts));
  insert("source_name", state.source_name);
  insert("source_type", state.source_type);
  insert("units", "mm");
  return metadata;
}

void write_file(const std::string& path, const State& state, const OffsetField* offsets,
                Progress* progress) {
  if (progress != nullptr) progress->stage("writing state");
  check_state(state, path);
  openvdb::GridCPtrVec grids = {make_fixed("q", state, state.q), make_element_mask(state),
                                make_density(state.density)};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (is_empty(state.rest[axis])) continue;
    grids.push_back(make_fixed(rest_name(int(axis)), state, state.rest[axis]));
  }
  if (!is_empty(state.velocity_mm_s)) grids.push_back(make_velocity(state));
  if (!state.cuts.empty()) grids.push_back(make_cut_links(state));
  if (!label_counts(state.labels).empty())
    grids.push_back(make_numbers("label", state, state.labels));
  if (!state.piece_texts.empty()) grids.push_back(make_numbers("piece", state, state.pieces));
  grids.push_back(make_vectors(kDisplacementGrid, "material", extended_displacement_of(state).u,
                               state.geometry));
  if (offsets != nullptr) {
    grids.push_back(make_vectors(kOffsetGrid, "resample", offsets->o, offsets->geometry));
  }
  report(progress, 0.3);

  AtomicFile file(path);
  write_vdb_stream(file, grids, make_metadata(state));
  report(progress, 0.8);
  seal_vdb(file.path(), VdbKind::state);
  file.commit();
  report(progress, 1);
}

std::string text_of(const VdbContent& content, const std::string& name, const std::string& path) {
  const auto text =
      content.metadata.getMetadata<openvdb::StringMetadata>(kStateMetadataPrefix + name);
  if (!text) throw InputError({path, kStateMetadataPrefix + name, "nothing", "metadata text"});
  return text->value();
}

bool has_grid(const VdbContent& content, const std::string& name) {
  return std::any_of(content.grids.begin(), content.grids.end(),
                     [&](const auto& grid) { return grid->getName() == name; });
}

/// The grid of that name and type, all its active voxels in leaves inside the box of `geometry`.
template <class Grid>
typename Grid::Ptr grid_of(const VdbContent& content, const std::string& name,
                           const Geometry& geometry, const std::string& path) {
  typename Grid::Ptr grid;
  for (const openvdb::GridBase::Ptr& candidate : content.grids) {
    if (candidate->getName() == name) grid = openvdb::gridPtrCast<Grid>(candidate);
  }
  if (!grid) throw InputError({path, "grid " + name, "nothing", "a grid of " + Grid::gridType()});
  const openvdb::GridBase& any = *grid;  // calls of its own type would compile these functions here
  if (any.constBaseTree().activeTileCount() != 0) {
    throw InputError({path, "grid " + name, "active tiles", "single voxels"});
  }
  const Vec3i& dims = geometry.dims();
  const openvdb::CoordBBox box(openvdb::Coord(0), to_coord(dims - Vec3i(1)));
  const openvdb::CoordBBox bounds = any.evalActiveVoxelBoundingBox();
  if (!any.empty() && !bounds.empty() && !box.isInside(bounds)) {
    throw InputError({path, "grid " + name, "voxels outside the volume", "voxels inside its box"});
  }
  return grid;
}

BrickTopology bricks_of(const BoolGrid& grid) {
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) {
    origins.push_back(to_vec(leaf->origin()));
    masks.emplace_back();
    for (int word = 0; word < 8; ++word) {
      masks.back()[word] = leaf->valueMask().getWord<openvdb::Index64>(word);
    }
  }
  return {std::move(origins), std::move(masks)};
}

/// Densities with the background in every inactive slot, as DensityGrid promises.
DensityGrid density_of(const FloatGrid::Ptr& grid) {
  const float background = grid->background();
  for (auto leaf = grid->tree().beginLeaf(); leaf; ++leaf) {
    for (auto value = leaf->beginValueOff(); value; ++value) value.setValue(background);
  }
  return DensityGrid(std::make_shared<DensityGrid::Vdb>(DensityGrid::Vdb{grid}));
}

/// Three numbers per element, from a grid of vectors.
template <class Grid, class T>
void read_vectors(const Grid& grid, const State& state, std::array<BrickArray<T>, 3>& values,
                  const std::string& path) {
  for (auto& c : values) c.resize(state.elements.brick_count());
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) {
    const std::int32_t b = state.elements.find(to_vec(leaf->origin()));
    for (auto value = leaf->cbeginValueOn(); value; ++value) {
      if (b < 0 || !mask_test(state.elements.mask(b), int(value.pos()))) {
        throw InputError(
            {path, "grid " + grid.getName(), "a value without element", "values on elements only"});
      }
      for (int c = 0; c < 3; ++c) {
        if ((*value)[c] == 0) continue;
        values[std::size_t(c)].set(std::size_t(b) * kBrickVoxels + value.pos(), (*value)[c]);
      }
    }
  }
  for (auto& c : values) {
    if (c.empty()) c.clear();
  }
}

/// The links themselves are for check_state to judge.
/// Whether some link is cut, and a place only given for those that are.
bool is_cut_record(std::int32_t bits) {
  bool is_valid = bits > 0 && bits >> place_shift(3) == 0 && (bits & 7) != 0;
  for (int axis = 0; axis < 3; ++axis) {
    const bool has_place = (bits >> place_shift(axis) & LinkCuts::kPlaces) != 0;
    is_valid = is_valid && (!has_place || (bits >> axis & 1) != 0);
  }
  return is_valid;
}

void read_cut_links(const Int32Grid& grid, State& state, const std::string& path) {
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) {
    const std::int32_t b = state.elements.find(to_vec(leaf->origin()));
    for (auto value = leaf->cbeginValueOn(); value; ++value) {
      if (!is_cut_record(*value)) {
        throw InputError({path, "grid cut_links", std::to_string(*value),
                          "bits 1 to 7, and places of the links that these name"});
      }
      if (b < 0) {
        throw InputError(
            {path, "grid cut_links", "a cut without element", "cuts between elements"});
      }
      for (int axis = 0; axis < 3; ++axis) {
        if (!(*value >> axis & 1)) continue;
        const int place = *value >> place_shift(axis) & LinkCuts::kPlaces;
        state.cuts.cut(std::size_t(b), int(value.pos()), axis, LinkCuts::Place(place));
      }
    }
  }
}

/// Labels or pieces; the numbers themselves are for check_state to judge.
void read_numbers(const Int32Grid& grid, const State& state, BrickValues& numbers,
                  const std::string& path) {
  numbers.resize(state.elements.brick_count());
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) {
    const std::int32_t b = state.elements.find(to_vec(leaf->origin()));
    for (auto value = leaf->cbeginValueOn(); value; ++value) {
      if (b < 0 || *value == 0) {
        const std::string name = grid.getName();
        throw InputError({path, "grid " + name, b < 0 ? "a " + name + " without element" : "0",
                          name + "s from 1 at elements only"});
      }
      numbers.set(std::size_t(b) * kBrickVoxels + value.pos(), *value);
    }
  }
}

}  // namespace

void write_state(const std::string& path, const State& state, Progress* progress) {
  write_file(path, state, nullptr, progress);
}

void write_state(const std::string& path, const State& state, const OffsetField& offsets,
                 Progress* progress) {
  write_file(path, state, &offsets, progress);
}

State read_state(const std::string& path, Progress* progress) {
  if (progress != nullptr) progress->stage("reading state");
  verify_vdb_seal(path, VdbKind::state);
  report(progress, 0.3);
  initialize_vdb();
  const VdbContent content = read_vdb_grids(path, is_derived);
  report(progress, 0.8);

  const std::string format = text_of(content, "format", path);
  if (format != kFormatVersion) {
    throw InputError({path, "format", format.substr(0, 80), kFormatVersion});
  }
  State state;
  state.geometry = geometry_from_json(text_of(content, "geometry", path), path);
  Anchors anchors = anchors_from_json(text_of(content, "anchors", path), path);
  state.anchors = std::move(anchors.boxes);
  state.anchor_labels = std::move(anchors.labels);
  state.anchor_selections = std::move(anchors.selections);
  state.material_toml = text_of(content, "material", path);
  state.configuration = text_of(content, "configuration", path);
  state.source_name = text_of(content, "source_name", path);
  state.source_type = text_of(content, "source_type", path);
  state.density = density_of(grid_of<FloatGrid>(content, "density", state.geometry, path));
  state.elements = bricks_of(*grid_of<BoolGrid>(content, "element", state.geometry, path));
  read_vectors(*grid_of<Vec3IGrid>(content, "q", state.geometry, path), state, state.q, path);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string name = rest_name(int(axis));
    if (!has_grid(content, name)) continue;
    read_vectors(*grid_of<Vec3IGrid>(content, name, state.geometry, path), state, state.rest[axis],
                 path);
  }
  if (has_grid(content, kVelocityGrid)) {
    read_vectors(*grid_of<Vec3DGrid>(content, kVelocityGrid, state.geometry, path), state,
                 state.velocity_mm_s, path);
  }
  if (has_grid(content, "cut_links")) {
    read_cut_links(*grid_of<Int32Grid>(content, "cut_links", state.geometry, path), state, path);
  }
  if (has_grid(content, "label")) {
    read_numbers(*grid_of<Int32Grid>(content, "label", state.geometry, path), state, state.labels,
                 path);
  }
  if (has_grid(content, "piece")) {
    read_numbers(*grid_of<Int32Grid>(content, "piece", state.geometry, path), state, state.pieces,
                 path);
    state.piece_texts = pieces_from_json(text_of(content, "pieces", path), path);
  }
  check_state(state, path);
  report(progress, 1);
  return state;
}

bool is_state_file(const std::string& path) {
  return vdb_kind(path) == VdbKind::state;
}

}  // namespace supple
