// An operation from its first step to its last: tracks lead the instruments, pictures go into
// videos, steps and events into a log, and scores follow from it.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lib/operation/operation.h"
#include "tools/scene/operation/operation_scene.h"
#include "tools/scene/run/output_plan.h"
#include "volumes/base/progress.h"
#include "volumes/base/value.h"

namespace supple::tools {

class OperationPicture;
struct SceneView;

/// Choices of a run that the scene does not make.
struct OperationOptions {
  bool draws_every_step = false;  // the first view, for times as a live session has them
  bool makes_videos = true;
  /// View of a scanned volume that is drawn for each frame, for its times; null: none.
  std::shared_ptr<const SceneView> volume_view;
  std::string volume_image;  // the last of these pictures; empty: none
};

/// Times of all steps in ms.
struct OperationPhases {
  std::vector<float> contact, vitreous, volume, membranes, step, update, picture;
};

class OperationRun {
 public:
  /// Throws as Operation and OperatedVolume. Outputs go below `folder`. Refers to the scene and to
  /// `progress`.
  OperationRun(const OperationScene& scene, std::string folder, const OperationOptions& options,
               Progress& progress);
  ~OperationRun();

  /// Files that it will write; throws as OutputPlan.
  OutputPlan plan(bool may_overwrite) const;
  /// Carries all steps out and writes the files. Throws Cancelled: none of them is there then.
  void run(Progress& progress);

  const Operation& operation() const;
  /// Steps, times, what happened, digest of the end and scores.
  Value report() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

}  // namespace supple::tools
