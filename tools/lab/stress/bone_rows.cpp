#include <algorithm>
#include <cmath>
#include <random>

#include "lib/contact/piece_contact.h"
#include "lib/contact/piece_overlap.h"
#include "lib/material/material.h"
#include "lib/material/presets.h"
#include "lib/session/handles/rigid_drag.h"
#include "lib/session/session.h"
#include "tools/lab/stress/stress_rows.h"

namespace supple::tools {

namespace {

const char* const kHead = "build/data/ct_head.nhdr";
const Vec3i kJaw(128, 211, 12), kSkull(128, 33, 80);

Step parted_jaw() {
  Step request;
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

/// Whether no part of the way leaves what is dragged deeper in other bones than it is.
bool opens(const Session& session, const OverlapJudge& judge, const Step& drag, double at_rest) {
  constexpr int kSamples = 24;
  constexpr double kRounding = 1e-3;
  std::vector<Region> regions;
  for (const Drag& each : drag.drags) regions.push_back(each.region);
  std::vector<std::size_t> moved;
  const auto motions = motions_of_pieces(session.body(), drag.drags, regions);
  for (const PieceMotion& motion : motions) moved.push_back(motion.piece);
  const double enough = at_rest + kRounding;
  return judge.deepest_on_way(moved, motions.front().motion, kSamples, enough) <= enough;
}

/// A drag, and one of half its way.
void look_at(Session& session, const OverlapJudge& judge, const Step& drag, double at_rest,
             JawReport& told) {
  const bool turns = drag.drags[0].motion.angle_deg != 0;
  const bool is_opening = opens(session, judge, drag, at_rest);
  const StepRecord& whole = session.step(drag);
  const double reached = whole.report.fraction();
  const double deeper = deepest_overlap(session.body()) - at_rest;
  double& most = turns ? told.turned : told.shifted;
  most = std::max(most, deeper);
  told.opening += is_opening;
  told.opened += is_opening && reached == 1;
  told.stopped += whole.bones.has_value();
  session.undo();
  if (turns) return;
  Step half = drag;
  half.drags[0].by_mm *= 0.5;
  told.shrunk += session.step(half).report.fraction() / 2 > reached + 1e-4;
  session.undo();
}

/// Rami that seeds part from the skull, both led alike, from where their condyles have left the
/// fossae: in all directions and turned about these.
JawReport open_rami(const SessionOptions& options, int drags, Console& console) {
  const std::vector<Vec3i> rami = {{83, 150, 4}, {175, 150, 4}};
  Session session(kHead, options, &console);
  Step down;
  down.rigid.joint_mm = 20;
  down.rigid.seeds = {rami[0], rami[1], kJaw};
  down.fix = {{kJaw, kJaw}};
  for (const Vec3i& ramus : rami) down.drags.push_back({Region(ramus), {0, 0, -3}});
  session.step(down, &console);
  const OverlapJudge judge(session.body());
  const double at_rest = judge.deepest();
  std::mt19937 random(51);
  std::uniform_real_distribution<double> uniform(-1, 1);
  JawReport told;
  for (int n = 0; told.opening < drags && n < 10 * drags; ++n) {
    Vec3d by(uniform(random), uniform(random), -1.2 * std::abs(uniform(random)));
    by *= 0.5 + 4.5 * std::abs(uniform(random));
    HandleMotion turn{session.geometry().world_from_index({128, 128, 21}), {1, 0, 0}};
    if (n % 2 == 1) turn.angle_deg = 8 * uniform(random);
    Step drag;
    for (const Vec3i& ramus : rami) {
      drag.drags.push_back({Region(ramus), by});
      drag.drags.back().motion = turn;
    }
    if (!opens(session, judge, drag, at_rest)) continue;
    report(&console, double(told.opening) / drags);
    const StepRecord& record = session.step(drag);
    ++told.opening;
    told.opened += record.report.fraction() == 1;
    told.stopped += record.bones.has_value();
    session.undo();
  }
  return told;
}

/// Share of the opening drags that reached their end; 1 if there were none.
double part_opened(const JawReport& told) {
  return told.opening == 0 ? 1 : double(told.opened) / told.opening;
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
  const OverlapJudge judge(session.body());
  const double at_rest = judge.deepest();
  std::mt19937 random(200);
  std::uniform_real_distribution<double> uniform(-1, 1);
  JawReport told;
  console.stage("drags");
  for (int n = 0; n < input.operations; ++n) {
    report(&console, double(n) / input.operations);
    Vec3d by(8 * uniform(random), 8 * uniform(random), 8 * uniform(random));
    if (n % 2 == 0) by = Vec3d(0, std::abs(by.y), -std::abs(by.z));
    Step drag;
    drag.drags.push_back({Region(kJaw), by});
    if (n % 4 == 3) {
      drag.drags[0].motion.angle_deg = 5 * uniform(random);
      drag.drags[0].motion.axis_lps = {uniform(random), uniform(random), uniform(random)};
    }
    look_at(session, judge, drag, at_rest, told);
  }
  all.push_back({"overlap after shifts, voxels", told.shifted, 0, kShiftedOverlap + 1e-3});
  all.push_back({"overlap after turns, voxels", told.turned, 0, kTurnedOverlap + 1e-3});
  all.push_back({"drags that bone stopped", double(told.stopped), 1, 1e9});
  all.push_back({"ways that shrank with the way asked", double(told.shrunk), 0, 0});
  all.push_back({"drags that open the joint", double(told.opening), 0.3 * input.operations, 1e9});
  all.push_back({"part of them done whole", part_opened(told), 0.9, 1});
  console.stage("drags of the lower jaw");
  const JawReport rami = open_rami(options, 60, console);
  all.push_back({"drags that open the jaw", double(rami.opening), 60, 60});
  all.push_back({"of them stopped by bone", double(rami.stopped), 0, 0});
  // Limits of tissue stop the others: ct-head lets muscles shear by less than head_jaw.toml.
  all.push_back({"part of them done whole, of the jaw", part_opened(rami), 0.8, 1});
}

}  // namespace supple::tools
