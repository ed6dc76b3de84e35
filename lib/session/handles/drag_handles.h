// Handles of a body from a step's drags: targets of every element, soft edges.
#pragma once

#include <vector>

#include "lib/session/handles/rigid_drag.h"

namespace supple {

struct HandleSurroundings {
  const Body& body;
  const DensityGrid& density;
  /// Cuts without the links that rigid pieces hide: an edge does not reach across them.
  const LinkCuts& cuts;
  /// Elements that a drag's edge may not take: anchors, and elements that earlier steps hold.
  SlotSet taken;
  /// Two-sided edges are held at their targets. Pushing ones go at least so far where the handle
  /// takes them further: limits too tight for the edge's slope then stop nothing.
  HandleKind edge_kind;
  /// Motions of rigid pieces, and the part of all motions that is asked for: pieces turn by that
  /// part of their angle, all other elements go that part of their straight way.
  const std::vector<PieceMotion>* pieces = nullptr;
  double part = 1;
  /// The body that motions start from (null: the body as it is), and the drags at the pose before:
  /// two-sided handles go to where `start` puts them, pushing ones on from that pose.
  const Body* start = nullptr;
  const std::vector<Drag>* earlier = nullptr;
};

/// The elements as a region.
Region region_of(const SlotSet& slots, const BrickTopology& elements, std::string name);

/// The handles of each drag, which grabs its entry of `regions`. An edge is a handle of its own
/// behind its handle, without elements that are taken, grabbed or rigid; elements of several edges
/// belong to the first. A rigid piece that drags touch is a handle as a whole. Throws InputError
/// for a region without element, a motion beyond the range.
std::vector<Handle> handles_of(const std::vector<Drag>& drags, const std::vector<Region>& regions,
                               const HandleSurroundings& around);

}  // namespace supple
