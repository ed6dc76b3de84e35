#include "tools/scene/live/live_loop.h"

#include <algorithm>
#include <thread>

#include "tools/scene/file/view.h"
#include "tools/scene/live/hand_lead.h"
#include "volumes/base/memory.h"
#include "volumes/base/parallel.h"
#include "volumes/base/relayed_progress.h"

namespace supple::tools {

namespace {

using namespace std::chrono_literals;

/// Slices that take less are not ended by events.
constexpr auto kPatience = 100ms;
/// Slices that take less leave slices of volumes and better pictures for later.
constexpr auto kShort = 400ms;
/// Pause without events before a slice begins again that gave way to one.
constexpr auto kRest = 500ms;
/// Pause without events before a picture settles while something is grabbed: it may take an
/// inverse, and the hand would wait for that.
constexpr auto kStill = 150ms;
/// Pause between looks for a better level of what is under the hand.
constexpr auto kLook = 10ms;
/// Part of the budget that a picture has in any case: it is late rather than blurred where solving
/// took long.
constexpr double kLeastOfPicture = 0.5;

}  // namespace

/// Progress of a slice. It ends where something waits that may move the body; what only looks is
/// answered from within, on the thread of the loop, for at most half of the time.
class LiveLoop::GivingWay final : public RelayedProgress {
 public:
  GivingWay(LiveLoop& loop, EventMailbox& mailbox)
      : RelayedProgress(loop.m_progress), m_loop(loop), m_mailbox(mailbox) {
    loop.m_is_moving = true;
  }
  ~GivingWay() override { m_loop.m_is_moving = false; }
  GivingWay(const GivingWay&) = delete;
  GivingWay& operator=(const GivingWay&) = delete;

  bool cancelled() const override {
    if (RelayedProgress::cancelled()) return true;
    if (std::this_thread::get_id() == m_thread) look();
    return m_failed || (Clock::now() - m_begun > kPatience && m_mailbox.moves_wait());
  }

 private:
  void look() const;

  LiveLoop& m_loop;
  EventMailbox& m_mailbox;
  std::thread::id m_thread = std::this_thread::get_id();
  Clock::time_point m_begun = Clock::now();
  mutable Clock::time_point m_next = m_begun;  // not before, and never while it looks
  mutable std::atomic<bool> m_failed{false};
};

/// The solver may be within a parallel loop, of which nothing else must be begun here.
void LiveLoop::GivingWay::look() const {
  const auto begun = Clock::now();
  if (begun < m_next || m_failed) return;
  m_next = Clock::time_point::max();
  try {
    in_isolation([&] { m_loop.look_meanwhile(m_mailbox, begun - m_begun > kShort); });
  } catch (...) {
    m_loop.m_failure = std::current_exception();
    m_failed = true;
  }
  const auto now = Clock::now();
  m_next = now + (now - begun);
}

LiveLoop::LiveLoop(LiveSession& live, const LiveFrame& frame, LoopWatcher& watcher,
                   Progress& listener, Progress* progress)
    : m_live(live),
      m_frame(frame),
      m_watcher(watcher),
      m_listener(listener),
      m_progress(progress),
      m_picture(live.session(), framed(live.view()), listener) {}

SceneView LiveLoop::framed(SceneView view) const {
  view.size = m_frame.size;
  view.deformed = view.deformed && m_frame.deformed;
  return view;
}

void LiveLoop::settle() {
  m_picture.follow();
  m_picture.prepare(0);
  m_picture.first_pixels(0);
  while (m_picture.refine()) poll(&m_listener);
}

void LiveLoop::run(EventMailbox& mailbox) {
  m_leaves = false;
  while (!m_leaves) {
    poll(&m_listener);
    const bool rests = m_gave_way && is_soon_after(kRest, mailbox);
    const bool moves = m_live.hand().grab && is_soon_after(kStill, mailbox);
    const HandLead* const lead = m_live.lead();
    const bool is_led = lead != nullptr ? lead->is_changing() : m_shows_lead;
    const bool finds = lead != nullptr && lead->is_finding() && !mailbox.is_closed();
    const bool may_go_on = m_live.has_more() && !rests && !finds;
    const bool may_refine = !m_picture.settled() && !moves;
    const bool has_turn = may_go_on && m_looked && !mailbox.moves_wait();
    const bool waits = !m_has_work && !may_go_on && !may_refine && !is_led;
    const bool is_idle =
        !m_live.has_more() && !finds && m_picture.settled() && !m_watcher.has_later_work();
    std::optional<PostedEvent> posted;
    if (!has_turn) {
      auto until = m_last_event + (moves ? kStill : kRest);
      if (finds) until = Clock::now() + kLook;
      posted = waits && !is_idle ? mailbox.take_until(until) : mailbox.take(waits);
    }
    if (posted) {
      m_looked = posted->kind == TaskKind::looks;
      do_posted(*posted);
      // Other work goes before slices, which may take long.
    } else if (may_go_on && (has_turn || !m_has_work)) {
      m_looked = false;
      m_gave_way = !go_on(&mailbox);
    } else if (is_led) {
      draw(Stopwatch());
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

void LiveLoop::do_posted(const PostedEvent& posted) {
  m_has_work = true;
  if (posted.task) {
    posted.task();
  } else {
    show(posted.event, posted.posted);
  }
  if (!posted.task || posted.kind == TaskKind::moves) m_last_event = Clock::now();
}

/// A piece of what leaves the body alone, while that is being moved; `all`: other work and better
/// pictures, too.
void LiveLoop::look_meanwhile(EventMailbox& mailbox, bool all) {
  if (const auto posted = mailbox.take_look()) {
    do_posted(*posted);
  } else if (all && m_has_work) {
    m_has_work = m_watcher.work();
  } else if (all && !mailbox.moves_wait()) {
    refine();
  }
}

/// True soon after an event or task; false once none can come any more.
bool LiveLoop::is_soon_after(Clock::duration pause, const EventMailbox& mailbox) const {
  return Clock::now() < m_last_event + pause && !mailbox.is_closed();
}

bool LiveLoop::carry_out(const LiveEvent& event) {
  if (!event.is_of_view()) m_watcher.begins();
  try {
    m_watcher.check(event);
    m_live.carry_out(event, m_progress);
    const bool is_seen = event.is_of_view() && event.kind != EventKind::measure;
    if (is_seen || event.looks) m_picture.look(framed(m_live.view()));
    return true;
  } catch (const Error& error) {
    if (m_listener.cancelled() || !m_watcher.refused(event, error.what())) throw;
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

bool LiveLoop::go_on(EventMailbox* mailbox) {
  const Stopwatch since_event;
  m_watcher.begins();
  try {
    go_on_in_slice(mailbox);
  } catch (const Error& error) {
    if (m_failure) std::rethrow_exception(std::exchange(m_failure, nullptr));
    const bool is_cancelled =
        m_listener.cancelled() || (m_progress != nullptr && m_progress->cancelled());
    if (!is_cancelled && dynamic_cast<const Cancelled*>(&error) != nullptr) {
      m_watcher.went_on();
      return false;
    }
    m_live.stop();
    if (m_listener.cancelled() || !m_watcher.refused(LiveEvent(), error.what())) throw;
    return true;
  }
  m_watcher.went_on();
  m_watcher.spent(LivePhase::solve, since_event);
  draw(since_event);
  return true;
}

void LiveLoop::set_frame(const LiveFrame& frame) {
  m_frame = frame;
  m_picture.set_amount(frame.amount);
  m_picture.look(framed(m_live.view()));
  draw(Stopwatch());
}

void LiveLoop::go_on_in_slice(EventMailbox* mailbox) {
  if (mailbox == nullptr) return m_live.go_on(m_progress);
  GivingWay progress(*this, *mailbox);
  m_live.go_on(&progress);
}

bool LiveLoop::follow() {
  HandLead* const lead = m_live.lead();
  m_shows_lead = lead != nullptr;
  return m_picture.follow(m_shows_lead ? lead->shape() : nullptr);
}

void LiveLoop::wait_for_lead() {
  const HandLead* const lead = m_live.lead();
  if (lead == nullptr) return;
  for (; lead->is_finding(); std::this_thread::sleep_for(kLook)) poll(&m_listener);
  for (; lead->is_changing(); std::this_thread::sleep_for(kLook)) draw(Stopwatch());
}

/// Draws nothing where nothing has changed. Time in a slice is not at the picture's expense.
void LiveLoop::draw(const Stopwatch& since_event) {
  const Stopwatch preparing;
  if (!(m_is_moving ? m_picture.follow_view() : follow())) return;
  const double budget = m_frame.budget_ms;
  const Stopwatch& since = m_is_moving ? preparing : since_event;
  const auto left = [&] {
    return budget > 0 ? std::max(budget - since.ms(), kLeastOfPicture * budget) : 0;
  };
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
