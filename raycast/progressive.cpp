#include "raycast/progressive.h"

#include <algorithm>

#include "raycast/march/changed_pixels.h"
#include "raycast/march/march_pixels.h"
#include "volumes/base/relayed_progress.h"
#include "volumes/base/stopwatch.h"

namespace supple {

namespace {

constexpr int kFirstSpacing = 8;

/// A colour, and what else both pictures tell of the pixel.
void copy_pixel(const FloatImage& from, std::size_t pixel, FloatImage& to) {
  const auto copy = [pixel](const std::vector<float>& values, std::size_t count,
                            std::vector<float>& out) {
    if (out.empty()) return;
    std::copy_n(&values[count * pixel], count, &out[count * pixel]);
  };
  copy(from.rgba, 4, to.rgba);
  copy(from.depth_mm, 1, to.depth_mm);
  copy(from.normal_lps, 3, to.normal_lps);
  copy(from.offset_mm, 1, to.offset_mm);
}

class Cancellation final : public RelayedProgress {
 public:
  Cancellation(const std::atomic<bool>& flag, Progress* next)
      : RelayedProgress(next), m_flag(flag) {}
  bool cancelled() const override { return m_flag || RelayedProgress::cancelled(); }

 private:
  const std::atomic<bool>& m_flag;
};

/// Values of pixels that are not there taken from the one at the corner of their square; `count`
/// values per pixel.
void repeat(const PixelMarks& marks, std::vector<float>& values, int width, int spacing,
            std::size_t count) {
  for (std::size_t n = 0; n < values.size() / count; ++n) {
    if (!marks.is_there.empty() && marks.is_there[n]) continue;
    const std::size_t x = n % width, y = n / width;
    const std::size_t from = (y - y % spacing) * width + x - x % spacing;
    for (std::size_t c = 0; c < count; ++c) values[count * n + c] = values[count * from + c];
  }
}

/// The first spacing at which this many of all pixels take no longer than all do at kFirstSpacing.
int first_spacing(std::int64_t changed, std::int64_t all) {
  int spacing = kFirstSpacing;
  while (spacing > 1 && changed * kFirstSpacing * kFirstSpacing * 4 <= all * spacing * spacing) {
    spacing /= 2;
  }
  return spacing;
}

}  // namespace

ProgressiveRender::ProgressiveRender(const Renderer& renderer, const Camera& camera,
                                     const TransferFunction& transfer_function,
                                     const RenderSettings& settings)
    : m_renderer(renderer),
      m_version(renderer.version()),
      m_camera(camera),
      m_function(transfer_function),
      m_settings(settings),
      m_context(renderer.prepare(camera, transfer_function, settings)),
      m_picture(settings.width, settings.height, settings.auxiliary),
      m_marks(std::make_unique<PixelMarks>()),
      m_changed_pixels(std::int64_t(m_picture.pixel_count())),
      m_first_spacing(kFirstSpacing) {
  m_marks->opaque_from_mm.resize(m_picture.pixel_count());
}

ProgressiveRender::~ProgressiveRender() = default;

std::unique_ptr<ProgressiveRender> ProgressiveRender::follow() const {
  auto next = std::make_unique<ProgressiveRender>(m_renderer, m_camera, m_function, m_settings);
  next->take_over(*this);
  return next;
}

/// Bricks that have changed since it was begun; null: everything may have changed.
std::optional<std::vector<std::size_t>> ProgressiveRender::changed_bricks() const {
  return m_version ? m_renderer.changed_since(*m_version) : std::nullopt;
}

bool ProgressiveRender::may_be_followed() const {
  return finished() && !m_followed.has_paths && changed_bricks().has_value();
}

int ProgressiveRender::next_spacing() const {
  return m_spacing == 0 ? m_first_spacing : std::max(m_spacing / 2, 1);
}

void ProgressiveRender::take_over(const ProgressiveRender& before) {
  const Followed& was = before.m_followed;
  if (!before.may_be_followed() || m_context->box_lo != was.box_lo ||
      m_context->box_hi != was.box_hi) {
    return;
  }
  std::optional<std::vector<std::size_t>> changed = before.changed_bricks();
  const auto shows_nothing = [&](std::size_t b) {
    return !m_context->output_visible[b] && !(b < was.visible.size() && was.visible[b]);
  };
  changed->erase(std::remove_if(changed->begin(), changed->end(), shows_nothing), changed->end());

  m_marks->opaque_from_mm = before.m_marks->opaque_from_mm;
  m_marks->is_there =
      unchanged_pixels(*m_context, m_camera, *changed, before.m_marks->opaque_from_mm);
  m_changed_pixels = 0;
  for (std::size_t n = 0; n < m_marks->is_there.size(); ++n) {
    if (!m_marks->is_there[n]) {
      ++m_changed_pixels;
    } else {
      copy_pixel(before.m_picture, n, m_picture);
    }
  }
  m_first_spacing = first_spacing(m_changed_pixels, std::int64_t(m_picture.pixel_count()));
}

bool ProgressiveRender::refine_to(int spacing, Progress* progress) {
  if (finished()) return false;
  spacing = std::min(spacing, next_spacing());
  Cancellation either(m_cancelled, progress);
  try {
    m_samples +=
        march_pixels(*m_context, m_camera, {spacing, m_spacing}, m_picture, &either, m_marks.get());
  } catch (const Cancelled&) {
    return false;
  }
  m_spacing = spacing;
  if (finished()) {
    m_followed = {std::move(m_context->output_visible), m_context->box_lo, m_context->box_hi,
                  m_context->medium != nullptr};
    m_context.reset();
  }
  return true;
}

FloatImage ProgressiveRender::picture() const {
  FloatImage picture = m_picture;
  if (m_spacing <= 1) return picture;
  repeat(*m_marks, picture.rgba, picture.width, m_spacing, 4);
  repeat(*m_marks, picture.depth_mm, picture.width, m_spacing, 1);
  repeat(*m_marks, picture.normal_lps, picture.width, m_spacing, 3);
  repeat(*m_marks, picture.offset_mm, picture.width, m_spacing, 1);
  return picture;
}

FloatImage FollowedPictures::render(const Renderer& renderer, const Camera& camera,
                                    const TransferFunction& transfer_function,
                                    const RenderSettings& settings, const std::string& view,
                                    RenderReport* report, Progress* progress) {
  stage(progress, "rendering");
  const std::unique_ptr<ProgressiveRender> last = std::move(m_last);
  const bool follows = last && m_renderer == &renderer && m_view == view;
  // Which surface is seen is not taken over.
  if (settings.tells_surfaces) {
    return renderer.render_float(camera, transfer_function, settings, report, progress);
  }
  const Stopwatch preparing;
  auto next =
      follows && last->may_be_followed()
          ? last->follow()
          : std::make_unique<ProgressiveRender>(renderer, camera, transfer_function, settings);
  const double prepare_ms = preparing.ms();
  const Stopwatch marching;
  if (!next->refine_to(1, progress)) throw Cancelled();
  if (report != nullptr) {
    *report = {next->samples(), next->changed_pixels(), prepare_ms, marching.ms(), 0};
  }
  m_last = std::move(next);
  m_renderer = &renderer;
  m_view = view;
  return m_last->picture();
}

}  // namespace supple
