#include "tools/viewer/open_scene.h"

#include <algorithm>
#include <cmath>

#include "lib/session/step_model.h"
#include "tools/scene/live/first_anchor.h"
#include "tools/scene/live/model_price.h"
#include "tools/scene/pictures/jpeg.h"
#include "tools/scene/run/view_pictures.h"
#include "volumes/base/value.h"

namespace supple::tools {

namespace {

using namespace std::chrono_literals;

constexpr auto kTellScenesEvery = 100ms;
constexpr double kMostDrag_s = 10;  // without a question
/// Pixels of slices in haste: one of so many along each axis.
constexpr int kHasteEvery = 2;

double rounded_up(double length) {
  if (!(length > 0)) return 1;
  const double unit = std::pow(10, std::floor(std::log10(length)));
  for (const double step : {1., 2., 5.}) {
    if (step * unit >= length) return step * unit;
  }
  return 10 * unit;
}

LiveFrame frame_for(const ViewSettings& settings, double budget_ms) {
  PixelSize size = settings.sizes[0];
  if (size[0] == 0 || size[1] == 0) size = {64, 64};  // hidden
  return {size, settings.deformed(), budget_ms, settings.deformed() ? settings.amount : 1};
}

}  // namespace

OpenScene::OpenScene(const Table& root, double budget_ms, const ViewSettings& settings,
                     const SceneOutlets& outlets)
    : m_outlets(outlets),
      m_settings(settings),
      m_live(root, &outlets.progress),
      m_loop(m_live, frame_for(settings, budget_ms), *this, outlets.console, &outlets.progress),
      m_curtain(picture(), m_settings),
      m_description(m_live, picture(), m_settings),
      m_budget_ms(budget_ms) {
  m_settings.slices = default_slices(picture().opened());
  for (const LiveEvent& event : m_live.events()) {
    m_live.carry_out(event, &outlets.progress);
    while (m_live.has_more()) m_live.go_on(&outlets.progress);
  }
  if (const auto anchor = first_anchor(m_live)) {
    m_live.carry_out(*anchor, &outlets.progress);
    // A body that nothing holds would follow a handle as a whole under finite elements.
    if (const auto model = first_model(m_live)) m_live.carry_out(*model, &outlets.progress);
  }
  m_stale = {0, 1, 1, 1};
}

void OpenScene::run(EventMailbox& mailbox) {
  m_loop.set_frame(frame_for(m_settings, m_budget_ms));
  tell_scene();
  m_loop.run(mailbox);
}

void OpenScene::keep(std::unique_ptr<KeptJournal> journal) {
  m_kept = std::move(journal);
  m_live.record_with([this](const Value& keys, bool replaces_last) {
    m_kept->add(keys, replaces_last, [this] { return m_live.journal(); });
  });
}

void OpenScene::begin_outside() {
  if (are_hounsfield_units(picture().opened().density.background())) {
    m_live.begin_with_look({{"preset", "Skin"}});
  }
}

bool OpenScene::begin_with_look(const Value& look) {
  if (std::exchange(m_was_begun, true) || !m_live.begin_with_look(look)) return false;
  m_loop.set_frame(frame_for(m_settings, m_budget_ms));
  m_is_told = false;
  return true;
}

void OpenScene::note_opening(const OpenedFile& file, int number) {
  m_description.note_opening(file, number);
}

void OpenScene::page_left(int page, double at_ms) {
  if (!m_live.hand().grab || m_live.hand().grab->page != page) return;
  LiveEvent event;
  event.kind = EventKind::release;
  event.restore = true;
  event.page = page;
  event.number = std::int64_t(m_number);
  event.at_ms = at_ms;
  m_loop.show(event, std::chrono::steady_clock::now());
}

void OpenScene::see(const ViewSettings& settings, std::uint64_t number) {
  m_number = number;
  const SliceSettings before = m_settings.slices;
  const bool is_other_overlay = settings.slices.overlay != before.overlay ||
                                settings.slices.overlay_in_space != before.overlay_in_space ||
                                settings.slices.outline_in_space != before.outline_in_space;
  const bool is_same_size = settings.sizes[0] == m_settings.sizes[0];
  const bool is_other_picture =
      !is_same_size || settings.amount != m_settings.amount || is_other_overlay;
  if (settings.amount != m_settings.amount) m_moves_view = false;
  m_settings = settings;
  if (is_other_overlay) choose_painter();
  for (int view = 1; view < kViewCount; ++view) m_stale[std::size_t(view)] = 1;
  m_curtain.seen_otherwise();
  if (!m_settings.curtain) m_outlets.pages.forget_frames_at_rest();
  m_range.reset();
  m_is_told = false;
  if (!is_other_picture) return;
  const LivePicture::Counts counts = picture().counts();
  m_loop.set_frame(frame_for(m_settings, m_budget_ms));
  if (is_same_size) m_curtain.keep_space(counts);
}

void OpenScene::stop(const std::vector<LiveEvent>& given_up) {
  m_live.stop();
  for (LiveEvent event : given_up) {
    if (event.kind != EventKind::release || !m_live.hand().grab) continue;
    event.no_relax = true;
    m_live.carry_out(event);
  }
}

/// Paints over the picture in space while an overlay or the outline is asked for there.
void OpenScene::choose_painter() {
  const SliceSettings& slices = m_settings.slices;
  const bool paints = slices.overlay != FieldOverlay::none && slices.overlay_in_space;
  const bool outlines = slices.outline_in_space;
  if (!outlines) m_rest_outline.reset();
  if (!paints && !outlines) return picture().paint_with({});
  const State& opened = picture().opened();
  if (outlines && !m_rest_outline) m_rest_outline.emplace(opened.elements, opened.geometry);
  picture().paint_with([this, paints, &opened](FloatImage& seen, const Camera& camera) {
    if (const RestPlaceAt rest = paints ? picture().rest_places(false) : nullptr) {
      const OverlayField field(m_settings.slices.overlay, m_live.session(), opened, rest);
      paint_values(seen, camera, field.paint(overlay_range()), opened.geometry);
    }
    if (m_rest_outline && m_settings.deformed()) m_rest_outline->draw(seen, camera);
  });
}

void OpenScene::begins() {
  m_outlets.progress.begin();
  m_moves_view = false;
  m_is_told = false;
  m_is_moving = true;
  m_range.reset();
}

/// Springs pay for every place of a drag: long ones are refused once, with the price, then taken.
void OpenScene::check(const LiveEvent& event) {
  if (event.kind != EventKind::model || model_of(event.step).waits_for_hands) return;
  const auto price = price_of(event, m_live.session());
  if (!price || price->seconds <= kMostDrag_s || m_warned_model == event.step.keys) return;
  m_warned_model = event.step.keys;
  throw InputError({event.place, "model", price->text,
                    "springs chosen once more, to use them all the same; finite elements; a crop"});
}

void OpenScene::carried_out(const LiveEvent& event) {
  m_moves_view = event.is_of_view();
  m_is_told = false;
  m_number = std::uint64_t(event.number);
  if (!m_moves_view) ends();
}

void OpenScene::went_on() {
  m_moves_view = false;
  m_is_told = false;
  ends();
}

void OpenScene::ends() {
  m_is_moving = false;
  m_outlets.progress.end();
}

bool OpenScene::refused(const LiveEvent& event, const std::string& why) {
  m_number = std::max(m_number, std::uint64_t(event.number));
  m_outlets.pages.tell_refused(m_number, why);
  m_is_told = false;
  if (!event.is_of_view()) ends();
  return true;
}

FrameMessage OpenScene::frame_of(int view, double ms) const {
  FrameMessage frame;
  frame.stamp = m_outlets.pages.next_stamp();
  frame.number = m_number;
  frame.view = view;
  frame.width = m_settings.sizes[std::size_t(view)][0];
  frame.height = m_settings.sizes[std::size_t(view)][1];
  frame.ms = ms;
  return frame;
}

void OpenScene::drew(const Image& first, const LiveCost&, const Stopwatch& since_event) {
  if (!m_moves_view) {
    for (std::size_t view = 1; view < kViewCount; ++view) m_stale[view] = 2;
  }
  if (m_live.lead() != nullptr) m_is_told = false;  // of another level, or of its force
  if (m_settings.sizes[0][0] == 0) return;
  FrameMessage frame = frame_of(0, 0);
  frame.picture = jpeg_of(first);
  frame.ms = since_event.ms();
  m_outlets.pages.publish(std::move(frame));
}

void OpenScene::settled(const Image& image, const Stopwatch& since_event) {
  if (m_settings.sizes[0][0] == 0) return;
  FrameMessage frame = frame_of(0, since_event.ms());
  frame.is_settled = true;
  m_outlets.encoder.encode(std::move(frame), image);
}

/// Draws slices in haste while the picture moves, and exactly once it has settled.
bool OpenScene::work() {
  if (!m_is_told && may_tell()) tell_scene();
  if (draw_next_pane()) return true;
  std::optional<RestPane> pane = m_curtain.next(m_budget_ms / 2);
  if (!pane) return false;
  FrameMessage frame = frame_of(pane->view, 0);
  frame.is_at_rest = true;
  frame.pixels = pane->pixels;
  frame.is_settled = pane->is_settled;
  if (pane->is_settled) {
    m_outlets.encoder.encode(std::move(frame), std::move(pane->image));
  } else {
    frame.picture = jpeg_of(pane->image);
    m_outlets.pages.publish(std::move(frame));
  }
  return true;
}

bool OpenScene::draw_next_pane() {
  const bool is_at_rest = picture().settled().has_value();
  for (int view = 1; view < kViewCount; ++view) {
    int& stale = m_stale[std::size_t(view)];
    const PixelSize& size = m_settings.sizes[std::size_t(view)];
    if (size[0] == 0 || size[1] == 0) stale = 0;
    if (stale == 0 || (stale == 1 && !is_at_rest)) continue;
    const bool exact = is_at_rest;
    const RestPlaceAt rest = picture().rest_places(exact);
    SlicePane pane = pane_of(view, size, rest, exact ? 1 : kHasteEvery);
    FrameMessage frame = frame_of(view, 0);
    frame.pixels = pane.pixels;
    frame.is_settled = exact;
    stale = exact ? 0 : 1;
    if (exact) {
      m_outlets.encoder.encode(std::move(frame), std::move(pane.image));
    } else {
      frame.picture = jpeg_of(pane.image);
      m_outlets.pages.publish(std::move(frame));
    }
    return true;
  }
  return false;
}

SlicePane OpenScene::pane_of(int view, const PixelSize& size, const RestPlaceAt& rest, int every) {
  const SliceSettings& slices = m_settings.slices;
  std::optional<OverlayField> field;
  if (slices.overlay != FieldOverlay::none && rest) {
    field.emplace(slices.overlay, m_live.session(), picture().opened(), rest);
  }
  return draw_pane(picture().opened(), slices, view - 1, size, rest, field ? &*field : nullptr,
                   field ? overlay_range() : ScalarRange(), every);
}

/// Its end is the largest displacement, or nearly the largest energy, rounded up to hold still.
ScalarRange OpenScene::overlay_range() {
  if (m_range) return *m_range;
  m_range = kVolumeRatios;
  if (m_settings.slices.overlay == FieldOverlay::displacement) {
    m_range = ScalarRange{0, rounded_up(picture().longest_mm())};
  } else if (m_settings.slices.overlay == FieldOverlay::energy) {
    const double most = most_energy_kpa(m_live.session(), picture().displacement());
    m_range = ScalarRange{0, rounded_up(most)};
  }
  return *m_range;
}

/// True if the pages may hear of the scene: ten times a second are enough while a hand drags.
bool OpenScene::may_tell() const {
  return !m_live.hand().grab || std::chrono::steady_clock::now() - m_told > kTellScenesEvery;
}

void OpenScene::tell_scene() {
  m_is_told = true;
  m_told = std::chrono::steady_clock::now();
  const bool has_overlay = m_settings.slices.overlay != FieldOverlay::none;
  const ScalarRange range = has_overlay ? overlay_range() : ScalarRange();
  m_outlets.pages.tell_scene(m_description.told(m_is_moving, range), m_number);
}

}  // namespace supple::tools
