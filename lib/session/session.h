// Bodies of a scene, one of voxels and any number of meshes, from file to deformed state, without a
// window: load, drag, anchor, cut, relax, undo, and results as values. A session prints nothing and
// keeps a journal; warnings go to `progress` and stay among the messages.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lib/session/step.h"
#include "lib/state/pose.h"
#include "lib/state/state.h"
#include "volumes/grid/density_grid.h"
#include "volumes/io/format/volume_file.h"

namespace supple {

class DeformableMesh;
struct MeshSetup;
struct SessionBody;

struct SessionOptions {
  /// Material; null: that of a state; for a volume one homogeneous tissue, with a warning.
  std::optional<MaterialTable> material = {};
  /// Labels on the grid of the volume; empty: those of a state.
  std::string labels_path = {};
  ReadOptions read = {};
  /// Keeps the data of undo(): after each step the bricks that it changed, as they were, and nodes
  /// of finite elements that it was handed; all together at most 512 MiB. Beyond that the
  /// oldest steps cannot be undone.
  bool keeps_undo = false;
  /// States that the session writes refer to the volume, or to the source of the state that it
  /// continues, and hold what moved alone; otherwise they hold everything, whatever was continued.
  /// Costs a digest of the densities, and where parts are removed the densities before that.
  bool refers = false;
};

class Session {
 public:
  /// Opens a volume (elements at rest) or a state (continued). Throws InputError for what cannot be
  /// read or does not fit together, Cancelled.
  explicit Session(const std::string& path, const SessionOptions& options = {},
                   Progress* progress = nullptr);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Puts a mesh body beside the voxels (deformable_mesh.h), which steps name. Throws InputError as
  /// DeformableMesh, and for a name that another one has.
  void add(const MeshSetup& setup);
  /// The mesh bodies, those of a continued state first.
  const std::vector<DeformableMesh>& meshes() const;

  const Geometry& geometry() const;
  const Body& body() const;
  /// The body, for code that pushes it beside steps: offsets alone may change, and all links hold
  /// afterwards. Journals do not know of it. Throws std::logic_error with keeps_undo.
  Body& body_to_push();
  /// The body with all that is held in it, for responses of a handle (live_responses.h): steps
  /// go on with what SessionBody::responses has. Nothing else may change.
  SessionBody& held_body();
  /// Elements that stay where they are: anchors, rigid pieces, and what handles hold.
  SlotSet held() const;
  const MaterialTable& material() const;
  /// True if steps with Step::shift_pieces have left pieces that are still to turn.
  bool has_shifted_pieces() const;
  /// Links that are cut, without those that rigid pieces hide in body().cuts.
  const LinkCuts& cuts() const;
  /// Check of the links when the session was opened. Links of the material that may fold, NaN
  /// voxels and the like have been warned of.
  const LinkCheck& links() const;

  /// Cuts, then solves one step, then relaxes (Step::relax), then tightens; or lets springs
  /// move the body. Cuts are made in the body at rest and stay. A step that names a mesh body moves
  /// that one alone. Handles stay held and anchors fixed until a step
  /// releases them. Throws InputError as the solvers do, Cancelled; with keeps_undo everything is
  /// then as it was before the step.
  /// Errors name the step's place where they name no file. `time`: as on_grid() has it.
  const StepRecord& step(const Step& step, Progress* progress = nullptr, double time = kWholePaths);

  /// Throws InputError as step() does for handles and fixed voxels that are no elements; a label
  /// needs some element.
  void check(const Step& step) const;
  /// The elements that each handle grabs. Throws as check().
  std::vector<HandlePlace> places(const Step& step) const;

  /// Steps of one thing each. `by_mm` goes along the grid axes.
  const StepRecord& drag(const Region& grabbed, const Vec3d& by_mm, Progress* progress = nullptr);
  const StepRecord& fix(const IndexBox& box, Progress* progress = nullptr);
  const StepRecord& cut(const CutSurface& surface, Progress* progress = nullptr);
  const StepRecord& relax(const RelaxParams& params, Progress* progress = nullptr);
  const StepRecord& release(Progress* progress = nullptr);
  /// Takes the last step back, bit for bit; false where none is left to take back. Throws
  /// std::logic_error where SessionOptions::keeps_undo is off.
  bool undo();
  /// Number of steps that it can take back.
  std::size_t undo_steps() const;
  /// Memory that is kept for it.
  std::size_t undo_bytes() const;

  /// The body takes the shape of another mode that the last step has found; numbers count from 1.
  /// Throws std::logic_error where it found none, or where steps can be undone.
  void show_mode(int number);

  /// The body takes the shape that it had at one of the frame times of the motion of the last step,
  /// from 0. Throws std::logic_error as show_mode().
  void show_frame(int frame);

  const std::vector<StepRecord>& records() const;
  /// Warnings since the session was opened, in order.
  const std::vector<std::string>& messages() const;
  /// The steps that led here, those of a continued state included, as one line of JSON.
  std::string journal() const;

  /// The state as it is now, journal included.
  State state() const;
  /// Displacement u (material direction), offsets o (resample direction) and their certificate:
  /// computed when first asked for after a step, and valid until the next.
  const Pose& pose(Progress* progress = nullptr);

  /// Writes the state with its offsets (SessionOptions::refers); throws as supple::write_state.
  void write_state(const std::string& path, Progress* progress = nullptr);
  /// Writes the offsets as a warp in the format that the path names (NRRD, MetaImage, NIfTI, ITK's
  /// .h5, VDB): out(x) = in(x + o(x)), LPS mm. Throws as supple::write_state_warp.
  void write_warp(const std::string& path, Progress* progress = nullptr);

 private:
  struct Parts;
  std::unique_ptr<Parts> m_parts;
};

}  // namespace supple
