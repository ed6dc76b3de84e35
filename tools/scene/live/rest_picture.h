// The body of a live session at rest, as its view sees it, beside the picture of the body as it is:
// what a curtain is drawn over. It has a renderer of its own, so that neither the session nor its
// picture know of it.
#pragma once

#include <atomic>
#include <optional>

#include "raycast/render.h"
#include "tools/scene/live/live_picture.h"
#include "volumes/base/stopwatch.h"

namespace supple::tools {

class RestPicture {
 public:
  /// Refers to the picture, whose body must not be opened anew (LivePicture::counts).
  explicit RestPicture(const LivePicture& picture);

  /// A picture of the view at draft quality, as large as it gets in about `budget_ms`.
  Image draft(double budget_ms);
  /// The settled picture of the view with the body at rest, bit for bit; none where it was
  /// interrupted.
  std::optional<Image> settled();
  /// Called from another thread: settled() returns soon.
  void interrupt() { m_is_interrupted = true; }

  const Renderer& renderer() const { return m_renderer; }

 private:
  Image decorated(FloatImage seen) const;

  const LivePicture& m_picture;
  Renderer m_renderer;
  std::atomic<bool> m_is_interrupted{false};
  CostPer m_pixel{4e-4};
};

}  // namespace supple::tools
