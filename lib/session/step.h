// One step of a session, from a file or a program to the solvers, and the record of its results.
#pragma once

#include <any>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lib/chainmail/drag.h"
#include "lib/contact/collider_contact.h"
#include "lib/material/material.h"
#include "lib/model/model.h"
#include "lib/relax/relax_report.h"
#include "lib/session/fem_step.h"
#include "lib/session/handles/drag.h"
#include "lib/springs/spring_report.h"
#include "volumes/base/value.h"
#include "volumes/io/mesh/triangle_mesh.h"

namespace supple {

/// box: each component of a link is limited on its own (eqs. 4.3-4.5); ball: its length (eq. 4.6);
/// tighten: box, and then tighten(), after the step's relaxation if it has one.
enum class Limits { box, ball, tighten };

/// A curve as drawn, swept along a direction; places in the frame of its surface.
struct CutCurve {
  std::vector<Vec3d> points;
  std::string file;  // that the points came from, without folder; empty: from the scene
  Vec3d direction{0, 0, 0};
  double depth_mm = 0, above_mm = 5;
  bool is_straight = false;
};

/// Surface along which a step cuts the body: a triangle mesh from a file, a plane patch or a drawn
/// curve from a scene, or around a label (cut_surface.h).
struct CutSurface {
  std::string place;                         // for errors: "scene:line", or the mesh file
  std::string mesh_file;                     // without folder
  std::shared_ptr<const TriangleMesh> mesh;  // null: a plane
  Vec3d corner{0, 0, 0}, edge1{0, 0, 0}, edge2{0, 0, 0};  // of the plane patch
  bool in_voxels = false;  // of the volume, instead of LPS mm: plane and curve
  std::optional<CutCurve> curve;
  std::int32_t label = 0;  // links between it and anything else; 0: one of the others
  std::int32_t from = 0;   // links between the label and this one alone; 0: and anything else
};

/// Opening of a cut (retraction.h). A patch as that of a cut. edge1 runs along the incision, edge2
/// from its depth to the skin.
struct Retraction {
  std::string place;  // for errors
  Vec3d corner{0, 0, 0}, edge1{0, 0, 0}, edge2{0, 0, 0};
  bool in_voxels = false;  // of the volume, instead of LPS mm
  double by_mm = 0;        // between the lips
  double width_mm = 3;     // of each lip
};

/// Choice of the elements of a body that a step makes rigid pieces (rigid_request.h).
struct RigidRequest {
  std::optional<NumberPair> density;  // every connected part of these densities is a piece
  std::vector<Vec3i> seeds;           // pieces with several are parted where bone is thinnest
  std::vector<ChosenPart> parts;      // a piece each, which takes its elements from other pieces

  double joint_mm = 0;  // tissue is parted around `parts`, and between pieces of `seeds`, so near

  bool empty() const { return !density && seeds.empty() && parts.empty(); }
};

/// A step in which springs move the body, for a time or to rest (spring_step.h).
struct SpringStep {
  MotionParams motion;
  double time_s = 0.1;          // of a motion
  int most_steps = 500;         // of a minimisation
  std::vector<Value> contacts;  // motion.colliders, for the record
  /// Stiffnesses in N/m, in place of the material's values.
  std::optional<double> structural_n_m, shear_n_m, bending_n_m;
  double mass_damping_per_s = 0;

  bool is_motion() const { return !motion.minimise; }
  /// Steps beyond this are taken for a mistake.
  static constexpr int kMostSteps = 1000000;
  /// Steps of a motion, which share its time: none longer than motion.step_s.
  int motion_steps() const;
};

struct SpringRecord {
  int steps = 0;
  std::size_t nodes = 0, springs = 0;
  ModelEnergy before, after;
  std::optional<double> residual_mn;       // of a minimisation: largest force on a free node
  std::optional<SpringStepReport> motion;  // of all steps of a motion
  LinkCheck links;                         // of the result, under ChainMail's limits
  double milliseconds = 0;
  std::vector<Reaction> reactions;       // of `gripped`
  std::vector<Vec3d> collider_forces_n;  // on the shapes in contact, LPS
};

/// A handle that is held, and the force with which the body pulls at its holder.
struct HandleReaction {
  int step, handle;  // that grabbed it, from 1
  std::string name;  // of its region
  Reaction reaction;
  std::optional<Vec3d> moment_nmm =
      {};  // LPS, about the mean of its nodes at rest; finite elements
};

/// Drags and parts have places as people write them, in one of three frames, or on the grid
/// already, as programs have them: a session finds the former on its grid by on_grid().
///
/// Drags with a way go from pose to pose. Each pose is solved, and relaxed, as a step of its own
/// that starts where the one before it ended. Drags without a way are at their ends from the first
/// pose on. Cuts, removals, new pieces, anchors and retractions come with the first.
struct Step {
  std::string place = {};  // "file:line", for errors; empty: a program's
  std::string body = {};   // the mesh body that it moves; empty: the voxels
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

struct MeshRecord;
struct StepRecord;
/// Distance that a shift of the step has gone, in mm along the grid axes.
Vec3d way_done(const StepRecord& record, const Vec3d& by_mm);

/// Results of a step, which is on the grid. For drags with a way the report of the drag covers all
/// poses: its fraction is the smallest, its moved elements are the most. All other members are
/// those of the last pose.
struct StepRecord : Step {
  std::shared_ptr<const MeshRecord> mesh;  // of a mesh body; all else is empty then
  std::int64_t cut_links = 0;              // that cuts and joints removed
  std::int64_t removed = 0;                // elements
  EcmReport report;                        // of ball limits: the common members
  std::optional<BallReport> ball;          // when the step was solved under ball limits
  std::optional<Vec3d> slid;               // parts of the way along the axes, of drags that slide
  std::optional<BoneStop> bones;           // where pieces met
  std::vector<BoneMeeting> meetings;       // of free pieces under finite elements
  SidesReport contact;                     // of the sides of cuts, after drag and relaxation
  RelaxReport relaxed;                     // when the step relaxes
  SpringRecord sprung;                     // when springs move it
  FemRecord equilibrium;                   // when finite elements do
  Value own_report;                        // when a model that was added does
  std::vector<HandleReaction> reactions;   // of all handles that are held, at its end
  std::optional<TightenReport> tightened;
};

}  // namespace supple
