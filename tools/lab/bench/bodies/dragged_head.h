// A head phantom that is dragged out of rest at the cheek, again and again, with its extended
// displacement kept up to date, for the rows `update` of the benchmarks.
#pragma once

#include <memory>
#include <vector>

#include "lib/body/body.h"
#include "lib/state/pose.h"
#include "tools/lab/bench/bodies/ecm_engines.h"
#include "tools/lab/bench/bodies/ecm_motion.h"
#include "volumes/field/inversion/invert.h"

namespace supple::tools {

class DraggedHead {
 public:
  /// About `wanted` elements move with every drag; the shell is two voxels thick. Throws Cancelled.
  DraggedHead(const Vec3i& size, std::int64_t wanted, Progress& cancel);

  /// Takes the head back to rest; returns the bricks of the displacement with a changed vector.
  std::vector<std::int32_t> reset();
  /// Drags; the displacement is as before until follow() is called.
  void drag();
  /// Brings the displacement up to date; returns the bricks that changed.
  std::vector<std::int32_t> follow() { return m_live.update(m_body.q); }

  const Body& body() const { return m_body; }
  const BrickTopology& shell() const { return m_shell; }
  const Displacement& displacement() const { return m_live.displacement(); }
  std::int64_t moved() const { return m_engine->moved(); }
  InvertParams params() const;

 private:
  Body m_body;
  BrickTopology m_shell;
  LiveDisplacement m_live;
  EcmWorkload m_workload;
  Vec3i m_voxel;
  double m_amplitude;
  std::unique_ptr<EcmEngine> m_engine;
};

}  // namespace supple::tools
