// The thread of a live session: it carries out the events of a mailbox one after the other, draws
// what each leads to within a promised time, settles drags and relaxes in slices, and refines the
// picture while nothing else is to be done. Slices give way to what may move the body; cameras,
// sizes and questions about the picture are answered within them. A replay runs one, and a viewer.
#pragma once

#include <exception>

#include "raycast/pictures/image.h"
#include "tools/scene/live/event_mailbox.h"
#include "tools/scene/live/live_picture.h"
#include "tools/scene/live/live_session.h"
#include "volumes/base/stopwatch.h"

namespace supple::tools {

/// solve: events that change the body; prepare: what rays read; frame: bounds and rays;
/// first_pixels: from the event to the picture of it; refined: from there to the settled one.
enum class LivePhase { solve, prepare, frame, first_pixels, refined };

/// Listener of a loop; called from the thread that runs it.
class LoopWatcher {
 public:
  virtual ~LoopWatcher() = default;
  virtual void spent(LivePhase, const Stopwatch&) {}
  /// Called before an event that may move the body or a slice of relaxation is carried out.
  virtual void begins() {}
  /// Called before begins(); throws InputError where the event is not to be done.
  virtual void check(const LiveEvent&) {}
  virtual void carried_out(const LiveEvent&) {}
  /// A slice is done, or has given way.
  virtual void went_on() {}
  /// The event cannot be done, and nothing has changed. False: it ends the loop.
  virtual bool refused(const LiveEvent&, const std::string& /*why*/) { return false; }
  /// A first picture, often smaller than it is to be shown, which better ones follow.
  virtual void drew(const Image&, const LiveCost&, const Stopwatch& /*since_event*/) {}
  virtual void settled(const Image&, const Stopwatch& /*since_event*/) {}
  /// Does a short piece of other work, within slices too; false when there is none. Called before
  /// pictures are refined.
  virtual bool work() { return false; }
  /// True if there will be work a tenth of a second after the last event.
  virtual bool has_later_work() const { return false; }
};

/// Size, pose and budget of the frames that a page wants, whatever the events say.
struct LiveFrame {
  PixelSize size{512, 512};
  bool deformed = true;
  double budget_ms = 50;  // from event to first pixels; 0: as long as it takes
  double amount = 1;      // of the displacement that a deformed body is shown with
};

class LiveLoop {
 public:
  /// All outlive the loop. `progress`: of what events do; null: none.
  LiveLoop(LiveSession& live, const LiveFrame& frame, LoopWatcher& watcher, Progress& listener,
           Progress* progress = nullptr);

  /// Called from another thread: something has been posted.
  void interrupt() { m_picture.interrupt(); }

  /// Draws the body as it was opened, settled.
  void settle();
  /// Runs until the mailbox is closed and all is done, or leave(). Throws Cancelled when the
  /// console says so, and what an event throws that the watcher does not put up with.
  void run(EventMailbox& mailbox);
  /// run() returns after the task that calls this.
  void leave() { m_leaves = true; }

  /// Carries one event out and draws its first pixels.
  void show(const LiveEvent& event, std::chrono::steady_clock::time_point posted);
  /// Does a slice of what is still to be done and draws its first pixels.
  void go_on() { go_on(nullptr); }
  /// Waits until all finite elements under the hand are there, and shows them.
  void wait_for_lead();
  /// A step towards the settled picture; false when there is nothing left to do.
  bool refine();
  /// Sets another size or pose; the next run() draws it.
  void set_frame(const LiveFrame& frame);

  LiveSession& live() { return m_live; }
  LivePicture& picture() { return m_picture; }

 private:
  class GivingWay;
  SceneView framed(SceneView view) const;
  using Clock = std::chrono::steady_clock;
  bool carry_out(const LiveEvent& event);
  /// Returns false where it gave way to what waits in the mailbox.
  bool go_on(EventMailbox* mailbox);
  void go_on_in_slice(EventMailbox* mailbox);
  void do_posted(const PostedEvent& posted);
  void look_meanwhile(EventMailbox& mailbox, bool all);
  bool is_soon_after(Clock::duration pause, const EventMailbox& mailbox) const;
  bool follow();
  void draw(const Stopwatch& since_event);

  LiveSession& m_live;
  LiveFrame m_frame;
  LoopWatcher& m_watcher;
  Progress& m_listener;
  Progress* m_progress;
  LivePicture m_picture;
  Stopwatch m_asked;  // since the event that the picture follows
  bool m_has_work = true, m_leaves = false;
  bool m_gave_way = false;       // the slice that is next
  bool m_is_moving = false;      // within a slice
  bool m_shows_lead = false;     // what is under the hand, not the body
  bool m_looked = false;         // last, and not moved anything
  std::exception_ptr m_failure;  // of what was answered within a slice
  Clock::time_point m_last_event;
};

}  // namespace supple::tools
