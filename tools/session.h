// One body from file to deformed state: what `deform` and `run` share. A session holds the source,
// the node state and what the steps so far hold in place.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lib/chainmail/ball_limits.h"
#include "lib/chainmail/tighten.h"
#include "lib/model/relax_model.h"
#include "lib/model/voxel_ecm_model.h"
#include "tools/console/console.h"
#include "tools/grips.h"
#include "tools/scene/cut_surface.h"
#include "tools/scene/spring_step.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/state/state.h"

namespace supple::tools {

/// A handle with its displacement in millimetres along the grid axes.
struct Drag {
  Region region;
  Vec3d by_mm;
  HandleKind kind = HandleKind::two_sided;
  std::int32_t label = 0;  // whose elements are grabbed, as one, instead of the region
};

/// box: each component of a link is limited on its own (eqs. 4.3-4.5); ball: its length (eq. 4.6);
/// tighten: box, and then tighten(), after the step's relaxation if it has one.
enum class Limits { box, ball, tighten };
/// "box", "ball" or "tighten"; none for another name.
std::optional<Limits> limits_of_name(const std::string& name);

/// What one solve is asked for.
struct StepRequest {
  std::vector<Drag> drags;
  std::vector<IndexBox> fix;
  std::vector<std::int32_t> fix_labels;
  bool release = false;
  std::vector<CutSurface> cuts;
  Limits limits = Limits::box;
  std::optional<RelaxParams> relax;   // after the drag
  std::optional<SpringStep> springs;  // instead of both
  bool forces = false;                // on the handles that are held, in the record
};

/// And what came of it.
struct StepRecord : StepRequest {
  std::int64_t cut_links = 0;         // that the cuts removed
  EcmReport report;                   // of ball limits: what both have in common
  std::optional<BallReport> ball;     // when the step was solved under ball limits
  RelaxReport relaxed;                // when the step relaxes
  SpringRecord sprung;                // when springs move it
  std::vector<HandleReaction> pulls;  // of all handles that are held, at its end, where asked for
  std::optional<TightenReport> tightened;
};

class Session {
 public:
  /// Opens a volume (elements at rest) or a state (continued, under its own material and labels
  /// unless others are given). Without any material the tissue is homogeneous, and a warning says
  /// so. `labels_path` may be empty.
  Session(const std::string& path, const ReadOptions& read,
          const std::optional<MaterialTable>& material, const std::string& labels_path,
          Console& console);

  const Geometry& geometry() const { return m_state.geometry; }
  const Body& body() const { return m_body; }
  /// Links of the material that may fold, NaN voxels and the like have been warned of.
  const LinkCheck& links() const { return m_links; }

  /// Cuts, then solves one step, then relaxes, then tightens; or lets springs move the body. Cuts
  /// are made in the body at rest and stay. Handles stay held and boxes and labels fixed until a
  /// step releases them. Warns when anchors stopped the drag, when the start had to be projected or
  /// when ball limits leave links violated.
  const StepRecord& step(const StepRequest& request, Console& console);

  const std::vector<StepRecord>& records() const { return m_records; }
  /// The state as it is now, configuration included.
  State state() const;

 private:
  void open_volume_file(const std::string& path, const ReadOptions& read, Console& console);
  void open_labels(const std::string& path, Console& console);
  void warn_of_material(Console& console) const;
  Region region_of_label(std::int32_t label, const std::string& role) const;
  void release_and_fix(const StepRequest& request);
  void find_anchors();
  std::vector<Handle> handles_of(const std::vector<Drag>& drags) const;
  std::string configuration() const;
  void relax_body(StepRecord& record, Console& console);
  void tighten_body(StepRecord& record, Console& console);
  void solve(const std::vector<Handle>& handles, StepRecord& record, Console& console);
  void move_quasi_statically(const std::vector<Handle>& handles, StepRecord& record,
                             Console& console);
  HeldBody held() { return {m_body, m_anchors, m_holds}; }

  State m_state;
  MaterialTable m_material;
  Body m_body;
  std::unique_ptr<VoxelEcmModel> m_ecm;  // of m_body
  LinkCheck m_links;
  std::vector<Region> m_anchors;  // the boxes and labels that the state has fixed
  Holds m_holds;                  // what earlier steps dragged
  HandleLedger m_grips;           // the handles that did
  double m_pressure_kpa = 0;      // bulk modulus of the relaxation that the body rests under
  std::vector<StepRecord> m_records;
};

}  // namespace supple::tools
