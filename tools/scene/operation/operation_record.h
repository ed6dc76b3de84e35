// All that is kept of an operation: its log, the poses that hands asked for, tasks and scores.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "lib/operation/operation.h"
#include "lib/operation/score.h"
#include "raycast/microscope/microscope.h"
#include "tools/scene/operation/operation_scene.h"
#include "tools/scene/pictures/picture_writer.h"
#include "tools/scene/run/output_plan.h"

namespace supple::tools {

class OperationRecord {
 public:
  /// Refers to the scene. Throws InputError for names of tasks and rules that the scene lacks.
  OperationRecord(const OperationScene& scene, const Operation& operation);
  ~OperationRecord();

  /// Adds the files that it writes. Throws as OutputPlan.
  void plan(const std::string& folder, OutputPlan& plan) const;
  /// Begins the log, where the scene wants one. Throws as OperationLog.
  void open(const std::string& folder);
  /// Takes the step that the operation has made, towards these poses in the head's frame.
  void take(const Operation& operation, const std::vector<InstrumentPose>& asked);
  /// Writes tracks and scores and ends the log, all under temporary names. Throws SystemError.
  void write(const std::string& folder, PendingFiles& files);
  /// Gives the log its name. Throws SystemError.
  void commit();

  /// Targets of tasks as pictures show them.
  std::vector<TaskBall> balls() const;
  const ScoreKeeper& keeper() const;
  /// Tasks, scores, how often each kind of event was, and the extremes of membranes.
  Value report() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

/// What tasks and scores know of a scene beside its samples.
OperationPlan plan_of(const OperationScene& scene);

}  // namespace supple::tools
