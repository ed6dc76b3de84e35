// Frames of a large head phantom, straight and deformed, each in turns with the straight frame of
// the same view; and how near every setting comes to a reference of much finer steps.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "raycast/render.h"
#include "tools/lab/bench/report/report.h"
#include "tools/lab/bench/report/timing.h"

namespace supple::tools {

/// One picture: a kind of deformation, a quality and the threads that march.
struct FrameSide {
  std::string kind;     // straight, identity, zero, local, extreme, half
  std::string setting;  // draft, default, accurate, reference
  int threads = 1;
};

std::string frame_row_name(const FrameSide& side);

/// The head, its renderers and the reference pictures found so far.
class FrameBench {
 public:
  FrameBench(const Vec3i& size, int image_size);
  ~FrameBench();

  /// Times the sides, all of one kind, in turns with the straight frame in the default setting.
  std::vector<BenchRow> measure(const std::vector<FrameSide>& sides, const RoundLimits& limits,
                                const std::function<void()>& before_run);

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

}  // namespace supple::tools
