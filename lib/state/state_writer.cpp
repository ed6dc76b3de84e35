// Writes state files: a State as the grids of state_grids.h, sealed and renamed at the end.
#include <algorithm>

#include "lib/state/anchor_text.h"
#include "lib/state/own_bricks.h"
#include "lib/state/state_grids.h"
#include "volumes/base/atomic_file.h"
#include "volumes/base/json.h"
#include "volumes/geometry/geometry_text.h"
#include "volumes/grid/density_grid_vdb.h"
#include "volumes/grid/labels.h"
#include "volumes/io/vdb/vdb_seal.h"
#include "volumes/io/vdb/vdb_stream.h"

namespace supple {

namespace {

/// Three integers per element, of which at least one is not 0.
openvdb::GridBase::Ptr make_fixed(const std::string& name, const State& state,
                                  const std::array<BrickValues, 3>& values) {
  return make_vdb_grid<openvdb::Vec3IGrid>(
      name.c_str(), state.elements, openvdb::Vec3i(0), [&](auto& leaf, std::size_t b) {
        const std::int32_t* x = values[0].brick_or_zero(b);
        const std::int32_t* y = values[1].brick_or_zero(b);
        const std::int32_t* z = values[2].brick_or_zero(b);
        for_each_active(state.elements.mask(b), [&](int offset) {
          const openvdb::Vec3i value(x[offset], y[offset], z[offset]);
          if (value != openvdb::Vec3i(0)) leaf.setValueOn(openvdb::Index(offset), value);
        });
      });
}

openvdb::GridBase::Ptr make_velocity(const State& state) {
  const Velocities& velocity = state.velocity_mm_s;
  return make_vdb_grid<openvdb::Vec3DGrid>(
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

openvdb::GridBase::Ptr make_element_mask(const BrickTopology& elements) {
  return make_vdb_grid<openvdb::BoolGrid>(
      kElementGrid, elements, false, [&](auto& leaf, std::size_t b) {
        for_each_active(elements.mask(b),
                        [&](int offset) { leaf.setValueOn(openvdb::Index(offset), true); });
      });
}

/// The state's own tree: nothing writes to it, and its nodes are those of its bricks. A tree with
/// other nodes, such as leaves without active voxels, is built anew.
openvdb::GridBase::Ptr make_density(const DensityGrid& density) {
  const openvdb::FloatGrid& own = *vdb_grid(density);
  if (own.tree().leafCount() == density.bricks().brick_count()) {
    const auto tree = openvdb::ConstPtrCast<openvdb::FloatGrid::TreeType>(own.constTreePtr());
    auto grid = make_grid<openvdb::FloatGrid>(density.background());
    grid->setTree(tree);
    grid->setName(kDensityGrid);
    return grid;
  }
  return make_vdb_grid<openvdb::FloatGrid>(
      kDensityGrid, density.bricks(), density.background(), [&](auto& leaf, std::size_t b) {
        const float* values = density.values(b);
        for_each_active(density.bricks().mask(b), [&](int offset) {
          leaf.setValueOn(openvdb::Index(offset), values[offset]);
        });
      });
}

openvdb::GridBase::Ptr make_own_bricks(const BrickIndex& own) {
  auto grid = make_grid<openvdb::BoolGrid>(false);
  grid->setName(kOwnGrid);
  for (const Vec3i& origin : own.origins()) {
    const Vec3i place = origin / kBrickDim;
    grid->tree().setValueOn(to_coord(place), true);
  }
  return grid;
}

openvdb::GridBase::Ptr make_cut_links(const State& state) {
  return make_vdb_grid<openvdb::Int32Grid>(
      kCutGrid, state.elements, 0, [&](auto& leaf, std::size_t b) {
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
  return make_vdb_grid<openvdb::Int32Grid>(name, state.elements, 0, [&](auto& leaf, std::size_t b) {
    const std::int32_t* values = numbers.brick_or_zero(b);
    for (int offset = 0; offset < kBrickVoxels; ++offset) {
      if (values[offset] != 0) leaf.setValueOn(openvdb::Index(offset), values[offset]);
    }
  });
}

/// A vector field in voxels of the index frame as a grid in mm LPS. Field and geometry have to last
/// until it is written.
OutgoingGrid make_vectors(const char* name, const char* direction, const VectorBricks& field,
                          const Geometry& geometry) {
  OutgoingGrid vectors = make_outgoing_grid<openvdb::Vec3SGrid>(
      name, field.topology, openvdb::Vec3f(0), [&](auto& leaf, std::size_t b) {
        const Vec3f* const of_brick = field.vectors.brick_or_zero(b);
        for_each_active(field.topology.mask(b), [&](int offset) {
          const Vec3f& v = of_brick[offset];
          const Vec3f mm(geometry.world_vector_from_index(Vec3d(v)));
          leaf.setValueOn(openvdb::Index(offset), openvdb::Vec3f(mm.x, mm.y, mm.z));
        });
      });
  openvdb::GridBase& grid = *vectors.grid;
  grid.setVectorType(openvdb::VEC_CONTRAVARIANT_RELATIVE);
  grid.insertMeta("direction", openvdb::StringMetadata(direction));
  grid.insertMeta("units", openvdb::StringMetadata("mm"));
  grid.insertMeta("frame", openvdb::StringMetadata("LPS"));
  attach_affine(grid, geometry);
  return vectors;
}

openvdb::MetaMap make_metadata(const State& state, const std::string& path) {
  openvdb::MetaMap metadata;
  const auto insert = [&](const std::string& name, const std::string& text) {
    metadata.insertMeta(kStateMetadataPrefix + name, openvdb::StringMetadata(text));
  };
  insert("format", state.source ? kReferringFormat : kStateFormat);
  insert("anchors", anchors_to_json({state.anchors, state.anchor_labels, state.anchor_selections}));
  if (!state.meshes.empty()) insert("bodies", json_text(sorted(state.meshes)));
  insert("configuration", state.configuration);
  insert("frame", "LPS");
  insert("geometry", geometry_to_json(state.geometry));
  insert("material", state.material_toml);
  if (!state.piece_records.empty()) insert("pieces", json_text(state.piece_records));
  if (state.source) insert("source", source_to_json(*state.source, path));
  insert("source_name", state.source_name);
  insert("source_type", state.source_type);
  insert("units", "mm");
  return metadata;
}

void write_file(const std::string& path, const State& state, const OffsetField* offsets,
                Progress* progress) {
  if (progress != nullptr) progress->stage("writing state");
  check_state(state, path);
  Displacement displacement = extended_displacement_of(state);
  const bool refers = state.source != nullptr;
  BrickIndex own;
  VectorBricks own_offsets;
  if (refers) {
    own = own_bricks(state, displacement.u, offsets != nullptr ? &offsets->o : nullptr);
    displacement.u = part_of(displacement.u, own);
    if (offsets != nullptr) own_offsets = part_of(offsets->o, own);
  }
  std::vector<OutgoingGrid> grids;
  const auto add = [&](openvdb::GridBase::Ptr grid) {
    grids.push_back({std::move(grid), nullptr});
  };
  add(make_fixed(kFixedGrid, state, state.q));
  add(make_element_mask(refers ? part_of(state.elements, own) : state.elements));
  add(make_density(refers ? part_of(state.density, own) : state.density));
  if (refers) add(make_own_bricks(own));
  if (state.beyond) add(make_fixed(kBeyondGrid, state, *state.beyond));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (is_empty(state.rest[axis])) continue;
    add(make_fixed(rest_name(int(axis)), state, state.rest[axis]));
  }
  if (!is_empty(state.velocity_mm_s)) add(make_velocity(state));
  if (!state.cuts.empty()) add(make_cut_links(state));
  if (!label_counts(state.labels).empty()) add(make_numbers(kLabelGrid, state, state.labels));
  if (!state.piece_records.empty()) add(make_numbers(kPieceGrid, state, state.pieces));
  grids.push_back(make_vectors(kDisplacementGrid, "material", displacement.u, state.geometry));
  if (offsets != nullptr) {
    grids.push_back(make_vectors(kOffsetGrid, "resample", refers ? own_offsets : offsets->o,
                                 offsets->geometry));
  }
  report(progress, 0.3);

  AtomicFile file(path);
  write_vdb_stream(file, grids, make_metadata(state, path), progress);
  report(progress, 0.8);
  seal_vdb(file.path(), VdbKind::state, progress);
  file.commit();
  report(progress, 1);
}

}  // namespace

void write_state(const std::string& path, const State& state, Progress* progress) {
  write_file(path, state, nullptr, progress);
}

void write_state(const std::string& path, const State& state, const OffsetField& offsets,
                 Progress* progress) {
  write_file(path, state, &offsets, progress);
}

}  // namespace supple
