#include "lib/session/hand/hand_level.h"

#include <cmath>

#include "lib/session/hand/live_shape.h"
#include "lib/session/hand/solid_ahead.h"
#include "volumes/base/relayed_progress.h"

namespace supple {

namespace {

/// A shift as long, across the other.
Vec3d across(const Vec3d& by_mm) {
  int least = 0;
  for (int axis = 1; axis < 3; ++axis) {
    if (std::abs(by_mm[axis]) < std::abs(by_mm[least])) least = axis;
  }
  Vec3d axis(0);
  axis[least] = 1;
  const Vec3d way = by_mm.cross(axis);
  return way * (by_mm.length() / way.length());
}

}  // namespace

void move_to_hand_level(const ModelTask& task) {
  StepRecord& record = task.record;
  const FemStep& fem = *record.fem;
  if (record.drags.size() != 1) {
    throw InputError({record.place, "drag", std::to_string(record.drags.size()) + " handles",
                      "one, under the hand"});
  }
  CancelOnly unsaid(task.progress);
  stage(task.progress, kSolidAheadStage);
  SolidAhead ahead(task.in, fem);
  ahead.run(&unsaid);
  stage(task.progress, "responses of the hand");
  Step grab = record;
  Drag& drag = grab.drags.front();
  const DragPose target{drag.by_mm, drag.motion};
  drag.by_mm = Vec3d(0);
  drag.motion = {};
  std::vector<DragPose> directions = {target};
  if (target.motion.is_shift() && target.by_mm != Vec3d(0))
    directions.push_back({across(target.by_mm), {}});
  LiveResponses live(task.in, grab, std::move(directions));
  live.run(&unsaid, ahead.voxels(), fem.hand_levels);
  stage(task.progress, "following");
  const LivePose pose = live.pose(target);
  Body& body = task.in.body;
  for (BrickValues& q : body.q) q.resize(body.elements.brick_count());
  LiveShape(body).put(live, pose, body.q);
  for (auto& fraction : body.fraction) fraction.clear();
  const std::vector<RigidPose> poses = live.piece_poses(pose);
  for (std::size_t n = 0; n < poses.size(); ++n) body.rigid.list[n].pose = poses[n];
  record.equilibrium.links = check_links(body);
  body.links_known_valid = record.equilibrium.links.violated == 0;
  body.beyond.reset();
  task.start_anew();
}

}  // namespace supple
