#include "tools/scene/live/live_picture.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "raycast/drawings/slice.h"
#include "raycast/progressive.h"
#include "raycast/render.h"
#include "raycast/scene/clip.h"
#include "tools/scene/file/view.h"
#include "tools/scene/live/live_body.h"
#include "tools/scene/run/staging.h"
#include "tools/scene/run/view_pictures.h"
#include "volumes/base/stopwatch.h"

namespace supple::tools {

namespace {

constexpr double kSmallest = 1.0 / 4;    // of width and height, of a picture in a hurry
constexpr double kLeastPart = 0.25;      // of the budget that rays have in any case
constexpr double kBudgetToAimAt = 0.85;  // what is left covers what varies
constexpr double kMostFollowed = 0.5;    // of all pixels
constexpr int kCoarsest = 2;             // spacing of pixels in a picture that follows another one

}  // namespace

struct LivePicture::Impl {
  Impl(Session& session_, const SceneView& view_, Progress& listener_)
      : session(session_),
        listener(listener_),
        body(session_, view_.sampling.interpolation, listener_),
        view(view_) {}

  void show_exactly();
  OffsetResolution resolution() const {
    return view.half_offsets ? OffsetResolution::half : OffsetResolution::full;
  }
  PosedVolume subject() const;
  RenderSettings settings() const;
  void replace(std::unique_ptr<ProgressiveRender> next);
  void drop_pictures();
  bool can_follow() const;
  bool is_most(double pixels) const;
  void add_followed(double march_ms, double pixels);
  bool refine();
  void keep_finished();
  std::unique_ptr<ProgressiveRender> begin();
  std::optional<FloatImage> followed(double left_ms, LiveCost& cost);
  FloatImage drafted(double left_ms, LiveCost& cost);
  void paint_and_decorate(FloatImage& picture, const Camera& seen_by, const SceneView& as) const;
  double part_within(double rays_ms, const CostPer& pixel) const;
  bool chooses_inverse(double budget_ms) const;

  Session& session;
  Progress& listener;
  LiveBody body;
  SceneView view;
  Camera camera;
  Painter painter;
  bool is_new = true;
  int looks = 0;
  std::mutex guard;  // of what interrupt() reaches from another thread
  std::unique_ptr<ProgressiveRender> progressive;
  std::unique_ptr<ProgressiveRender> finished;  // the last one of this view, to be followed
  CostPer forward_pixel{5e-4}, inverse_pixel{4e-4}, frame{8};
  CostPer follow_start{5}, followed_pixel{1e-3};
  double last_changed = 0;  // pixels, since `finished`; 0: it was not followed yet
  double begin_ms = 0;      // of a picture that follows another one, since the last event
};

void LivePicture::Impl::show_exactly() {
  if (view.deformed) {
    body.show_inverse(resolution());
  } else {
    body.show_rest();
  }
}

PosedVolume LivePicture::Impl::subject() const {
  const State& state = body.opened();
  return {state.geometry,  state.density, state.elements, nullptr, &body.displacement(), 0, 1, 0,
          &state.elements, &body.cuts(),  &state.labels};
}

RenderSettings LivePicture::Impl::settings() const {
  RenderSettings all = view_settings(view);
  all.clips = resolve_clips(view.clips, body.opened().geometry);
  all.auxiliary = all.auxiliary || painter;
  return all;
}

void LivePicture::Impl::paint_and_decorate(FloatImage& picture, const Camera& seen_by,
                                           const SceneView& as) const {
  if (painter) painter(picture, seen_by);
  decorate(picture, subject(), as);
}

void LivePicture::Impl::replace(std::unique_ptr<ProgressiveRender> next) {
  const std::lock_guard lock(guard);
  progressive = std::move(next);
}

/// Drops all pictures where another view or another renderer is shown.
void LivePicture::Impl::drop_pictures() {
  replace({});
  finished.reset();
}

/// Keeps a finished picture before another one is begun.
void LivePicture::Impl::keep_finished() {
  const std::lock_guard lock(guard);
  if (progressive && progressive->finished()) {
    finished = std::move(progressive);
    last_changed = 0;
  }
  progressive.reset();
}

/// The picture at rest, of the offsets as they are.
std::unique_ptr<ProgressiveRender> LivePicture::Impl::begin() {
  if (finished && finished->may_be_followed()) {
    const Stopwatch time;
    auto next = finished->follow();
    last_changed = double(next->changed_pixels());
    begin_ms = time.ms();
    follow_start.add(begin_ms, 1);
    return next;
  }
  return std::make_unique<ProgressiveRender>(body.renderer(), camera, look_of(view), settings());
}

/// The picture at rest, or with every kCoarsest-th pixel of those that have changed since the last
/// one, where that takes no longer than `left_ms`.
std::optional<FloatImage> LivePicture::Impl::followed(double left_ms, LiveCost& cost) {
  if (!finished || !finished->may_be_followed()) return std::nullopt;
  std::unique_ptr<ProgressiveRender> begun = begin();
  ProgressiveRender& next = *begun;
  const double pixels = double(next.changed_pixels());
  const auto takes = [&](int spacing) { return followed_pixel.of(pixels / (spacing * spacing)); };
  int spacing = 1;
  if (takes(1) > left_ms - begin_ms) spacing = std::min(kCoarsest, next.next_spacing());
  // A smaller picture is smoother where most of it has changed.
  const bool is_rough = spacing > 1 && is_most(pixels);
  const bool is_late = is_rough || takes(spacing) > left_ms - begin_ms;
  const Stopwatch marching;
  if (!is_late) next.refine_to(spacing);
  if (!is_late) {
    cost.march_ms = marching.ms();
    cost.spacing = spacing;
    add_followed(cost.march_ms, pixels / (spacing * spacing));
  }
  replace(std::move(begun));  // from here on it may be interrupted
  if (is_late) return std::nullopt;
  return next.picture();
}

/// A picture at draft quality, as large as `left_ms` allows; endless: as it will be at rest.
FloatImage LivePicture::Impl::drafted(double left_ms, LiveCost& cost) {
  RenderSettings drafts = settings();
  CostPer& pixel = cost.by_inverse ? inverse_pixel : forward_pixel;
  if (left_ms < kEndless) {
    const double part = part_within(left_ms, pixel);
    drafts.set_quality(Quality::draft);
    drafts.width = std::max(1, int(std::lround(part * drafts.width)));
    drafts.height = std::max(1, int(std::lround(part * drafts.height)));
  }
  drafts.auxiliary = bool(painter);
  RenderReport report;
  FloatImage picture = body.renderer().render_float(camera, look_of(view), drafts, &report);
  cost.march_ms = report.march_ms;
  pixel.add(cost.march_ms, double(drafts.width) * drafts.height);
  return picture;
}

LivePicture::LivePicture(Session& session, const SceneView& view, Progress& listener)
    : m_impl(std::make_unique<Impl>(session, view, listener)) {
  look(view);
}

LivePicture::~LivePicture() = default;

void LivePicture::look(const SceneView& view) {
  Impl& impl = *m_impl;
  check_view(view);
  impl.drop_pictures();
  impl.is_new = true;
  ++impl.looks;
  const State& state = impl.body.opened();
  SceneView next = effective_view(view, state.geometry, state.density.background());
  if (next.sampling.interpolation != impl.body.interpolation()) {
    impl.body.open(next.sampling.interpolation);
  }
  try {
    impl.camera = framed_camera(impl.subject(), &impl.body.renderer(), next, impl.listener);
  } catch (...) {
    const Interpolation before = impl.view.sampling.interpolation;
    if (before != impl.body.interpolation()) impl.body.open(before);
    throw;
  }
  next.camera.camera = impl.camera;
  next.fit.clear();
  next.zoom = 1;
  impl.view = next;
}

void LivePicture::paint_with(Painter painter) {
  m_impl->painter = std::move(painter);
  m_impl->drop_pictures();
  m_impl->is_new = true;
}

void LivePicture::set_amount(double amount) {
  m_impl->body.set_amount(amount);
}

bool LivePicture::follow(const std::array<BrickValues, 3>* shape) {
  const int opened_count = m_impl->body.opened_count();
  if (m_impl->body.follow(shape)) m_impl->is_new = true;
  if (m_impl->body.opened_count() != opened_count) m_impl->drop_pictures();
  return follow_view();
}

bool LivePicture::follow_view() {
  if (!m_impl->is_new) return false;
  m_impl->keep_finished();
  m_settled.reset();
  m_impl->is_new = false;
  return true;
}

/// Part of width and height that can be drawn in that time.
double LivePicture::Impl::part_within(double rays_ms, const CostPer& pixel) const {
  const double pixels = double(view.size[0]) * view.size[1];
  return std::clamp(std::sqrt(std::max(rays_ms, 0.0) / std::max(pixel.of(pixels), 1e-9)), kSmallest,
                    1.0);
}

bool LivePicture::Impl::is_most(double pixels) const {
  return pixels > kMostFollowed * view.size[0] * view.size[1];
}

/// Leaves out passes of few pixels, most of whose time any pass takes.
void LivePicture::Impl::add_followed(double march_ms, double pixels) {
  constexpr double kMany = 1000;
  if (pixels >= kMany) followed_pixel.add(march_ms, pixels);
}

/// True if the renderer is told of changes of the inverse and a pixel's light is that of its ray.
bool LivePicture::Impl::can_follow() const {
  return !view.half_offsets && !view.lighting.has_paths();
}

bool LivePicture::Impl::chooses_inverse(double budget_ms) const {
  if (!view.deformed || body.needs_inverse()) return true;
  const double forward_ms = body.forward_ms(), inverse_ms = body.inverse_ms();
  const double left = kBudgetToAimAt * budget_ms - frame.of(1);
  if (finished && can_follow()) {
    const int spacing = is_most(last_changed) ? 1 : kCoarsest;
    const double followed_ms =
        follow_start.of(1) + followed_pixel.of(last_changed / (spacing * spacing));
    if (inverse_ms + followed_ms <= left) return true;
  }
  const double forward_part = budget_ms > 0 ? part_within(left - forward_ms, forward_pixel) : 1;
  const double inverse_part = budget_ms > 0 ? part_within(left - inverse_ms, inverse_pixel) : 1;
  if (forward_part != inverse_part) return inverse_part > forward_part;
  const double pixels = forward_part * forward_part * view.size[0] * view.size[1];
  return inverse_ms + inverse_pixel.of(pixels) <= forward_ms + forward_pixel.of(pixels);
}

void LivePicture::prepare(double budget_ms) {
  Impl& impl = *m_impl;
  const Stopwatch time;
  m_cost = {};
  m_cost.by_inverse = impl.chooses_inverse(budget_ms);
  if (m_cost.by_inverse) {
    impl.show_exactly();
  } else {
    impl.body.show_forward();
  }
  m_cost.prepare_ms = time.ms();
}

Image LivePicture::first_pixels(double budget_ms) {
  Impl& impl = *m_impl;
  const Stopwatch clock;
  impl.begin_ms = 0;
  const double least = kLeastPart * budget_ms;
  double left = std::max(kBudgetToAimAt * budget_ms - impl.frame.of(1), least);
  if (budget_ms <= 0) left = kEndless;
  std::optional<FloatImage> picture;
  if (m_cost.by_inverse) picture = impl.followed(left, m_cost);
  if (!picture) picture = impl.drafted(std::max(left - impl.begin_ms, least), m_cost);
  m_cost.width = (picture->width + m_cost.spacing - 1) / m_cost.spacing;
  m_cost.height = (picture->height + m_cost.spacing - 1) / m_cost.spacing;
  if (impl.painter) impl.painter(*picture, impl.camera);
  if (impl.view.decoration.annotate.empty()) decorate(*picture, impl.subject(), impl.view);
  Image image = to_image(*picture);
  m_cost.frame_ms = clock.ms() - m_cost.march_ms;
  impl.frame.add(m_cost.frame_ms - impl.begin_ms, 1);
  return image;
}

/// The pixels that are missing; false where it was interrupted.
bool LivePicture::Impl::refine() {
  const int spacing = progressive->spacing();
  const double there = spacing > 0 ? 1.0 / (spacing * spacing) : 0;
  const Stopwatch time;
  if (!progressive->refine_to(1)) return false;
  const double pixels = double(progressive->changed_pixels());
  const bool follows = pixels < double(view.size[0]) * view.size[1];
  if (follows) add_followed(time.ms(), (1 - there) * pixels);
  return true;
}

bool LivePicture::refine() {
  Impl& impl = *m_impl;
  if (m_settled) return false;
  if (!impl.progressive) {
    impl.show_exactly();
    impl.replace(impl.begin());
    return true;
  }
  if (!impl.progressive->finished() && !impl.refine()) {
    impl.replace({});
    return true;
  }
  FloatImage picture = impl.progressive->picture();
  impl.paint_and_decorate(picture, impl.camera, impl.view);
  m_settled = to_image(picture);
  return false;
}

void LivePicture::interrupt() {
  const std::lock_guard lock(m_impl->guard);
  if (m_impl->progressive) m_impl->progressive->cancel();
}

Image LivePicture::shot(const Camera& camera, const PixelSize& size, Progress* progress) {
  Impl& impl = *m_impl;
  impl.show_exactly();
  SceneView view = impl.view;
  view.size = size;
  view.camera.camera = camera;
  RenderSettings settings = view_settings(view);
  settings.clips = resolve_clips(view.clips, impl.body.opened().geometry);
  settings.auxiliary = settings.auxiliary || impl.painter;
  FloatImage picture =
      impl.body.renderer().render_float(camera, look_of(view), settings, nullptr, progress);
  impl.paint_and_decorate(picture, camera, view);
  return to_image(picture);
}

const SceneView& LivePicture::view() const {
  return m_impl->view;
}

const Renderer& LivePicture::renderer() const {
  return m_impl->body.renderer();
}

const State& LivePicture::opened() const {
  return m_impl->body.opened();
}

RestPlaceAt LivePicture::rest_places(bool exact) {
  Impl& impl = *m_impl;
  if (!impl.view.deformed) return nullptr;
  if (exact || !impl.body.shows_forward()) impl.show_exactly();
  return supple::tools::rest_places(impl.body);
}

const Displacement& LivePicture::displacement() const {
  return m_impl->body.displacement();
}

double LivePicture::longest_mm() const {
  return m_impl->body.longest_mm();
}

LivePicture::Counts LivePicture::counts() const {
  return {m_impl->looks, m_impl->body.opened_count()};
}

LivePicture::Memory LivePicture::memory() const {
  const Impl& impl = *m_impl;
  const std::size_t voxels = impl.body.opened().density.bricks().brick_count() * kBrickVoxels;
  const std::size_t moved = impl.body.displacement().u.vectors.bytes();
  return {voxels * sizeof(float), moved, impl.body.forward().bytes()};
}

}  // namespace supple::tools
