// A step in which finite elements move the body to its equilibrium or through time, or find its
// modes of vibration.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lib/fem/fem_report.h"
#include "lib/session/handles/selection.h"
#include "volumes/base/fields.h"
#include "volumes/base/value.h"

namespace supple {

class Geometry;       // volumes/geometry/geometry.h
struct DragPose;      // lib/session/handles/drag.h
struct FemResponses;  // lib/session/kept_voxels.h
struct TetRecord;     // lib/session/tet_record.h
struct TetStep;       // lib/session/tet_step.h

enum class LoadKind { force, pressure, swelling };
const char* name_of(LoadKind kind);

/// A load on elements while the step's equilibrium is sought.
struct FemLoad {
  LoadKind kind = LoadKind::force;
  ChosenPart part;
  Vec3d force_n{0, 0, 0};   // in all, LPS
  double pressure_kpa = 0;  // on faces: inwards where positive; of a swelling: outwards
  /// Faces of a pressure: those whose outward normal is within 60 degrees of this direction in LPS,
  /// or all.
  std::optional<Vec3d> facing;
};

/// Links that a solution leaves beyond the material's limits: later drags of ECM project them to
/// admissible ones, or keep them.
enum class LinksBeyond { project, keep };

/// Shifts and linear maps span no more.
constexpr std::size_t kMostDirections = 12;

/// A shift of a handle in mm along the grid axes, or a turn by so many degrees about such an axis
/// through the handle's middle. Two turns of an axis, by 90 and 180 degrees, span all about it.
struct HandDirection {
  Vec3d way{0, 0, 0};
  double turn_deg = 0;

  DragPose pose(const Geometry& geometry) const;
  /// [x, y, z], or [x, y, z, degrees].
  Value value() const;
};

struct FemStep {
  FemParams params;
  LinksBeyond links_beyond = LinksBeyond::project;
  Vec3d gravity_m_s2{0, 0, 0};  // LPS
  /// Young's modulus of the elements of rigid pieces; none: as fem_solid() has it.
  std::optional<double> rigid_young_kpa;
  double rigid_poisson = 0.3;
  int halvings = 0;  // of the voxels' edges, for smaller elements
  std::vector<FemLoad> loads;
  std::vector<FemQuantity> wanted;   // whose values the record is to have
  std::optional<ModeStep> modes;     // instead of an equilibrium
  std::optional<MotionStep> motion;  // likewise
  bool keeps_nodes = false;          // for a motion that the next step is to have
  /// Targets of the only handle whose responses are found before, so that the step is a sum of
  /// them: as a hand has them that is followed. `responses`: they are found already.
  std::vector<HandDirection> directions;
  std::shared_ptr<const FemResponses> responses;
  int hand_levels = 0;  // the body is as a hand has it that so many levels of responses follow
  std::shared_ptr<TetStep> tets;  // tetrahedra instead of voxels, in equilibrium
};

struct FemRecord {
  FemReport report;
  LinkCheck links;                     // what ChainMail's limits say of the result
  std::vector<FemReaction> reactions;  // of `gripped`
  FemReaction anchors;
  std::vector<SharedHandle> shared;
  /// Free rigid pieces whose elements the nearest rigid pose replaced, and by how much at most.
  std::int64_t fitted_pieces = 0;
  double fitted_max_voxels = 0;
  std::vector<StrainGauge> gauges;    // of the labels of the body
  std::vector<ElementValues> values;  // of FemStep::wanted
  FemNodes nodes;                     // where FemStep::keeps_nodes, until the next step
  /// Displacements of a step for a picture from which a later one may begin.
  std::shared_ptr<const NodeStart> equilibrium;
  std::shared_ptr<const TetRecord> tets;  // of FemStep::tets
  std::optional<ModesRecord> modes;       // of FemStep::modes; `report` then has sizes alone
  std::optional<MotionRecord> motion;     // of FemStep::motion; all else is as at its end
  double milliseconds = 0;
};

/// The key of a step that another one of it rules out; its file is empty.
std::optional<Problem> contradiction(const FemStep& step);

/// The body takes the shape that it had at one of the motion's frame times.
void show_frame(std::size_t frame, FemRecord& record, Body& body);
/// The body takes another shape of the record's modes.
void show_mode(int number, FemRecord& record, Body& body);

/// Keys of `fem = { … }` in a scene, but for its loads, modes and motion.
Fields fields(FemStep& step);
/// The first of these keys, which chooses the defaults of others.
Field accuracy_field(FemStep& step);
/// Keys of these that are options of the command line, too.
Fields option_fields(FemStep& step);
/// A step on tetrahedra by its defaults.
FemStep make_tet_step();
/// Keys of `tets = { … }`, but for its loads, openings and sheets.
Fields tet_fields(FemStep& step);
/// Keys of a load, but for the elements: `force_n`, or `pressure_kpa` and `facing`.
Fields load_fields(FemLoad& load);
/// Returns the step as a journal records it.
Value settings_value(const FemStep& step);

}  // namespace supple
