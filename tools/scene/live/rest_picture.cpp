#include "tools/scene/live/rest_picture.h"

#include <algorithm>
#include <cmath>

#include "raycast/scene/clip.h"
#include "tools/scene/file/view.h"
#include "tools/scene/run/staging.h"
#include "tools/scene/run/view_pictures.h"
#include "volumes/base/relayed_progress.h"

namespace supple::tools {

namespace {

constexpr double kSmallestAtRest = 1.0 / 4;  // of width and height

RenderSettings settings_of(const LivePicture& picture) {
  RenderSettings settings = view_settings(picture.view());
  settings.clips = resolve_clips(picture.view().clips, picture.opened().geometry);
  return settings;
}

}  // namespace

RestPicture::RestPicture(const LivePicture& picture)
    : m_picture(picture),
      m_renderer(picture.opened().geometry, picture.opened().density, 0,
                 picture.view().sampling.interpolation) {}

Image RestPicture::draft(double budget_ms) {
  RenderSettings drafts = settings_of(m_picture);
  const double whole_ms = m_pixel.of(double(drafts.width) * drafts.height);
  const double part = std::clamp(std::sqrt(budget_ms / whole_ms), kSmallestAtRest, 1.0);
  drafts.set_quality(Quality::draft);
  drafts.width = std::max(1, int(std::lround(part * drafts.width)));
  drafts.height = std::max(1, int(std::lround(part * drafts.height)));
  const Stopwatch time;
  FloatImage seen =
      m_renderer.render_float(*m_picture.view().camera.camera, look_of(m_picture.view()), drafts);
  m_pixel.add(time.ms(), double(drafts.width) * drafts.height);
  if (!m_picture.view().decoration.annotate.empty()) return to_image(seen);
  return decorated(std::move(seen));
}

std::optional<Image> RestPicture::settled() {
  m_is_interrupted = false;
  CancelWhere progress(m_is_interrupted);
  try {
    return decorated(m_renderer.render_float(*m_picture.view().camera.camera,
                                             look_of(m_picture.view()), settings_of(m_picture),
                                             nullptr, &progress));
  } catch (const Cancelled&) {
    return std::nullopt;
  }
}

Image RestPicture::decorated(FloatImage seen) const {
  const State& state = m_picture.opened();
  const PosedVolume subject{
      state.geometry,  state.density, state.elements, nullptr, nullptr, 0, 1, 0,
      &state.elements, nullptr,       &state.labels};
  decorate(seen, subject, m_picture.view());
  return to_image(seen);
}

}  // namespace supple::tools
