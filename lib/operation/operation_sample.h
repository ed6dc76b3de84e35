// One step of an operation as logs, tasks and scores see it.
#pragma once

#include <string>
#include <vector>

#include "lib/instruments/instrument.h"
#include "lib/instruments/tool_contact.h"

namespace supple {

/// Something that happened in a step. Kinds: touch (an instrument meets a surface), bleeding,
/// link_broken, edge_torn, gripped, released, piece_lost, removed, task_begun, task_done, target_reached,
/// target_lost.
struct OperationEvent {
  double time_s = 0;
  std::string kind;
  std::string instrument;  // empty: none
  std::string at;          // obstacle, membrane, task
  Vec3d place_mm{0, 0, 0};
  double value = 0;  // N of a touch, mm² of links, mm of edges, voxels, nodes
};

struct InstrumentSample {
  InstrumentPose asked;  // by the hand
  InstrumentPose pose;   // that it has, in the eye's frame
  double force_n = 0;    // of all touches
};

struct OperationSample {
  double time_s = 0;
  std::vector<InstrumentSample> instruments;
  std::vector<OperationEvent> events;
  Vec3d turn_degrees{0, 0, 0};    // of the eye, about x, y and z
  Vec3d focus_mm{0, 0, 0};        // of the microscope
  double zoom = 1;                // of the microscope
  double clinging_mm2 = 0;        // of all membranes
  double vitreous_left = 1;       // part
};

}  // namespace supple
