// The subject of a scene and its poses after the steps, as views and outputs ask for them: each
// pose is found once, and what nothing reads is not.
#pragma once

#include <memory>
#include <optional>

#include "lib/session/session.h"
#include "lib/state/pose.h"
#include "tools/scene/run/view_pictures.h"

namespace supple::tools {

/// An effective view with its subject, and the pose along a path of its own, if it has one.
struct PosedView {
  SceneView view;
  PosedVolume subject;
  std::unique_ptr<const Pose> own;
};

class ScenePoses {
 public:
  /// Opens the subject: a body where something moves, else a state or a volume alone. Both outlive
  /// this.
  ScenePoses(const Scene& scene, Progress& progress);

  /// The body; null where nothing moves.
  Session* session() const { return m_session.get(); }
  /// The body after the step that was asked for last, or the file; of a volume alone geometry and
  /// densities.
  const State& state() const { return m_state; }
  /// See SceneRun::certificate().
  const InversionCertificate* certificate() const;
  /// Forgets the poses of a body that has moved since. The certificate stays.
  void forget();

  /// Return the displacement after a step, also with its inverse, and as the scene's path shows it.
  const Displacement& displacement(int step);
  const Pose& deformed(int step);
  const Pose& seen(int step);
  /// The pose for warps: without inverse where none of them reads it.
  const Pose& moved(int step);
  /// A view after a step, to be drawn before the next pose is asked for.
  PosedView drawn_after(int step, const SceneView& view);

 private:
  using OwnPose = std::unique_ptr<const Pose>;
  void open_volume_alone();
  bool reads_displacement_later() const;
  void take_state(int step);
  const Displacement& without_inverse(const SceneView& view, int step);
  const Pose* posed_for(SceneView& view, int step, OwnPose& own);
  const Pose* posed_volume_for(SceneView& view, OwnPose& own);
  bool is_all_that_reads(const SceneView& view) const;
  Pose take_deformed();
  void add_meshes(SceneView& view) const;

  const Scene& m_scene;
  Progress& m_progress;
  std::unique_ptr<Session> m_session;
  State m_state;
  double m_grey_lo = 0, m_grey_hi = 1;
  bool m_is_volume = false;  // m_state holds no more than a geometry and densities
  bool m_has_warp = false;   // which m_deformed holds
  bool m_has_inverted = false;
  Pose m_deformed;
  int m_state_step = -1, m_displaced_step = -1, m_inverted_step = -1, m_seen_step = -1;
  std::optional<Pose> m_seen;  // as the scene's path shows it
};

}  // namespace supple::tools
