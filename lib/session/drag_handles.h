// From drags, as a step asks for them, to handles of a body: targets of every element, soft edges.
#pragma once

#include <vector>

#include "lib/session/step.h"

namespace supple {

/// What a drag's edge may not take: anchors, and what earlier steps hold.
struct HandleSurroundings {
  const Body& body;
  const DensityGrid& density;
  SlotSet taken;
  /// Two-sided edges are held at their targets. Pushing ones go at least so far where the handle
  /// takes them further: limits too tight for the edge's slope then stop nothing.
  HandleKind edge_kind;
};

/// The handles of each drag, `regions` being what they grab; edges are handles of their own behind
/// theirs, without what is taken or grabbed, and where several meet with the first. Throws
/// InputError for a region without element, a motion beyond the range.
std::vector<Handle> handles_of(const std::vector<Drag>& drags, const std::vector<Region>& regions,
                               const HandleSurroundings& around);

}  // namespace supple
