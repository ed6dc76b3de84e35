#include "tools/live/live_loop.h"

#include <algorithm>

#include "tools/console/own_process.h"

namespace supple::tools {

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
  m_picture.prepare();
  m_picture.first_pixels(0);
  while (m_picture.refine()) poll(&m_console);
}

void LiveLoop::run(EventMailbox& mailbox) {
  m_leaves = false;
  while (!m_leaves) {
    poll(&m_console);
    const bool is_idle = !m_has_work && !m_live.has_more() && m_picture.settled();
    if (auto posted = mailbox.take(is_idle)) {
      m_has_work = true;
      if (posted->task) {
        posted->task();
      } else {
        show(posted->event, posted->posted);
      }
      // Other work goes before what settles drags, which may take long.
    } else if (m_live.has_more() && !(m_has_work && m_live.is_unsettled())) {
      go_on();
    } else if (m_has_work) {
      m_has_work = m_watcher.work();
    } else if (!m_picture.settled()) {
      refine();
    } else if (mailbox.is_closed()) {
      return;
    }
  }
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

void LiveLoop::go_on() {
  const Stopwatch since_event;
  m_watcher.begins();
  try {
    m_live.go_on(m_progress);
  } catch (const Error& error) {
    m_live.stop();
    if (m_console.cancelled() || !m_watcher.refused(LiveEvent(), error.what())) throw;
    return;
  }
  m_watcher.spent(LivePhase::solve, since_event);
  draw(since_event);
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
  m_picture.prepare();
  m_watcher.spent(LivePhase::prepare, preparing);
  const Stopwatch drawing;
  const double budget = m_frame.budget_ms;
  const Image first =
      m_picture.first_pixels(budget > 0 ? std::max(budget - since_event.ms(), 1e-3) : 0);
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
