// The engines of the ECM benchmark behind one face, so that a comparison treats them alike.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>

#include "lib/body/body.h"
#include "volumes/base/progress.h"

namespace supple::tools {

/// A pull at one voxel, 2^-16 voxel along i, j, k.
struct BenchDrag {
  Vec3i voxel;
  std::array<std::int32_t, 3> by_q;
};

class EcmEngine {
 public:
  virtual ~EcmEngine() = default;
  /// Takes all elements back to rest, memory kept where the engine can.
  virtual void reset() = 0;
  /// Sets anchors for the pulls that follow. Throws Error: multiset knows none.
  virtual void fix(const IndexBox& box) = 0;
  /// Pulls: the timed part.
  virtual void pull(const BenchDrag& pull) = 0;
  /// Elements that the last pull moved.
  virtual std::int64_t moved() = 0;
  /// Most nodes (bricks on the path `block`) that waited at one time during the last pull.
  virtual std::int64_t max_list() const = 0;
  /// The engine that did the work: multiset, flat or block.
  virtual std::string path() const = 0;
  /// A sum that is equal for equal offsets of equal elements, whatever their order in memory.
  virtual std::uint64_t checksum() const = 0;
};

/// `name`: "multiset" (the thesis' algorithm in exact arithmetic, on nodes and chains of its own),
/// "bucket" (the flat engine) or "supple" (which chooses by itself), which move `body` itself.
/// `cancel` may be polled while they run.
std::unique_ptr<EcmEngine> make_engine(const std::string& name, Body& body, Progress* cancel);

/// Memory that the multiset engine is expected to take for that many voxels of the body's box.
std::int64_t expected_multiset_bytes(const Vec3i& size);

/// Forgets all offsets of the body and their memory.
void release_offsets(Body& body);

}  // namespace supple::tools
