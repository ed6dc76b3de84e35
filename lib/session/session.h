// One body from file to deformed state, without a window: load, drag, anchor, cut, relax, undo, and
// results as values. A session prints nothing and keeps a journal; warnings go to `progress` and
// stay among the messages.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lib/contact/piece_contact.h"
#include "lib/model/relax_model.h"
#include "lib/model/voxel_ecm_model.h"
#include "lib/session/free_poses.h"
#include "lib/session/handles/handle_places.h"
#include "lib/session/handles/handles.h"
#include "lib/session/handles/rigid_drag.h"
#include "lib/session/step.h"
#include "lib/state/pose.h"
#include "lib/state/state.h"
#include "volumes/grid/volume.h"
#include "volumes/io/format/volume_file.h"

namespace supple {

struct SessionOptions {
  /// Material; null: that of a state; for a volume one homogeneous tissue, with a warning.
  std::optional<MaterialTable> material = {};
  /// Labels on the grid of the volume; empty: those of a state.
  std::string labels_path = {};
  ReadOptions read = {};
  /// Keeps the data of undo(): after each step the bricks that it changed, as they were, and nodes
  /// of finite elements that it was handed; all together at most kMostUndoBytes. Beyond that the
  /// oldest steps cannot be undone.
  bool keeps_undo = false;
  /// States that the session writes refer to the volume, or to the source of the state that it
  /// continues, and hold what moved alone; otherwise they hold everything, whatever was continued.
  /// Costs a digest of the densities, and where parts are removed the densities before that.
  bool refers = false;
};

constexpr std::size_t kMostUndoBytes = std::size_t(512) << 20;

class CutContact;
class CutLips;
struct LipsBefore;
struct StepNodes;

class Session {
 public:
  /// Opens a volume (elements at rest) or a state (continued). Throws InputError for what cannot be
  /// read or does not fit together, Cancelled.
  explicit Session(const std::string& path, const SessionOptions& options = {},
                   Progress* progress = nullptr);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  const Geometry& geometry() const { return m_state.geometry; }
  const Body& body() const { return m_body; }
  const MaterialTable& material() const { return m_material; }
  /// True if steps with Step::shift_pieces have left pieces that are still to turn.
  bool has_shifted_pieces() const;
  /// Links that are cut, without those that rigid pieces hide in body().cuts.
  const LinkCuts& cuts() const { return m_body.rigid.empty() ? m_body.cuts : m_state.cuts; }
  /// Check of the links when the session was opened. Links of the material that may fold, NaN
  /// voxels and the like have been warned of.
  const LinkCheck& links() const { return m_links; }

  /// Cuts, then solves one step, then relaxes (Step::relax), then tightens; or lets springs
  /// move the body. Cuts
  /// are made in the body at rest and stay. Handles stay held and anchors fixed until a step
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
  std::size_t undo_bytes() const { return m_undo_bytes; }

  /// The body takes the shape of another mode that the last step has found; numbers count from 1.
  /// Throws std::logic_error where it found none, or where steps can be undone.
  void show_mode(int number);

  /// The body takes the shape that it had at one of the frame times of the motion of the last step,
  /// from 0. Throws std::logic_error as show_mode().
  void show_frame(int frame);

  const std::vector<StepRecord>& records() const { return m_records; }
  /// Warnings since the session was opened, in order.
  const std::vector<std::string>& messages() const { return m_messages; }
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
  struct Before;
  struct StepStart;
  struct Walk;
  void choose_material(const std::string& path, const SessionOptions& options, Progress* progress);
  void find_foreground(const std::string& path, const SessionOptions& options,
                       const VolumeStatistics& statistics, Progress* progress);
  void open_volume_file(const std::string& path, const SessionOptions& options, Progress* progress);
  void open_state(const std::string& path, const SessionOptions& options, Progress* progress);
  void open_labels(const std::string& path, Progress* progress);
  void warn_of_material(Progress* progress) const;
  Region region_of(const Drag& drag) const;
  Region without_fixed(const Region& region) const;
  std::vector<Region> regions_of(const Step& request) const;
  Region region_of_label(std::int32_t label, const std::string& role) const;
  const StepRecord& take(const Step& request, Progress* heard);
  void check_elements(const Step& request) const;
  void release_and_fix(const Step& request);
  void find_anchors();
  void fix_whole_pieces();
  /// `part`: of all motions, where rigid pieces turn.
  std::vector<Handle> handles_of(const Step& request, const std::vector<PieceMotion>& pieces,
                                 double part) const;
  bool is_relaxed_by_default(const Step& request) const;
  void prepare_body(StepRecord& record, Progress* progress);
  void change_material(const MaterialTable& material, Progress* progress);
  void remove_parts(StepRecord& record, Progress* progress);
  void cut_body(StepRecord& record, Progress* progress);
  void take_pieces_of_state(const std::string& path, Progress* progress);
  void check_model_of_pieces(const Step& request) const;
  HeldBody held_with_pieces(std::vector<Region>& anchors);
  void relax_body(int passes, StepRecord& record, Progress* progress);
  void tighten_body(StepRecord& record, Progress* progress);
  std::unique_ptr<CutContact> solve_apart(const std::vector<Handle>& handles,
                                          const std::vector<PieceMotion>& pieces,
                                          StepRecord& record, Progress* progress);
  void slide_on(StepRecord& record, Progress* progress);
  void solve(const std::vector<Handle>& handles, const std::vector<PieceMotion>& pieces,
             StepRecord& record, Progress* progress);
  void solve_freely(const std::vector<Handle>& handles, const std::vector<PieceMotion>& pieces,
                    StepRecord& record, Progress* progress);
  bool keeps_bones_apart(const Step& request) const;
  PieceWay way_of_pieces(const std::vector<RigidPiece>& start, const std::vector<RigidPose>& end,
                         const std::vector<PieceMotion>& turns) const;
  std::optional<BoneStop> first_bone_stop(const std::vector<RigidPiece>& start,
                                          const std::vector<RigidPose>& end,
                                          std::vector<PieceMotion> motions, double part);
  double shorten_for_bones(std::vector<PieceMotion>& pieces, StepRecord& record,
                           Progress* progress);
  std::function<std::vector<FreePose>(bool)> keeping_apart(const std::vector<Handle>& handles,
                                                           std::vector<PieceMotion> motions,
                                                           StepRecord& record);
  void go_to_part(double part, const std::vector<Handle>& handles,
                  const std::vector<PieceMotion>& pieces, const StepStart& start,
                  StepRecord& record, Progress* progress);
  void solve_in_contact(CutContact& contact, const std::vector<Handle>& handles,
                        const std::vector<PieceMotion>& pieces, StepRecord& record,
                        Progress* progress);
  std::unique_ptr<CutContact> contact_of(const Step& request);
  std::int64_t solve_part(std::int64_t parts, const std::vector<Handle>& handles,
                          const std::vector<PieceMotion>& pieces, const StepStart& start,
                          StepRecord& record, Progress* progress);
  SlotSet fixed_elements() const;
  void solve_turns(const std::vector<Handle>& handles, const std::vector<PieceMotion>& pieces,
                   StepRecord& record, Progress* progress);
  void move_free_pieces_too(const std::vector<Handle>& handles, StepRecord& record,
                            Progress* progress);
  bool shift_pieces(const std::vector<Handle>& handles, StepRecord& record, Progress* progress);
  void turn_shifted_pieces(StepRecord& record, Progress* progress);
  void forget_shifts();
  std::vector<FreePose> free_pieces(const std::vector<Handle>& handles) const;
  void move_with(const std::vector<Handle>& handles, const std::vector<FreePose>& poses,
                 StepRecord& record, Progress* progress);
  void move_quasi_statically(const std::vector<Handle>& handles,
                             const std::vector<PieceMotion>& pieces, StepRecord& record,
                             Progress* progress);
  void run_step(StepRecord& record, Progress* progress);
  void move(StepRecord& record, Progress* progress);
  void move_by_elements(const std::vector<Handle>& handles, const std::vector<PieceMotion>& pieces,
                        const HandleLedger& ledger, StepRecord& record, Progress* progress);
  void follow_ways(StepRecord& record, Progress* progress);
  std::vector<PieceMotion> motions_of(const Step& request) const;
  Before before(const Step& request);
  void restore(Before&& before);
  void keep(Before&& before);
  HeldBody held() { return {m_body, m_anchors, m_holds}; }

  State m_state;  // its cuts are those of the body without the links that rigid pieces hide
  DensitySource m_source;  // of a volume
  MaterialTable m_material;
  Body m_body;
  std::unique_ptr<VoxelEcmModel> m_ecm;  // of m_body
  PieceContact m_bones;                  // shapes of the pieces that have come near each other
  std::shared_ptr<CutLips> m_lips;       // of m_body as steps found them last; null: no cut yet
  std::shared_ptr<const LipsBefore> m_lips_before;  // of a hand that leads a bone
  LinkCheck m_links;
  std::vector<Region> m_anchors;  // the boxes, labels and selections that the state has fixed
  Holds m_holds;                  // elements that earlier steps dragged
  HandleLedger m_ledger;          // the handles that did
  /// Displacements of the last finite elements for a picture, while their solid is the same.
  std::shared_ptr<const NodeStart> m_equilibrium;
  RelaxParams m_relaxed_by;  // of the relaxation that the body rests under, if any
  std::vector<StepRecord> m_records;
  std::vector<std::string> m_messages;
  bool m_keeps_undo;
  std::deque<Before> m_undo;                  // one for each step that can be taken back
  std::unique_ptr<StepNodes> m_nodes_before;  // those of m_body between steps; null: of no step yet
  std::size_t m_undo_bytes = 0;
  std::unique_ptr<Walk> m_walk;  // while drags follow ways
  std::optional<Pose> m_pose;
};

}  // namespace supple
