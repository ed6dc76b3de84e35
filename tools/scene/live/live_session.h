// A session that follows events: each that changes the body becomes a step of it, so that a batch
// scene of these steps gives the same state, bit for bit, whatever time or threads they took.
// Free rigid pieces shift while they are dragged along and turn after the release, and finite
// elements take over then, or are under the hand (hand_lead.h). That, and relaxation in slices,
// waits while new events come. The view follows, too.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "lib/session/session.h"
#include "tools/scene/file/live_event.h"
#include "volumes/base/value.h"

namespace supple {
struct StepModel;  // lib/session/step_model.h
}

namespace supple::tools {

class HandLead;
class LedStroke;
class LiveJournal;
class LiveView;
class PieceInHand;
struct Measure;  // tools/scene/file/measure.h
struct Scene;
struct SceneView;

/// Passes of relaxation after which a new event may come; a relaxation of more is as many events.
constexpr int kSlicePasses = 5;

/// A step of the session, and where its handle had been before. Steps of one stroke, drags
/// since a grab or slices of relaxation in a row, are undone together where that is asked for.
struct DoneStep {
  EventKind kind;
  int stroke;
  int order;  // among steps, looks and clips
  Step step;
  Vec3d reached_before;
  Vec3d reached;
  double turned_deg = 0;  // of a rigid piece in hand
};

/// A look, clips or measures, and what they replaced: keys of that part of the view, or all
/// measures.
struct DoneLook {
  EventKind kind;
  int order;
  double at_ms;
  Value before, after;
};

/// Steps, looks, clips and measures of a session; the last of those that are undone is redone
/// first.
struct LiveHistory {
  std::vector<DoneStep> done, undone;
  std::vector<DoneLook> looks, undone_looks;
  int order = 0;                    // of the last of them
  int stroke = 0, hand_stroke = 0;  // the last number of all; of the drags since the grab

  /// Numbers the next step's stroke. It follows from the events as a journal has them, in which a
  /// relaxation is as many as it had slices, and what settles drags is a step of its own.
  int stroke_of(EventKind kind, const Step& step);
  /// Reads those that there are now.
  std::vector<Measure> measures() const;
};

/// The part of the body that is grabbed or was grabbed last, and where it is; places as `to`
/// counts.
struct LiveHand {
  /// Aim of the last drag, and where it led.
  struct Led {
    Vec3d asked{0, 0, 0}, reached{0, 0, 0};
    double asked_deg = 0, reached_deg = 0;  // of a rigid piece's turn
    bool by_cut = false;                    // the sides of a cut stopped it
    std::int64_t moved = 0;                 // elements, at most by one drag since the grab
  };
  std::optional<LiveEvent> grab;
  Vec3d reached{0, 0, 0};
  std::optional<Led> led;
  std::shared_ptr<const PieceInHand> piece;  // that it takes whole; null: none
};

/// Parts that are held and fixed since everything was let go of last.
struct HeldParts {
  std::vector<Drag> handles;  // which stay where they are
  std::vector<PlacedSelection> anchors;
  bool has_others = false;  // fixed labels or points: nothing is let go of one by one
};

class LiveSession {
 public:
  /// Opens what the root of a journal or a scene describes; its events or steps are left to
  /// events(). Throws InputError as read_scene and Session, and where it has both.
  LiveSession(const Table& root, Progress* progress);
  ~LiveSession();

  /// Events of a journal; of a scene its steps, each as one event.
  const std::vector<LiveEvent>& events() const { return m_events; }

  /// Does what the event says; of a relaxation its first passes, see has_more(). Throws InputError
  /// with the event's place, and Cancelled: nothing has changed then.
  void carry_out(const LiveEvent& event, Progress* progress = nullptr);
  /// True if drags are still to be settled, by turns of pieces or finite elements, or tissue to
  /// relax; any event but those of the view ends it.
  bool has_more() const;
  /// True if the first of it settles drags, which may take long.
  bool is_unsettled() const { return m_is_unsettled; }
  /// Does a slice of it. Throws Cancelled: it is still to be done.
  void go_on(Progress* progress = nullptr);
  void stop();
  /// Passes of relaxation that are still to be done.
  int passes_left() const { return m_pending; }

  Session& session() { return *m_session; }
  const Scene& scene() const { return *m_scene; }
  /// The view that the events so far ask for.
  const SceneView& view() const;
  /// Sets the look that a session begins with, `preset` or `transfer`, as if its file had it; false
  /// where the file or an event has chosen one. Throws InputError.
  bool begin_with_look(const Value& look);

  /// Gets every event that is carried out from now on, with the keys that a journal has; one that
  /// replaces the last says all that that one did.
  using Recorder = std::function<void(const Value& keys, bool replaces_last)>;
  void record_with(Recorder recorder);

  const LiveHistory& history() const { return m_history; }
  const LiveHand& hand() const { return m_hand; }
  /// True if finite elements are under the hand.
  bool is_under_hand() const { return m_model && m_model->under_hand; }
  /// These, while something is grabbed and until the stroke is done: what pictures show instead of
  /// the body; null: they show that.
  HandLead* lead() const;
  /// Handles and anchors that can be let go of one by one.
  HeldParts held() const;
  Limits limits() const { return m_limits; }
  const StepModel& model() const;

  /// The events that were carried out, as a file that replays to the same state.
  Value journal() const;
  /// The steps that are not taken back, as a scene that `supple run` brings to the same state.
  Value batch_scene() const;

 private:
  void act_on(const LiveEvent& event, Progress* progress);
  void drag(const LiveEvent& event, Progress* progress);
  void release(const LiveEvent& event, Progress* progress);
  void take_out_cut(const LiveEvent& event, Progress* progress);
  void run(EventKind kind, const Step& step, Progress* progress);
  void settle_drags(Progress* progress);
  void relax(const LiveEvent& event, int passes, Progress* progress);
  void change_view(const LiveEvent& event);
  bool take_back();
  void undo(const LiveEvent& event);
  void make_again(const DoneStep& done, Progress* progress);
  void redo(const LiveEvent& event, Progress* progress);

  std::unique_ptr<const Scene> m_scene;
  std::unique_ptr<LiveView> m_view;
  std::unique_ptr<LiveJournal> m_journal;
  std::vector<LiveEvent> m_events;
  std::unique_ptr<Session> m_session;
  bool m_is_state_anchored = false;  // the opened state fixes elements
  LiveHistory m_history;
  LiveHand m_hand;
  std::optional<LiveEvent> m_model;  // of another model than ECM
  Limits m_limits = Limits::box;
  std::optional<LiveEvent> m_relaxation;
  int m_pending = 0;
  bool m_is_unsettled = false;
  std::unique_ptr<LedStroke> m_led;
};

}  // namespace supple::tools
