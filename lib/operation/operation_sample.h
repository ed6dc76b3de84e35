// One step of an operation as logs, tasks and scores see it.
#pragma once

#include <string>
#include <vector>

#include "lib/instruments/instrument.h"

namespace supple {

/// Something that happened in a step. Kinds, and what their value is:
/// touch: an instrument presses a surface, in each step in which it does; N
/// bleeding: a spot begins, once for each spot; mm² that it grows to
/// link_broken: a membrane is freed; mm²
/// edge_torn: a membrane tears; mm
/// gripped, released: jaws take hold of a membrane or let go; nodes
/// piece_lost: a torn-off piece vanishes; triangles
/// removed: a port takes vitreous; voxels
/// task_begun, task_done, target_reached, target_lost: of ScoreKeeper; the target's number from 1
struct OperationEvent {
  double time_s = 0;
  std::string kind;
  std::string instrument;  // empty: none
  std::string at;          // obstacle, membrane, task
  Vec3d place_mm{0, 0, 0};
  double value = 0;
};

struct InstrumentSample {
  InstrumentPose asked;  // by the hand
  InstrumentPose pose;   // that it has, in the eye's frame
  double force_n = 0;    // of all touches of rigid surfaces
  double pull_n = 0;     // with which membranes pull at it; not in logs
};

struct MembraneSample {
  std::string body;
  double clinging_mm2 = 0;
  int inverted = 0;  // triangles that face against those beside them
  // Not in logs:
  double longest_stretch = 1;  // of an edge, times its length at rest
  int pinched = 0;             // nodes that two things press at once
};

struct OperationSample {
  double time_s = 0;
  std::vector<InstrumentSample> instruments;
  std::vector<OperationEvent> events;
  Vec3d turn_degrees{0, 0, 0};            // of the eye from its frame to the head's: a vector
  Vec3d focus_mm{0, 0, 0};                // of the microscope, in the head's frame
  double zoom = 1;                        // of the microscope
  double clinging_mm2 = 0;                // of all membranes
  double vitreous_left = 1;               // part
  std::vector<MembraneSample> membranes;  // each, for tasks that name one
};

}  // namespace supple
