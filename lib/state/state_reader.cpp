// Reads state files: the grids of state_grids.h, checked, as a State.
#include <algorithm>

#include "lib/state/anchor_text.h"
#include "lib/state/own_bricks.h"
#include "lib/state/state_grids.h"
#include "volumes/base/text.h"
#include "volumes/geometry/geometry_text.h"
#include "volumes/grid/density_grid_vdb.h"
#include "volumes/io/vdb/vdb_seal.h"
#include "volumes/io/vdb/vdb_stream.h"

namespace supple {

namespace {

std::string text_of(const openvdb::MetaMap& metadata, const std::string& name,
                    const std::string& path) {
  const auto text = metadata.getMetadata<openvdb::StringMetadata>(kStateMetadataPrefix + name);
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

BrickTopology bricks_of(const openvdb::BoolGrid& grid) {
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
DensityGrid density_of(const openvdb::FloatGrid::Ptr& grid) {
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

/// True if some link is cut, and a place only given for those that are. The links themselves are
/// for check_state to judge.
bool is_cut_record(std::int32_t bits) {
  bool is_valid = bits > 0 && bits >> place_shift(3) == 0 && (bits & 7) != 0;
  for (int axis = 0; axis < 3; ++axis) {
    const bool has_place = (bits >> place_shift(axis) & LinkCuts::kPlaces) != 0;
    is_valid = is_valid && (!has_place || (bits >> axis & 1) != 0);
  }
  return is_valid;
}

void read_cut_links(const openvdb::Int32Grid& grid, State& state, const std::string& path) {
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

/// Labels or pieces; the numbers themselves are for check_state to judge. `is_part`: of the
/// elements some are not there, and their numbers are passed over.
void read_numbers(const openvdb::Int32Grid& grid, const State& state, bool is_part,
                  BrickValues& numbers, const std::string& path) {
  numbers.resize(state.elements.brick_count());
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) {
    const std::int32_t b = state.elements.find(to_vec(leaf->origin()));
    if (b < 0 && is_part) continue;
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

/// True if the densities of a state lie elsewhere, by its format.
bool refers(const openvdb::MetaMap& metadata, const std::string& path) {
  const std::string format = text_of(metadata, "format", path);
  if (format == kReferringFormat) return true;
  if (format == kStateFormat) return false;
  throw InputError({path, "format", format.substr(0, 80),
                    std::string(kStateFormat) + " or " + kReferringFormat});
}

void read_texts(const openvdb::MetaMap& metadata, State& state, const std::string& path) {
  const auto text = [&](const char* name) { return text_of(metadata, name, path); };
  state.geometry = geometry_from_json(text("geometry"), path);
  Anchors anchors = anchors_from_json(text("anchors"), path);
  state.anchors = std::move(anchors.boxes);
  state.anchor_labels = std::move(anchors.labels);
  state.anchor_selections = std::move(anchors.selections);
  if (metadata[kStateMetadataPrefix + std::string("bodies")]) {
    state.meshes = tables_from_json(text("bodies"), "bodies", path);
  }
  state.material_toml = text("material");
  state.configuration = text("configuration");
  state.source_name = text("source_name");
  state.source_type = text("source_type");
}

BrickIndex own_bricks_of(const VdbContent& content, const Geometry& geometry,
                         const std::string& path) {
  BrickIndex own;
  const auto grid = grid_of<openvdb::BoolGrid>(content, kOwnGrid, geometry, path);
  for (auto place = grid->cbeginValueOn(); place; ++place) {
    own.add(to_vec(place.getCoord()) * kBrickDim);
  }
  return own;
}

/// Anchors may lie beyond the bricks that are there.
void forget_anchors(State& state) {
  state.anchors.clear();
  state.anchor_labels.clear();
  state.anchor_selections.clear();
}

enum class WithoutSource { refuse, read_own_bricks };

/// Adds what a state takes from its source. True: that is not there, and is done without.
bool complete_by_source(State& state, const VdbContent& content, WithoutSource without,
                        const std::string& path, Progress* progress) {
  StateSource source = source_from_json(text_of(content.metadata, "source", path), path);
  const BrickIndex own = own_bricks_of(content, state.geometry, path);
  bool is_part = false;
  try {
    open_source(source, state.geometry, path, progress);
    complete(state, source, own);
  } catch (const InputError& error) {
    if (without == WithoutSource::refuse) throw;
    warn(progress, std::string(error.what()) + "; its own " +
                       with_count(std::int64_t(own.count()), "brick") +
                       " are read alone, beyond which nothing moved");
    forget_anchors(state);
    is_part = true;
  }
  state.source = std::make_shared<const StateSource>(std::move(source));
  return is_part;
}

State read_file(const std::string& path, WithoutSource without, Progress* progress) {
  if (progress != nullptr) progress->stage("reading state");
  verify_vdb_seal(path, VdbKind::state);
  report(progress, 0.3);
  initialize_vdb();
  const VdbContent content = read_vdb_grids(path, VdbTrust::sealed, is_derived_grid);
  report(progress, 0.8);

  const bool has_source = refers(content.metadata, path);
  State state;
  read_texts(content.metadata, state, path);
  state.density =
      density_of(grid_of<openvdb::FloatGrid>(content, kDensityGrid, state.geometry, path));
  state.elements =
      bricks_of(*grid_of<openvdb::BoolGrid>(content, kElementGrid, state.geometry, path));
  const bool is_part = has_source && complete_by_source(state, content, without, path, progress);
  read_vectors(*grid_of<openvdb::Vec3IGrid>(content, kFixedGrid, state.geometry, path), state,
               state.q, path);
  if (has_grid(content, kBeyondGrid)) {
    std::array<BrickValues, 3> beyond;
    read_vectors(*grid_of<openvdb::Vec3IGrid>(content, kBeyondGrid, state.geometry, path), state,
                 beyond, path);
    state.beyond = std::make_shared<const std::array<BrickValues, 3>>(std::move(beyond));
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string name = rest_name(int(axis));
    if (!has_grid(content, name)) continue;
    read_vectors(*grid_of<openvdb::Vec3IGrid>(content, name, state.geometry, path), state,
                 state.rest[axis], path);
  }
  if (has_grid(content, kVelocityGrid)) {
    read_vectors(*grid_of<openvdb::Vec3DGrid>(content, kVelocityGrid, state.geometry, path), state,
                 state.velocity_mm_s, path);
  }
  if (has_grid(content, kCutGrid)) {
    read_cut_links(*grid_of<openvdb::Int32Grid>(content, kCutGrid, state.geometry, path), state,
                   path);
  }
  if (has_grid(content, kLabelGrid)) {
    read_numbers(*grid_of<openvdb::Int32Grid>(content, kLabelGrid, state.geometry, path), state,
                 is_part, state.labels, path);
  }
  if (has_grid(content, kPieceGrid)) {
    read_numbers(*grid_of<openvdb::Int32Grid>(content, kPieceGrid, state.geometry, path), state,
                 is_part, state.pieces, path);
    state.piece_records =
        tables_from_json(text_of(content.metadata, "pieces", path), "pieces", path);
  }
  check_state(state, path);
  report(progress, 1);
  return state;
}

}  // namespace

State read_state(const std::string& path, Progress* progress) {
  return read_file(path, WithoutSource::refuse, progress);
}

State read_reachable_state(const std::string& path, Progress* progress) {
  return read_file(path, WithoutSource::read_own_bricks, progress);
}

std::shared_ptr<const StateSource> source_of_state_file(const std::string& path) {
  if (!is_state_file(path)) return nullptr;
  initialize_vdb();
  try {
    const openvdb::MetaMap metadata = read_vdb_metadata(path);
    if (!refers(metadata, path)) return nullptr;
    return std::make_shared<const StateSource>(
        source_from_json(text_of(metadata, "source", path), path));
  } catch (const InputError&) {
    return nullptr;
  }
}

bool is_state_file(const std::string& path) {
  return vdb_kind(path) == VdbKind::state;
}

}  // namespace supple
