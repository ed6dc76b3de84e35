// Body of voxels under instruments: Enhanced ChainMail pushed one-sidedly by what moves (thesis
// section 6.1.2). It is generated, such as a vitreous body, or scanned.
//
// Quasi-static: what a tool leaves stays where it was pushed to. Instruments slide in it: elements
// that they enter go out along the normal of the surface, one-sidedly, in substeps short against
// the tool. Limits of links come first: where they leave no room an element stays in the tool.
// Memory does not grow.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lib/body/body.h"
#include "lib/body/slot_set.h"
#include "lib/instruments/instrument.h"
#include "lib/instruments/voxel_solid.h"

namespace supple {

struct PushReport {
  std::int64_t moved = 0;  // elements
  bool stopped = false;    // anchors or limits left an element in a tool, deeper than a voxel
  double deepest_mm = 0;   // that an element is left in a tool
};

class PushedBody {
 public:
  /// Refers to the body, whose links must hold and whose elements must not change. Held elements
  /// stay where they are.
  PushedBody(Body& body, const SlotSet& held);
  ~PushedBody();

  /// Pushes what the parts enter ahead of them. Same bits for any number of threads.
  PushReport push(const std::vector<MovingPart>& parts);
  /// Elements that the last push moved, by bricks.
  const std::vector<SlotSet::Brick>& moved() const;

  /// Removes the elements within the cones that are asked for by their places, and cuts their
  /// links; pieces that no link joins to held elements then go where tools push them. Returns what
  /// was removed, ascending.
  std::vector<Slot> remove(const std::vector<RoundCone>& cones,
                           const std::function<bool(const Vec3d& place_mm)>& is_asked_for);
  /// Elements that are left, per brick.
  const std::vector<BrickMask>& left() const;
  /// Elements of pieces that are adrift.
  std::int64_t adrift() const;
  /// Bytes by which two states differ.
  std::string state_bytes() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

/// The rigid pieces of a body as something that stops instruments, to the nearest voxel where they
/// are; nothing without any.
std::optional<VoxelSolid> solid_of(const Body& body);

/// Motions of all parts of all instruments.
std::vector<MovingPart> parts_of(const std::vector<ToolMotion>& tools);

}  // namespace supple
