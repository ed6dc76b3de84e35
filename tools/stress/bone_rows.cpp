#include "tools/stress/bone_rows.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "lib/body/piece_contact.h"
#include "lib/body/piece_overlap.h"
#include "lib/material/material_file.h"
#include "lib/material/presets.h"
#include "lib/session/session.h"

namespace supple::tools {

namespace {

const char* const kHead = "build/data/ct_head.nhdr";
const Vec3i kJaw(128, 211, 12), kSkull(128, 33, 80);

StepRequest parted_jaw() {
  StepRequest request;
  ChosenPart jaw;
  jaw.name = "upper jaw";
  jaw.selection = Selection();
  jaw.selection->box = IndexBox{{84, 150, 0}, {172, 235, 20}};
  jaw.selection->density = NumberPair{300, 3100};
  jaw.selection->piece_at = kJaw;
  request.rigid.parts = {jaw};
  request.rigid.joint_mm = 20;
  request.fix = {{kSkull, kSkull}};
  return request;
}

struct JawReport {
  double shifted = 0, turned = 0;  // overlap over rest, beyond what is allowed, voxels
  int opening = 0, opened = 0, stopped = 0, shrunk = 0;
};

/// A drag, and one of half its way.
void look_at(Session& session, const StepRequest& drag, double at_rest, JawReport& told) {
  const bool turns = drag.drags[0].motion.angle_deg != 0;
  const Vec3d& by = drag.drags[0].by_mm;
  const StepRecord& whole = session.step(drag);
  const double reached = whole.report.fraction();
  const double deeper = deepest_overlap(session.body()) - at_rest;
  double& most = turns ? told.turned : told.shifted;
  most = std::max(most, deeper);
  // Walls of the box that parts the jaw are above, behind and beside it.
  const bool opens = !turns && by.x == 0 && by.y >= 0 && by.z <= 0;
  told.opening += opens;
  told.opened += opens && !whole.bones;
  told.stopped += whole.bones.has_value();
  session.undo();
  if (turns) return;
  StepRequest half = drag;
  half.drags[0].by_mm *= 0.5;
  told.shrunk += session.step(half).report.fraction() / 2 > reached + 1e-4;
  session.undo();
}

}  // namespace

void run_bones(const StressInput& input, const std::string&, Console& console,
               MeasuredValues& all) {
  SessionOptions options;
  options.keeps_undo = true;
  options.material = parse_material(find_tissue_preset("ct-head")->table, "ct-head");
  options.material->relaxes = false;
  Session session(kHead, options, &console);
  session.step(parted_jaw(), &console);
  const double at_rest = deepest_overlap(session.body());
  std::mt19937 random(200);
  std::uniform_real_distribution<double> uniform(-1, 1);
  JawReport told;
  console.stage("drags");
  for (int n = 0; n < input.operations; ++n) {
    report(&console, double(n) / input.operations);
    Vec3d by(8 * uniform(random), 8 * uniform(random), 8 * uniform(random));
    if (n % 2 == 0) by = Vec3d(0, std::abs(by.y), -std::abs(by.z));
    StepRequest drag;
    drag.drags.push_back({Region(kJaw), by});
    if (n % 4 == 3) {
      drag.drags[0].motion.angle_deg = 5 * uniform(random);
      drag.drags[0].motion.axis_lps = {uniform(random), uniform(random), uniform(random)};
    }
    look_at(session, drag, at_rest, told);
  }
  all.push_back({"overlap after shifts, voxels", told.shifted, 0, kShiftedOverlap + 1e-3});
  all.push_back({"overlap after turns, voxels", told.turned, 0, kTurnedOverlap + 1e-3});
  all.push_back({"drags that bone stopped", double(told.stopped), 1, 1e9});
  all.push_back({"ways that shrank with the way asked", double(told.shrunk), 0, 0});
  const double opened = told.opening == 0 ? 1 : double(told.opened) / told.opening;
  all.push_back({"part of the drags that open the joint done whole", opened, 0.9, 1});
}

}  // namespace supple::tools
