// A picture that is coarse first: every eighth pixel of every eighth row, then every fourth,
// second, and all. Each pixel is marched once, so that the last picture is that of Renderer, bit
// for bit, and takes as long; the first takes 1/64 of that. A picture that follows another one of
// the same view marches only pixels that changed offsets may have altered.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <vector>

#include "raycast/render.h"

namespace supple {

struct PixelMarks;

class ProgressiveRender {
 public:
  /// The renderer must outlive the object, and keep its offsets and surfaces until the picture is
  /// finished. Throws InputError as Renderer does.
  ProgressiveRender(const Renderer& renderer, const Camera& camera,
                    const TransferFunction& transfer_function, const RenderSettings& settings);
  /// The same view of the renderer's offsets as they are now, which may have changed since. Of a
  /// finished picture it takes over the pixels whose rays read nothing that update_offsets changed;
  /// none where the box that rays enter has changed. Its first pass has at most 1/64 of a picture's
  /// pixels, too, and may be the last.
  std::unique_ptr<ProgressiveRender> follow() const;
  /// False where follow() takes over nothing: the picture is not finished, light is followed to its
  /// sources, or all offsets or the surfaces were set since.
  bool may_be_followed() const;
  ~ProgressiveRender();
  ProgressiveRender(const ProgressiveRender&) = delete;
  ProgressiveRender& operator=(const ProgressiveRender&) = delete;

  /// The next pass; false when it was cancelled or nothing is left to do.
  bool refine() { return refine_to(next_spacing()); }
  /// The next passes up to this spacing (1, 2, 4 or 8) as one, which takes less time; at least one.
  /// `progress` may cancel it, too.
  bool refine_to(int spacing, Progress* progress = nullptr);
  /// Cancels from any thread and for good: passes return after at most 16 pixels per thread.
  void cancel() { m_cancelled = true; }

  /// Pixels that were to be marched when it was begun.
  std::int64_t changed_pixels() const { return m_changed_pixels; }
  /// Spacing of the next pass; 1 when it is the last one or there is none.
  int next_spacing() const;
  /// Spacing of the pixels that are there: 8, 4, 2 or 1; 0 before the first pass.
  int spacing() const { return m_spacing; }
  bool finished() const { return m_spacing == 1; }
  /// Samples read from the source in complete passes.
  std::int64_t samples() const { return m_samples; }
  /// The picture so far, with pixels repeated over missing ones; not during refine().
  FloatImage picture() const;

 private:
  std::optional<std::vector<std::size_t>> changed_bricks() const;
  void take_over(const ProgressiveRender& before);

  /// The part of its context that a finished picture keeps.
  struct Followed {
    std::vector<std::uint8_t> visible;  // per brick
    Vec3d box_lo, box_hi;
    bool has_paths = false;
  };

  const Renderer& m_renderer;
  std::optional<std::uint64_t> m_version;  // Renderer::version
  Camera m_camera;
  TransferFunction m_function;
  RenderSettings m_settings;
  std::unique_ptr<RenderContext> m_context;  // null: finished
  Followed m_followed;
  FloatImage m_picture;
  std::unique_ptr<PixelMarks> m_marks;
  std::int64_t m_changed_pixels = 0;
  int m_first_spacing, m_spacing = 0;
  std::int64_t m_samples = 0;
  std::atomic<bool> m_cancelled{false};
};

/// Pictures one after the other, of which one in the same view as the last follows it.
class FollowedPictures {
 public:
  /// The picture of Renderer::render_float, bit for bit; the report counts what was marched, and no
  /// memory. The renderer must live until another one, or forget(). `view`: a text that differs
  /// where camera, function or settings do. Throws as render_float.
  FloatImage render(const Renderer& renderer, const Camera& camera,
                    const TransferFunction& transfer_function, const RenderSettings& settings,
                    const std::string& view, RenderReport* report, Progress* progress);
  void forget() { m_last.reset(); }

 private:
  std::unique_ptr<ProgressiveRender> m_last;  // finished
  const Renderer* m_renderer = nullptr;       // of m_last
  std::string m_view;
};

}  // namespace supple
