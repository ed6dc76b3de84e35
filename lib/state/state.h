// The state file: everything needed to continue, render or export a deformed volume (design.md
// section 7). Authority: q, element mask, density, labels, anchors, material table text,
// configuration.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "volumes/base/progress.h"
#include "volumes/base/value.h"
#include "volumes/field/offset_field.h"
#include "volumes/geometry/geometry.h"
#include "volumes/grid/brick_values.h"
#include "volumes/grid/density_grid.h"
#include "volumes/grid/link_cuts.h"

namespace supple {

/// Fixed point of all solver offsets: 2^-16 voxel; |q| <= kMaxOffset (design.md section 2).
constexpr int kFixedBits = 16;
constexpr double kFixedOne = 65536.0;
constexpr std::int32_t kMaxOffset = (1 << 30) - 1;

/// Stretch at which the spring of a link is at rest, per axis of the link and coordinate, in 2^-16
/// voxel, at its end at the lower index, as plastic flow left it. Stored where it flowed.
using RestStretch = std::array<std::array<BrickValues, 3>, 3>;

/// Distance of elements' offsets beyond admissible ones, 2^-16 voxel, bricks as in the elements;
/// null where drags are to keep nothing beyond.
using BeyondLimits = std::shared_ptr<const std::array<BrickValues, 3>>;

/// Velocities of elements along LPS x, y, z in mm/s; empty where nothing moves.
using Velocities = std::array<BrickArray<double>, 3>;

struct StateSource;

struct State {
  Geometry geometry;    // of the source volume, index to LPS mm
  DensityGrid density;  // elements and shell
  BrickTopology elements;
  /// Offsets from rest per coordinate on the bricks of `elements`, 2^-16 voxel; empty for a
  /// coordinate that never moved. Inactive voxels hold 0.
  std::array<BrickValues, 3> q;
  LinkCuts cuts;             // links between elements that are absent; bricks as in `elements`
  RestStretch rest;          // bricks as in `elements`; empty without plastic flow
  Velocities velocity_mm_s;  // bricks as in `elements`; empty unless a model of motion left some
  BeyondLimits beyond;       // of q; null unless a model without limits left links to be kept
  /// Labels of a segmentation, 1 to 65535, 0 at elements without one; empty when none are in use.
  /// Bricks as in `elements`, 0 where there is no element.
  BrickValues labels;
  /// Rigid pieces, from 1, 0 at elements of none; empty when there are none. Bricks as in
  /// `elements`.
  BrickValues pieces;
  /// Name and pose of each piece, as JSON, for the session that continues the state.
  std::vector<Value> piece_records;
  std::vector<IndexBox> anchors;
  std::vector<std::int32_t> anchor_labels;  // whose elements stay where they are too
  /// Further anchors, each a selection as JSON, for the session that continues the state.
  std::vector<Value> anchor_selections;
  /// Mesh bodies beside the voxels, as records for the session that continues the state.
  std::vector<Value> meshes;
  std::string material_toml;  // the table as text, so that a state can be continued
  std::string configuration;  // JSON: the effective settings that produced it
  std::string source_name;    // file name of the source volume
  std::string source_type;    // numpy name of the stored type
  /// The volume that the state's file refers to (state_source.h); null: it holds everything.
  std::shared_ptr<const StateSource> source;
};

/// Name of the rest stretches of the links along an axis in messages and files: "rest_i" and so on.
std::string rest_name(int axis);

/// u on the elements, unit voxel, from q.
Displacement displacement_of(const State& state);
/// u on elements and shell: displacement_of extended over the shell.
Displacement extended_displacement_of(const State& state);

/// Throws InputError, naming `file`, unless everything holds that later code trusts: densities
/// finite and inside the source box, every element among them, q on the bricks of the elements,
/// |q| <= kMaxOffset, 0 in inactive slots, rest stretches likewise within twice that, velocities
/// finite and 0 in inactive slots, cut links between elements, labels 0 to 65535 and only at
/// elements, pieces likewise up to the number of their texts, no empty anchor box, no anchor label
/// without elements. Cost: one pass over the bricks.
void check_state(const State& state, const std::string& file);

/// Writes atomically; equal states give equal files, a coordinate of zeros counts as one that never
/// moved. The second form adds the derived grid `offset` (resample) for other programs. A state
/// with a source, which has to be open, is written with the bricks of its own alone (own_bricks.h),
/// and labels and numbers of pieces of all: it reads back as the same state. Throws InputError for
/// a state that check_state() rejects, SystemError (disk full, permission).
void write_state(const std::string& path, const State& state, Progress* progress = nullptr);
void write_state(const std::string& path, const State& state, const OffsetField& offsets,
                 Progress* progress = nullptr);

/// Throws InputError for a missing, truncated, damaged or foreign file, and for one that refers to
/// a source which is missing or another by now. A coordinate of zeros comes back empty. Derived
/// grids are not read back.
State read_state(const std::string& path, Progress* progress = nullptr);
/// Reads as read_state() does, and also a state whose source is missing or another: with a warning,
/// its own bricks alone, at elements that can move no further than these, without anchors and with
/// a source that is not open.
State read_reachable_state(const std::string& path, Progress* progress = nullptr);

/// True when the file starts like OpenVDB and carries our metadata or trailer; a damaged state
/// counts. Never throws.
bool is_state_file(const std::string& path);

}  // namespace supple
