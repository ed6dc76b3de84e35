#include "tools/live/live_loop.h"

#include <algorithm>

#include "volumes/base/heap_pages.h"

namespace supple::tools {

namespace {

using namespace std::chrono_literals;

/// Slices that take less are not ended by events.
constexpr auto kPatience = 100ms;
/// Without events, before a slice begins again that gave way to one.
constexpr auto kRest = 500ms;
/// Without events, before a picture settles while something is grabbed: it may take an inverse, and
/// the hand would wait for that.
constexpr auto kStill = 150ms;

/// Of a slice: ends it when an event waits.
class GivingWay final : public Progress {
 public:
  GivingWay(Progress* behind, const EventMailbox& mailbox) : m_behind(behind), m_mailbox(mailbox) {}

  void stage(std::string_view name) override { supple::stage(m_behind, name); }
  void update(double fraction) override {
    if (m_behind != nullptr) m_behind->update(fraction);
  }
  void warn(const std::string& line) override { supple::warn(m_behind, line); }
  void note(const std::string& line) override { supple::note(m_behind, line); }
  void debug(const std::string& line) override { supple::debug(m_behind, line); }
  bool cancelled() const override {
    if (m_behind != nullptr && m_behind->cancelled()) return true;
    return std::chrono::steady_clock::now() - m_begun > kPatience && m_mailbox.size() > 0;
  }

 private:
  Progress* m_behind;
  const EventMailbox& m_mailbox;
  std::chrono::steady_clock::time_point m_begun = std::chrono::steady_clock::now();
};

}  // namespace

LiveLoop::LiveLoop(LiveSession& live, const LiveFrame& frame, LoopWatcher& watcher,
                   Console& console, Progress* progress)
    : m_live(live),
      m_frame(frame),
      m_watcher(watcher),
      m_console(console),
      m_progress(progress),
      m_picture(live.session(), framed(live.view()), console) {}

SceneView LiveLoop::framed(SceneView view) const {
  view.size = m_frame.size;
  view.deformed = view.deformed && m_frame.deformed;
  return view;
}

void LiveLoop::settle() {
  m_picture.follow();
  m_picture.prepare(0);
  m_picture.first_pixels(0);
  while (m_picture.refine()) poll(&m_console);
}

void LiveLoop::run(EventMailbox& mailbox) {
  m_leaves = false;
  while (!m_leaves) {
    poll(&m_console);
    const bool rests = m_gave_way && is_soon_after(kRest, mailbox);
    const bool moves = m_live.grabbed() && is_soon_after(kStill, mailbox);
    const bool may_go_on = m_live.has_more() && !rests;
    const bool may_refine = !m_picture.settled() && !moves;
    const bool waits = !m_has_work && !may_go_on && !may_refine;
    const bool is_idle = !m_live.has_more() && m_picture.settled() && !m_watcher.has_later_work();
    if (auto posted = waits && !is_idle
                          ? mailbox.take_until(m_last_event + (moves ? kStill : kRest))
                          : mailbox.take(waits)) {
      m_has_work = true;
      if (posted->task) {
        posted->task();
      } else {
        show(posted->event, posted->posted);
      }
      m_last_event = Clock::now();
      // Other work goes before what settles drags, which may take long.
    } else if (may_go_on && !(m_has_work && m_live.is_unsettled())) {
      GivingWay progress(m_progress, mailbox);
      m_gave_way = !go_on(&progress);
    } else if (m_has_work) {
      m_has_work = m_watcher.work();
    } else if (may_refine) {
      refine();
    } else if (!is_idle) {
      m_has_work = m_watcher.has_later_work();
    } else if (mailbox.is_closed()) {
      return;
    }
  }
}

/// After an event or task; never once none can come any more.
bool LiveLoop::is_soon_after(Clock::duration pause, const EventMailbox& mailbox) const {
  return Clock::now() < m_last_event + pause && !mailbox.is_closed();
}

bool LiveLoop::carry_out(const LiveEvent& event) {
  m_watcher.begins();
  try {
    m_live.carry_out(event, m_progress);
    if (event.is_of_view()) m_picture.look(framed(m_live.view()));
    return true;
  } catch (const Error& error) {
    if (m_console.cancelled() || !m_watcher.refused(event, error.what())) throw;
    return false;
  }
}

void LiveLoop::show(const LiveEvent& event, std::chrono::steady_clock::time_point posted) {
  const Stopwatch since_event(posted);
  const Stopwatch solving;
  if (!carry_out(event)) return;
  if (!event.is_of_view()) m_watcher.spent(LivePhase::solve, solving);
  m_watcher.carried_out(event);
  draw(since_event);
}

bool LiveLoop::go_on(Progress* progress) {
  const Stopwatch since_event;
  m_watcher.begins();
  try {
    m_live.go_on(progress);
  } catch (const Error& error) {
    const bool is_cancelled =
        m_console.cancelled() || (m_progress != nullptr && m_progress->cancelled());
    if (!is_cancelled && dynamic_cast<const Cancelled*>(&error) != nullptr) {
      m_watcher.went_on();
      return false;
    }
    m_live.stop();
    if (m_console.cancelled() || !m_watcher.refused(LiveEvent(), error.what())) throw;
    return true;
  }
  m_watcher.went_on();
  m_watcher.spent(LivePhase::solve, since_event);
  draw(since_event);
  return true;
}

void LiveLoop::set_frame(const LiveFrame& frame) {
  m_frame = frame;
  m_picture.look(framed(m_live.view()));
  draw(Stopwatch());
}

/// Nothing where nothing has changed.
void LiveLoop::draw(const Stopwatch& since_event) {
  const Stopwatch preparing;
  if (!m_picture.follow()) return;
  const double budget = m_frame.budget_ms;
  const auto left = [&] { return budget > 0 ? std::max(budget - since_event.ms(), 1e-3) : 0; };
  m_picture.prepare(left());
  m_watcher.spent(LivePhase::prepare, preparing);
  const Stopwatch drawing;
  const Image first = m_picture.first_pixels(left());
  m_watcher.spent(LivePhase::frame, drawing);
  m_watcher.spent(LivePhase::first_pixels, since_event);
  m_watcher.drew(first, m_picture.cost(), since_event);
  m_asked = since_event;
  m_has_work = true;
}

bool LiveLoop::refine() {
  if (m_picture.settled()) return false;
  if (m_picture.refine()) return true;
  m_watcher.spent(LivePhase::refined, m_asked);
  m_watcher.settled(*m_picture.settled(), m_asked);
  return_free_memory();
  m_has_work = true;
  return false;
}

}  // namespace supple::tools
