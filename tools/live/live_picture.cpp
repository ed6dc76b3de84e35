#include "tools/live/live_picture.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <mutex>
#include <set>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include "raycast/progressive.h"
#include "tools/live/stopwatch.h"
#include "tools/outputs/staging.h"
#include "tools/outputs/view_pictures.h"
#include "volumes/field/cuts/cut_offsets.h"
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

/// Of one topology, those whose vectors differ.
std::vector<std::int32_t> differing_bricks(const Displacement& before, const Displacement& after) {
  std::vector<std::int32_t> differing;
  for (std::size_t b = 0; b < after.u.topology.brick_count(); ++b) {
    const Vec3f* was = &before.u.vectors[b * kBrickVoxels];
    const Vec3f* is = &after.u.vectors[b * kBrickVoxels];
    if (!std::equal(is, is + kBrickVoxels, was)) differing.push_back(std::int32_t(b));
  }
  return differing;
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
  void follow_cut_inverse();
  void follow_rest();
  /// The inverse, up to date.
  const OffsetField& all_offsets();
  OffsetResolution resolution() const {
    return view.half_offsets ? OffsetResolution::half : OffsetResolution::full;
  }
  void follow_for_sooner(double pixels, LiveCost& cost);
  PosedVolume subject() const;
  RenderSettings settings() const;
  void replace(std::unique_ptr<ProgressiveRender> next);

  Session& session;
  Console& console;
  State state;  // as opened; its q and cuts are not kept up to date
  std::unique_ptr<LiveDisplacement> moved;
  std::shared_ptr<ForwardOffsets> forward;
  std::unique_ptr<IncrementalInversion> inversion;
  std::unique_ptr<Renderer> renderer;
  Changed for_forward, for_inverse;  // bricks in which the displacement has changed since
  enum class Shown { nothing, forward, inverse, rest };
  Shown shown = Shown::nothing;
  bool renderer_follows = false;     // the renderer has kept all offsets of `inversion` so far
  std::optional<OffsetField> field;  // those of `inversion`, copied
  LinkCuts cuts;
  std::unique_ptr<IncrementalCutInversion> cut_inversion;  // of elements and `cuts`
  Displacement cut_displacement;                           // that it follows
  bool is_cut_stale = true;

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
  shown = Shown::nothing;
  renderer_follows = false;
  field.reset();
  cut_inversion.reset();
  cuts = session.body().cuts;
  is_cut_stale = true;
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
  if (is_cut) {
    if (body.cuts.count() < cuts.count()) cut_inversion.reset();
    if (body.cuts.empty()) shown = Shown::nothing;
    cuts = body.cuts;
  }
  is_cut_stale = is_cut_stale || is_cut || !changed.empty();
  return is_cut || !changed.empty();
}

void LivePicture::Impl::follow_forward() {
  const bool is_changed = !for_forward.empty();
  if (is_changed) forward->update(take(for_forward));
  if (is_changed || shown != Shown::forward) renderer->set_pointwise_offsets(forward);
  shown = Shown::forward;
}

void LivePicture::Impl::follow_inverse() {
  if (!cuts.empty()) return follow_cut_inverse();
  const bool is_up_to_date = shown == Shown::inverse && for_inverse.empty();
  if (is_up_to_date) return;
  const std::vector<Vec3i> touched = inversion->update(moved->displacement(), take(for_inverse));
  if (!touched.empty()) field.reset();
  if (!renderer_follows || view.half_offsets) {
    renderer->set_offsets(&all_offsets(), resolution());
  } else {
    renderer->update_offsets(touched, inversion->finder());
  }
  renderer_follows = true;
  shown = Shown::inverse;
}

/// Where links are cut the displacement may jump.
void LivePicture::Impl::follow_cut_inverse() {
  if (shown == Shown::inverse && !is_cut_stale) return;
  renderer->set_offsets(&all_offsets(), resolution());
  renderer_follows = false;
  shown = Shown::inverse;
}

const OffsetField& LivePicture::Impl::all_offsets() {
  if (cuts.empty()) {
    if (!field) field = inversion->field();
    return *field;
  }
  // A session alone knows what pieces hide of the cuts.
  if (!session.body().rigid.empty()) return session.pose(&console).offsets;
  if (!is_cut_stale) return cut_inversion->field();
  state.q = session.body().q;
  state.cuts = cuts;
  Displacement next = extended_displacement_of(state);
  if (cut_inversion) {
    cut_inversion->update(next, differing_bricks(cut_displacement, next), &console);
  } else {
    InvertParams params;
    params.material = &state.elements;
    cut_inversion = std::make_unique<IncrementalCutInversion>(
        next, CutElements{state.elements, cuts}, params, &console);
  }
  cut_displacement = std::move(next);
  is_cut_stale = false;
  return cut_inversion->field();
}

void LivePicture::Impl::follow_rest() {
  if (shown != Shown::rest) renderer->set_offsets(nullptr);
  renderer_follows = false;
  shown = Shown::rest;
}

void LivePicture::Impl::follow_for_sooner(double pixels, LiveCost& cost) {
  const auto start = std::chrono::steady_clock::now();
  if (!view.deformed) {
    follow_rest();
    cost.by_inverse = true;
    return;
  }
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
    if (impl.view.deformed) {
      impl.follow_inverse();
    } else {
      impl.follow_rest();
    }
    if (impl.cuts.empty() && impl.view.deformed) impl.inverse_brick.add(ms_since(start), bricks);
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

Image LivePicture::shot(const Camera& camera, const PixelSize& size, Progress* progress) {
  Impl& impl = *m_impl;
  if (impl.view.deformed) {
    impl.follow_inverse();
  } else {
    impl.follow_rest();
  }
  SceneView view = impl.view;
  view.size = size;
  view.camera.camera = camera;
  RenderSettings settings = view_settings(view);
  settings.clips = resolve_clips(view.clips, impl.state.geometry);
  FloatImage picture =
      impl.renderer->render_float(camera, look_of(view), settings, nullptr, progress);
  decorate(picture, impl.subject(), view);
  return to_image(picture);
}

const SceneView& LivePicture::view() const {
  return m_impl->view;
}

const Renderer& LivePicture::renderer() const {
  return *m_impl->renderer;
}

const State& LivePicture::opened() const {
  return m_impl->state;
}

RestPlaceAt LivePicture::rest_places(bool exact) {
  Impl& impl = *m_impl;
  if (!impl.view.deformed) return nullptr;
  if (exact || impl.shown != Impl::Shown::forward) {
    impl.follow_inverse();
    return [&offsets = impl.all_offsets()](const Vec3d& index, Vec3d& at_rest) {
      Vec3d offset;
      if (!offsets.sample(index, offset)) return false;
      at_rest = index + offset;
      return true;
    };
  }
  const BrickTopology& voxels = impl.state.density.bricks();
  return [&forward = *impl.forward, &tissue = voxels](const Vec3d& index, Vec3d& at_rest) {
    PointwiseOffsets::Sample found;
    const Vec3i voxel(int(std::lround(index.x)), int(std::lround(index.y)),
                      int(std::lround(index.z)));
    const std::int32_t brick = forward.bricks().find(voxel);
    if (brick >= 0 && !forward.sample(std::size_t(brick), index, found)) return false;
    at_rest = index + found.offset;
    return brick >= 0 || tissue.is_active(voxel);
  };
}

const Displacement& LivePicture::displacement() const {
  return m_impl->moved->displacement();
}

double LivePicture::longest_mm() const {
  const State& state = m_impl->state;
  const VectorBricks& u = m_impl->moved->displacement().u;
  return std::sqrt(tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, u.vectors.size()), 0.0,
      [&](const tbb::blocked_range<std::size_t>& range, double most) {
        for (std::size_t n = range.begin(); n < range.end(); ++n) {
          const Vec3d mm = state.geometry.world_vector_from_index(Vec3d(u.vectors[n]));
          most = std::max(most, mm.dot(mm));
        }
        return most;
      },
      [](double a, double b) { return std::max(a, b); }));
}

LivePicture::Memory LivePicture::memory() const {
  const Impl& impl = *m_impl;
  const std::size_t voxels = impl.state.density.bricks().brick_count() * kBrickVoxels;
  const std::size_t moved = impl.moved->displacement().u.vectors.size() * sizeof(Vec3f);
  return {voxels * sizeof(float), moved, impl.forward->bytes()};
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
