// A scanned volume under instruments: opened with its material and its first steps as in any scene,
// then pushed by the operation, and drawn in the frames of a film with the instruments.
#pragma once

#include <memory>
#include <string>

#include "lib/operation/operation.h"
#include "raycast/pictures/image.h"
#include "tools/scene/operation/operation_scene.h"
#include "tools/scene/pictures/picture_writer.h"
#include "volumes/base/progress.h"

namespace supple::tools {

struct SceneView;

/// Name that events have for what is rigid in a scanned volume.
constexpr char kBone[] = "bone";

class OperatedVolume {
 public:
  /// Opens the volume and carries out the steps of the scene. Refers to all of these.
  /// Throws as ScenePoses and Session::step().
  OperatedVolume(const OperationScene& scene, const std::string& folder, Progress& progress);
  ~OperatedVolume();

  /// Returns a setup with this body in it; its rigid pieces stop instruments as "bone".
  OperationSetup joined_to(OperationSetup setup);
  /// Draws all views; frames count from 0.
  void draw_frame(const Operation& operation, int frame);
  /// Draws one view, which is the same in all calls, without a file.
  Image draw(const Operation& operation, const SceneView& view, int frame);
  /// Makes the videos after the last frame, under temporary names.
  void make_videos(PendingFiles& files);

  std::int64_t element_count() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

}  // namespace supple::tools
