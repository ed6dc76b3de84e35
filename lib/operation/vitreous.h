// Translucent body of voxels under instruments: Enhanced ChainMail pushed by instruments, cut and
// removed at a vitrector's port (thesis section 6.1.2: intended for EyeSi, "as soon as volume
// visualization is available").
#pragma once

#include <memory>
#include <vector>

#include "lib/body/body.h"
#include "lib/instruments/instrument.h"
#include "volumes/grid/density_grid.h"

namespace supple {

struct VitreousReport {
  std::int64_t moved = 0;    // elements
  std::int64_t removed = 0;  // elements
  bool stopped = false;      // anchors or limits left no room for a push
};

struct VitreousSetup {
  double radius_mm = 10;     // of the ball that it fills
  double spacing_mm = 0.35;  // of voxels; 0.35 makes some 10^5 of them
  double stretch = 1.3, compression = 0.7, shear = 0.3;  // limits of links
  double clears_mm = 1;      // it stays this far from the wall, where it is anchored
};
Fields fields(VitreousSetup& setup);

class Vitreous {
 public:
  Vitreous(const VitreousSetup& setup, const Vec3d& centre_mm, std::uint64_t seed);
  ~Vitreous();

  /// Pushes what the instruments enter ahead of them, one-sidedly, and removes what a port that is
  /// active reaches.
  VitreousReport step(const std::vector<ToolMotion>& tools,
                      const std::vector<Instrument>& instruments);

  const Geometry& geometry() const;
  const DensityGrid& density() const;
  const Body& body() const;
  double left_part() const;  // of its elements at the start
  std::string state_bytes() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

}  // namespace supple
