#include "tools/live/live_picture.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <mutex>
#include <set>

#include <tbb/parallel_for.h>

#include "raycast/progressive.h"
#include "tools/outputs/staging.h"
#include "tools/outputs/view_pictures.h"
#include "volumes/field/inversion/forward_offsets.h"
#include "volumes/field/inversion/invert.h"
#include "volumes/state/live_displacement.h"

namespace supple::tools {

namespace {

/// A running mean of a cost per piece of work, which follows the last few.
class CostPer {
 public:
  explicit CostPer(double guess_ms) : m_ms(guess_ms) {}
  double of(double count) const { return m_ms * count; }
  void add(double ms, double count) {
    if (count <= 0) return;
    m_ms = m_is_measured ? 0.6 * m_ms + 0.4 * ms / count : ms / count;
    m_is_measured = true;
  }

 private:
  double m_ms;
  bool m_is_measured = false;
};

constexpr double kSmallest = 1.0 / 8;    // of width and height, of a picture in a hurry
constexpr double kLeastPart = 0.25;      // of the budget that rays have in any case
constexpr double kBudgetToAimAt = 0.85;  // what is left covers what varies

using Changed = std::set<std::int32_t>;

/// Two pixels in a row and the part of the later one, in 256ths.
struct Between {
  int low, high, part;
};

std::vector<Between> places_between(int to, int from) {
  std::vector<Between> places;
  for (int n = 0; n < to; ++n) {
    const double place = std::clamp((n + 0.5) * from / to - 0.5, 0.0, double(from - 1));
    places.push_back({int(place), std::min(int(place) + 1, from - 1),
                      int(std::lround(256 * (place - std::floor(place))))});
  }
  return places;
}

std::vector<std::int32_t> take(Changed& changed) {
  const Changed taken = std::exchange(changed, {});
  return {taken.begin(), taken.end()};
}

}  // namespace

struct LivePicture::Impl {
  Impl(Session& session_, const SceneView& view_, Console& console_)
      : session(session_), console(console_), view(view_) {
    open();
  }

  /// All that depends on which voxels are elements.
  void open();
  bool follow();
  void follow_forward();
  void follow_inverse();
  void follow_for_sooner(double pixels, LiveCost& cost);
  PosedVolume subject() const;
  RenderSettings settings() const;
  void replace(std::unique_ptr<ProgressiveRender> next);

  Session& session;
  Console& console;
  State state;  // as opened; its q is not kept up to date
  std::unique_ptr<LiveDisplacement> moved;
  std::shared_ptr<ForwardOffsets> forward;
  std::unique_ptr<IncrementalInversion> inversion;
  std::unique_ptr<Renderer> renderer;
  Changed for_forward, for_inverse;  // bricks in which the displacement has changed since
  bool is_inverse_shown = false, is_cut_shown = false;
  LinkCuts cuts;

  SceneView view;
  Camera camera;
  bool is_new = true;
  std::mutex guard;  // of what interrupt() reaches from another thread
  std::unique_ptr<ProgressiveRender> progressive;
  CostPer forward_brick{0.02}, inverse_brick{0.08}, forward_pixel{5e-4}, inverse_pixel{4e-4},
      frame{8};
};

void LivePicture::Impl::open() {
  renderer.reset();
  inversion.reset();
  forward.reset();
  state = session.state();
  moved =
      std::make_unique<LiveDisplacement>(state.geometry, state.elements, state.density.bricks());
  moved->update(state.q);
  InvertParams params;
  params.material = &state.elements;
  inversion = std::make_unique<IncrementalInversion>(moved->displacement(), params, &console);
  forward = std::make_shared<ForwardOffsets>(moved->displacement(), &state.elements);
  renderer =
      std::make_unique<Renderer>(state.geometry, state.density, 0, view.sampling.interpolation);
  for_forward.clear();
  for_inverse.clear();
  is_inverse_shown = false;
  cuts = {};
}

bool LivePicture::Impl::follow() {
  const Body& body = session.body();
  if (!(body.elements == state.elements)) {
    open();
    return true;
  }
  const std::vector<std::int32_t> changed = moved->update(body.q);
  for_forward.insert(changed.begin(), changed.end());
  for_inverse.insert(changed.begin(), changed.end());
  const bool is_cut = body.cuts != cuts;
  if (is_cut) cuts = body.cuts;
  return is_cut || !changed.empty();
}

void LivePicture::Impl::follow_forward() {
  if (!for_forward.empty()) {
    forward->update(take(for_forward));
    renderer->set_pointwise_offsets(forward);
    is_inverse_shown = false;
  } else if (is_inverse_shown) {
    renderer->set_pointwise_offsets(forward);
    is_inverse_shown = false;
  }
}

/// Where links are cut everything is inverted anew, since the displacement may jump.
void LivePicture::Impl::follow_inverse() {
  const bool is_up_to_date = is_inverse_shown && for_inverse.empty();
  if (!cuts.empty()) {
    renderer->set_offsets(&session.pose(&console).offsets,
                          view.half_offsets ? OffsetResolution::half : OffsetResolution::full);
    is_cut_shown = true;
    is_inverse_shown = true;
    return;
  }
  if (is_up_to_date && !is_cut_shown) return;
  const std::vector<Vec3i> touched = inversion->update(moved->displacement(), take(for_inverse));
  if (is_cut_shown || view.half_offsets) {
    const OffsetField all = inversion->field();
    renderer->set_offsets(&all,
                          view.half_offsets ? OffsetResolution::half : OffsetResolution::full);
  } else {
    renderer->update_offsets(touched, inversion->finder());
  }
  is_cut_shown = false;
  is_inverse_shown = true;
}

void LivePicture::Impl::follow_for_sooner(double pixels, LiveCost& cost) {
  const auto start = std::chrono::steady_clock::now();
  const double forward_ms = forward_brick.of(double(for_forward.size())) + forward_pixel.of(pixels);
  const double inverse_ms = inverse_brick.of(double(for_inverse.size())) + inverse_pixel.of(pixels);
  cost.by_inverse = !cuts.empty() || inverse_ms <= forward_ms;
  const std::size_t bricks = cost.by_inverse ? for_inverse.size() : for_forward.size();
  if (cost.by_inverse) {
    follow_inverse();
  } else {
    follow_forward();
  }
  cost.prepare_ms = ms_since(start);
  if (cuts.empty()) {
    (cost.by_inverse ? inverse_brick : forward_brick).add(cost.prepare_ms, double(bricks));
  }
}

PosedVolume LivePicture::Impl::subject() const {
  return {state.geometry,
          state.density,
          state.elements,
          nullptr,
          &moved->displacement(),
          0,
          1,
          0,
          &state.elements,
          &session.body().cuts,
          &state.labels};
}

RenderSettings LivePicture::Impl::settings() const {
  RenderSettings all = view_settings(view);
  all.clips = resolve_clips(view.clips, state.geometry);
  return all;
}

void LivePicture::Impl::replace(std::unique_ptr<ProgressiveRender> next) {
  const std::lock_guard lock(guard);
  progressive = std::move(next);
}

double ms_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

LivePicture::LivePicture(Session& session, const SceneView& view, Console& console)
    : m_impl(std::make_unique<Impl>(session, view, console)) {
  look(view);
}

LivePicture::~LivePicture() = default;

void LivePicture::look(const SceneView& view) {
  Impl& impl = *m_impl;
  check_view(view);
  const Interpolation before = impl.view.sampling.interpolation;
  impl.view = effective_view(view, impl.state.geometry, impl.state.density.background());
  if (impl.view.sampling.interpolation != before) impl.open();
  impl.camera = framed_camera(impl.subject(), impl.renderer.get(), impl.view, impl.console);
  impl.view.camera.camera = impl.camera;
  impl.view.fit.clear();
  impl.view.zoom = 1;
  impl.is_new = true;
}

bool LivePicture::follow() {
  if (m_impl->follow()) m_impl->is_new = true;
  if (!m_impl->is_new) return false;
  m_impl->replace({});
  m_settled.reset();
  m_impl->is_new = false;
  return true;
}

void LivePicture::prepare() {
  m_cost = {};
  m_impl->follow_for_sooner(double(m_impl->view.size[0]) * m_impl->view.size[1] / 8, m_cost);
}

Image LivePicture::first_pixels(double budget_ms) {
  Impl& impl = *m_impl;
  RenderSettings settings = impl.settings();
  const double pixels = double(settings.width) * settings.height;
  const int width = settings.width, height = settings.height;
  CostPer& pixel = m_cost.by_inverse ? impl.inverse_pixel : impl.forward_pixel;
  double part = 1;
  if (budget_ms > 0) {
    const double left =
        std::max(kBudgetToAimAt * budget_ms - impl.frame.of(1), kLeastPart * budget_ms);
    part = std::clamp(std::sqrt(left / std::max(pixel.of(pixels), 1e-9)), kSmallest, 1.0);
    settings.set_quality(Quality::draft);
  }
  settings.width = std::max(1, int(std::lround(part * width)));
  settings.height = std::max(1, int(std::lround(part * height)));
  settings.auxiliary = false;
  const auto start = std::chrono::steady_clock::now();
  RenderReport report;
  FloatImage picture =
      impl.renderer->render_float(impl.camera, look_of(impl.view), settings, &report);
  m_cost.width = settings.width;
  m_cost.height = settings.height;
  if (impl.view.decoration.annotate.empty()) decorate(picture, impl.subject(), impl.view);
  Image image = enlarged(to_image(picture), width, height);
  m_cost.march_ms = report.march_ms;
  m_cost.frame_ms = ms_since(start) - report.march_ms;
  impl.frame.add(m_cost.frame_ms, 1);
  pixel.add(m_cost.march_ms, double(settings.width) * settings.height);
  return image;
}

bool LivePicture::refine() {
  Impl& impl = *m_impl;
  if (m_settled) return false;
  if (!impl.progressive) {
    const auto start = std::chrono::steady_clock::now();
    const double bricks = double(impl.for_inverse.size());
    impl.follow_inverse();
    if (impl.cuts.empty()) impl.inverse_brick.add(ms_since(start), bricks);
    impl.replace(std::make_unique<ProgressiveRender>(*impl.renderer, impl.camera,
                                                     look_of(impl.view), impl.settings()));
    return true;
  }
  const bool was_interrupted = !impl.progressive->refine();
  if (was_interrupted) impl.replace({});
  if (was_interrupted || !impl.progressive->finished()) return true;
  FloatImage picture = impl.progressive->picture();
  decorate(picture, impl.subject(), impl.view);
  m_settled = to_image(picture);
  return false;
}

void LivePicture::interrupt() {
  const std::lock_guard lock(m_impl->guard);
  if (m_impl->progressive) m_impl->progressive->cancel();
}

Image enlarged(const Image& image, int width, int height) {
  if (image.width == width && image.height == height) return image;
  Image large(width, height);
  large.has_alpha = image.has_alpha;
  const std::vector<Between> across = places_between(width, image.width);
  const std::vector<Between> down = places_between(height, image.height);
  tbb::parallel_for(0, height, [&](int y) {
    const std::uint8_t* upper = &image.rgba[std::size_t(down[y].low) * image.width * 4];
    const std::uint8_t* lower = &image.rgba[std::size_t(down[y].high) * image.width * 4];
    std::uint8_t* out = &large.rgba[std::size_t(y) * width * 4];
    const int v = down[y].part;
    for (const Between& x : across) {
      const int u = x.part;
      for (int c = 0; c < 4; ++c) {
        const int top = upper[4 * x.low + c] * (256 - u) + upper[4 * x.high + c] * u;
        const int bottom = lower[4 * x.low + c] * (256 - u) + lower[4 * x.high + c] * u;
        *out++ = std::uint8_t((top * (256 - v) + bottom * v + (1 << 15)) >> 16);
      }
    }
  });
  return large;
}

}  // namespace supple::tools
