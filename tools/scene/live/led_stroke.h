// Strokes with finite elements under the hand of a live session: each is one step, whose responses
// are found while the hand leads, and which is done once the hand has let go.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "tools/scene/live/live_session.h"

namespace supple::tools {

class AheadThread;
class HandLead;

class LedStroke {
 public:
  /// All outlive this.
  LedStroke(Session& session, LiveHistory& history, LiveHand& hand);
  ~LedStroke();

  /// Makes the solid of the body ahead, on a thread of its own, unless it is there; null: of no
  /// model, there is none ahead any more.
  void make_solid(const LiveEvent* model);
  /// Begins to find the responses of what is grabbed, by the model that this event chose. Throws as
  /// HandLead; nothing is grabbed then.
  void begin(const LiveEvent& model);
  /// The hand is `by` from where it grabbed, in the frame of the grab, and has turned a piece as
  /// `drag` says. Its target stands whatever ChainMail makes of it, which is seen until there is a
  /// level. Directions that the target lacks are found, too.
  void lead_by(const LiveEvent& drag, const Vec3d& by, const LiveEvent& model);
  /// The responses, while something is grabbed and until the stroke is done; or null.
  HandLead* lead() const { return m_lead.get(); }

  /// True if the hand is not where it grabbed, or was not as it let go, and this is still to be
  /// done.
  bool moves() const { return m_step.has_value(); }
  /// True if the hand has let go, too.
  bool is_to_do() const { return moves() && !m_hand.grab; }
  /// Place among steps and looks; as long as the hand leads it is the next.
  int order() const { return m_hand.grab ? m_history.order + 1 : m_step->order; }
  /// The stroke takes its place among the steps, which it has whenever it is done.
  void close();
  /// Does the step, if there is one, once its responses are found. Where that cannot be, the stroke
  /// is dropped; Cancelled leaves it to be done.
  void finish(Progress* progress);
  /// Takes the stroke back before it is done; a hand that still holds is where it grabbed. False
  /// where there is none.
  bool take_back();
  /// The responses that are being found are not wanted any more.
  void drop_lead();

 private:
  Step stroke(const LiveEvent& model, const Vec3d& by, const LiveEvent* drag) const;

  Session& m_session;
  LiveHistory& m_history;
  LiveHand& m_hand;
  std::shared_ptr<AheadThread> m_ahead;
  std::unique_ptr<HandLead> m_lead;
  std::vector<HandDirection> m_further;  // directions of the stroke beside those of the grab
  std::optional<DoneStep> m_step;
};

}  // namespace supple::tools
