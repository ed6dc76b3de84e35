// A picture that is coarse first: every eighth pixel of every eighth row, then every fourth,
// second, and all. Each pixel is marched once, so that the last picture is that of Renderer, bit
// for bit, and takes as long; the first takes 1/64 of that.
#pragma once

#include <atomic>
#include <memory>

#include "raycast/render.h"

namespace supple {

class ProgressiveRender {
 public:
  /// The renderer must outlive the object and keep its offsets and surfaces. Throws InputError as
  /// Renderer does.
  ProgressiveRender(const Renderer& renderer, const Camera& camera,
                    const TransferFunction& transfer_function, const RenderSettings& settings);
  ~ProgressiveRender();
  ProgressiveRender(const ProgressiveRender&) = delete;
  ProgressiveRender& operator=(const ProgressiveRender&) = delete;

  /// The next pass; false when it was cancelled or nothing is left to do.
  bool refine();
  /// From any thread and for good: a running refine() returns after at most 16 pixels per thread.
  void cancel() { m_cancelled = true; }

  /// Spacing of the pixels that are there: 8, 4, 2 or 1; 0 before the first pass.
  int spacing() const { return m_spacing; }
  bool finished() const { return m_spacing == 1; }
  /// Samples read from the source in complete passes.
  std::int64_t samples() const { return m_samples; }
  /// The picture so far, with pixels repeated over missing ones; not during refine().
  FloatImage picture() const;

 private:
  Camera m_camera;
  std::unique_ptr<RenderContext> m_context;
  FloatImage m_picture;
  int m_spacing = 0;
  std::int64_t m_samples = 0;
  std::atomic<bool> m_cancelled{false};
};

}  // namespace supple
