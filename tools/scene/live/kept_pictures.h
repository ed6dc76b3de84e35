// Pictures of one subject, one after the other: what rays read is kept between them and made anew
// only where the subject has changed, and a picture in the same view as the last marches only
// pixels that this may have altered. Each is that of a scene, bit for bit.
#pragma once

#include <memory>
#include <optional>

#include "tools/scene/live/live_body.h"
#include "tools/scene/live/live_session.h"
#include "tools/scene/run/kept_renderer.h"
#include "tools/scene/run/scene_poses.h"
#include "volumes/base/relayed_progress.h"

namespace supple::tools {

class KeptPictures {
 public:
  virtual ~KeptPictures() = default;

  /// The picture of a view as a scene has it, of one with this part of the displacement. Throws as
  /// draw_view(), InputError for a series of pictures, Cancelled; another one may be drawn then.
  SinglePicture draw(const SceneView& view, double amount, RenderReport& report,
                     Progress& progress);

 protected:
  /// The effective view with its subject, which renderer() shows unless it has a pose of its own.
  virtual PosedView pose(const SceneView& view, double amount) = 0;
  virtual Renderer& renderer(const PosedView& posed) = 0;
  /// Frees all that is kept, of which nothing is known after a failure.
  virtual void forget() = 0;
  /// To be called where the renderer is another one.
  void forget_last() { m_followed.forget(); }
  /// Progress of the picture that is being drawn.
  RelayedProgress& progress() { return m_progress; }

 private:
  RelayedProgress m_progress{nullptr};
  FollowedPictures m_followed;
  bool m_has_surfaces = false;  // the renderer
};

/// Pictures of the body of a session, which must outlive them, as it is when they are drawn, or
/// as finite elements under the hand lead it.
class BodyPictures final : public KeptPictures {
 public:
  explicit BodyPictures(LiveSession& live) : m_live(live) {}

 private:
  PosedView pose(const SceneView& view, double amount) override;
  Renderer& renderer(const PosedView&) override { return m_body->renderer(); }
  void forget() override { m_body.reset(); }
  LiveBody& body_at(const SceneView& view, double amount);

  LiveSession& m_live;
  std::optional<LiveBody> m_body;
};

/// Pictures of a volume, also through a warp.
class VolumePictures final : public KeptPictures {
 public:
  /// A scene of a volume, without steps and views. It is read when a picture needs it.
  explicit VolumePictures(Scene scene) : m_scene(std::move(scene)) {}

 private:
  PosedView pose(const SceneView& view, double amount) override;
  Renderer& renderer(const PosedView& posed) override;
  void forget() override;

  Scene m_scene;
  std::optional<ScenePoses> m_poses;
  std::unique_ptr<Renderer> m_renderer;
  SceneView m_shown;  // by the renderer
};

}  // namespace supple::tools
