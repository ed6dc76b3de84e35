// One step of a session, from a file or a program to the solvers, and the record of its results.
#pragma once

#include <any>
#include <optional>
#include <string>
#include <vector>

#include "lib/chainmail/ball_limits.h"
#include "lib/chainmail/tighten.h"
#include "lib/contact/sides_report.h"
#include "lib/material/material.h"
#include "lib/model/relax_model.h"
#include "lib/relax/relaxation.h"
#include "lib/session/cut_surface.h"
#include "lib/session/fem_step.h"
#include "lib/session/handle_ledger.h"
#include "lib/session/handles/handles.h"
#include "lib/session/retraction.h"
#include "lib/session/rigid_request.h"
#include "lib/session/spring_step.h"
#include "volumes/base/value.h"

namespace supple {

/// box: each component of a link is limited on its own (eqs. 4.3-4.5); ball: its length (eq. 4.6);
/// tighten: box, and then tighten(), after the step's relaxation if it has one.
enum class Limits { box, ball, tighten };

/// Drags and parts have places as people write them, in one of three frames, or on the grid
/// already, as programs have them: a session finds the former on its grid by on_grid().
///
/// Drags with a way go from pose to pose. Each pose is solved, and relaxed, as a step of its own
/// that starts where the one before it ended. Drags without a way are at their ends from the first
/// pose on. Cuts, removals, new pieces, anchors and retractions come with the first.
struct Step {
  std::string place = {};  // "file:line", for errors; empty: a program's
  Value keys = {};         // of a [[step]] that says all this, as written; null: a program's
  std::vector<Drag> drags = {};
  std::vector<ChosenPart> fix = {};  // anchors
  bool release = false;              // lets go of everything that earlier steps held
  std::vector<CutSurface> cuts = {};
  std::vector<ChosenPart> remove = {};  // elements that are gone from now on
  RigidRequest rigid = {};              // after cuts and removals, before the drags
  std::vector<Retraction> retract = {};
  Limits limits = Limits::box;
  /// Relaxation after the drag. Absent: tissue_relaxation() where the step drags under box limits
  /// and the material asks for it, unless no_relax.
  std::optional<RelaxParams> relax = {};
  bool no_relax = false;
  std::optional<SpringStep> springs = {};  // instead of both
  std::optional<FemStep> fem = {};         // likewise
  std::any own = {};  // likewise: settings of a model that was added (step_model.h)
  /// Free rigid pieces shift with the drag and do not turn, where that allows the whole drag; it is
  /// found in a twentieth of the time. They turn in the next step of ECM without it, by the
  /// smallest motion from where they were before all their shifts.
  bool shift_pieces = false;
  bool turn_pieces = false;      // they turn in this step, which does nothing else
  bool tells_reactions = false;  // of the handles that are held, in the record
  /// Material from now on for the present elements: `active` and `components` chose them when the
  /// volume was opened. Links whose limits the body breaks then are projected before it moves.
  std::optional<MaterialTable> material = {};

  bool does_nothing() const;
  /// True if a handle follows a path.
  bool is_animated() const;
};

/// The step with everything that is placed on the grid. Handles that have a path are at their poses
/// at `time`, where a film takes them at once. Throws InputError for places outside the volume.
Step on_grid(const Step& step, const Geometry& geometry, double time = kWholePaths);

/// Throws InputError, naming the step's place, for handles and fixed boxes outside of the volume,
/// displacements beyond the range and handles that its model does not have. Elements are known only
/// to a session.
void check_places(const Step& step, const Geometry& geometry);

/// Two rigid pieces that met and stopped a step.
struct BoneStop {
  double part = 1;           // of the way that was left to them
  std::string piece, other;  // their names
  Vec3i voxel{0, 0, 0};      // of `piece` at rest, which meets `other`
  double way_mm = 0;         // of that voxel before `other`
};

/// A rigid piece that finite elements lead into another one.
struct BoneMeeting {
  std::string piece, other;   // their names
  Vec3i voxel{0, 0, 0};       // of `piece` at rest, the deepest in `other`
  double overlap_voxels = 0;  // that there is, or would be if the piece were not kept
  bool is_kept = false;       // where it meets the other one
};

struct StepRecord;
/// Distance that a shift of the step has gone, in mm along the grid axes.
Vec3d way_done(const StepRecord& record, const Vec3d& by_mm);

/// Results of a step, which is on the grid. For drags with a way the report of the drag covers all
/// poses: its fraction is the smallest, its moved elements are the most. All other members are
/// those of the last pose.
struct StepRecord : Step {
  std::int64_t cut_links = 0;             // that cuts and joints removed
  std::int64_t removed = 0;               // elements
  EcmReport report;                       // of ball limits: the common members
  std::optional<BallReport> ball;         // when the step was solved under ball limits
  std::optional<Vec3d> slid;              // parts of the way along the axes, of drags that slide
  std::optional<BoneStop> bones;          // where pieces met
  std::vector<BoneMeeting> meetings;      // of free pieces under finite elements
  SidesReport contact;                    // of the sides of cuts, after drag and relaxation
  RelaxReport relaxed;                    // when the step relaxes
  SpringRecord sprung;                    // when springs move it
  FemRecord equilibrium;                  // when finite elements do
  Value own_report;                       // when a model that was added does
  std::vector<HandleReaction> reactions;  // of all handles that are held, at its end
  std::optional<TightenReport> tightened;
};

}  // namespace supple
