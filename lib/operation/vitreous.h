// Translucent body of voxels under instruments: pushed (pushed_body.h), cut and removed at a
// vitrector's port (thesis section 6.1.2: intended for EyeSi, "as soon as volume visualization is
// available").
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "lib/body/body.h"
#include "lib/body/slot_set.h"
#include "lib/instruments/instrument.h"
#include "lib/instruments/tool_contact.h"
#include "volumes/grid/density_grid.h"

namespace supple {

struct VitreousReport {
  std::int64_t moved = 0;    // elements
  std::int64_t removed = 0;  // elements
  bool stopped = false;      // anchors or limits left an element in a tool, deeper than a voxel
  double deepest_mm = 0;     // that an element is left in a tool
};

struct VitreousSetup {
  double radius_mm = 10;                                 // of the ball that it fills
  double spacing_mm = 0.3;                               // of voxels
  double stretch = 1.3, compression = 0.7, shear = 0.3;  // limits of links
  double clears_mm = 1;  // it stays this far from the wall, where it is anchored
};
Fields fields(VitreousSetup& setup);

class Vitreous {
 public:
  /// Throws InputError: a setup outside its ranges, a ball of fewer than three voxels across or
  /// more than 400. `outside`: surfaces from which it keeps its distance as from the wall, such as
  /// a lens.
  Vitreous(const VitreousSetup& setup, const Vec3d& centre_mm, std::uint64_t seed,
           const std::vector<Obstacle>& outside = {});
  ~Vitreous();
  Vitreous(Vitreous&&) noexcept;

  /// Pushes what the instruments enter ahead of them, one-sidedly, and removes what a port that is
  /// active reaches. Same bits for any number of threads.
  VitreousReport step(const std::vector<ToolMotion>& tools,
                      const std::vector<Instrument>& instruments);

  const Geometry& geometry() const;
  /// Densities of the elements that are left; made anew where some were removed since the last
  /// call, a few ms.
  const DensityGrid& density() const;
  /// All elements of the start: links of those that were removed are cut, and they stay where they
  /// were.
  const Body& body() const;
  bool is_left(Slot slot) const;
  double left_part() const;  // of its elements at the start
  /// Elements that the last step moved, by bricks of body().elements, and those that it removed.
  const std::vector<SlotSet::Brick>& moved() const;
  const std::vector<Slot>& removed() const;
  /// Elements of a brick that are left.
  const BrickMask& left(std::size_t brick) const;
  /// Steps that were made, and bricks of which elements were moved or removed after the first
  /// `step` of them: for pictures that do not follow each step.
  std::int64_t steps() const;
  std::vector<std::size_t> changed_since(std::int64_t step) const;
  std::string state_bytes() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

}  // namespace supple
