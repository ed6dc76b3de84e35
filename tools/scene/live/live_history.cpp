// The part of a live session that takes steps back, makes them again, and takes out one of them.

#include "lib/session/step_model.h"
#include "tools/scene/live/live_session.h"

namespace supple::tools {

/// Number of the next step's stroke. It follows from the events as a journal has them, in which a
/// relaxation is as many as it had slices, and what settles drags is a step of its own.
int LiveSession::stroke_of(EventKind kind, const Step& step) {
  const bool follows_its_kind = !m_done.empty() && m_done.back().kind == kind;
  const bool settles = step.turn_pieces || (model_of(step).waits_for_hands && step.drags.empty());
  if (settles && !m_done.empty() && m_done.back().kind == EventKind::drag) {
    return m_done.back().stroke;
  }
  if (kind == EventKind::relax && follows_its_kind) return m_done.back().stroke;
  if (kind != EventKind::drag) return ++m_stroke;
  const bool goes_on = follows_its_kind && m_done.back().stroke == m_grab_stroke;
  if (!goes_on) m_grab_stroke = ++m_stroke;
  return m_grab_stroke;
}

/// Takes one step back; false where none is left.
bool LiveSession::take_back() {
  if (m_done.empty() || !m_session->undo()) return false;
  m_reached = m_done.back().reached_before;
  m_undone.push_back(std::move(m_done.back()));
  m_done.pop_back();
  return true;
}

void LiveSession::take_back(bool whole_stroke, bool looks) {
  if ((looks && take_look_back()) || !take_back()) return;
  const int stroke = m_undone.back().stroke;
  while (whole_stroke && !m_done.empty() && m_done.back().stroke == stroke && take_back()) {
  }
}

/// Does a step again; the same body gives the same. Steps since a cut that is not there may get
/// further, or less far, but nothing is grabbed then that would count on where they got to.
void LiveSession::make_again(const DoneStep& done, Progress* progress) {
  m_session->step(done.step, progress);
  m_reached = done.reached;
  m_done.push_back(done);
}

void LiveSession::make_again(bool whole_stroke, bool looks, Progress* progress) {
  if ((looks && make_look_again()) || m_undone.empty()) return;
  const int stroke = m_undone.back().stroke;
  do {
    make_again(m_undone.back(), progress);
    m_undone.pop_back();
  } while (whole_stroke && !m_undone.empty() && m_undone.back().stroke == stroke);
}

void LiveSession::take_out_cut(const LiveEvent& event, Progress* progress) {
  std::size_t cuts = 0, at = m_done.size(), place = 0;
  for (std::size_t n = 0; n < m_done.size(); ++n) {
    const std::size_t own = m_done[n].step.cuts.size();
    if (at == m_done.size() && cuts + own >= std::size_t(event.cut)) {
      at = n;
      place = std::size_t(event.cut) - 1 - cuts;
    }
    cuts += own;
  }
  if (at == m_done.size()) {
    throw InputError({event.place, "cut", std::to_string(event.cut),
                      "one of " + std::to_string(cuts) + " that there are, from 1"});
  }
  const std::vector<DoneStep> before(m_done.begin() + std::ptrdiff_t(at), m_done.end());
  if (m_session->undo_steps() < before.size()) {
    throw InputError(
        {event.place, "cut", std::to_string(before.size()) + " steps since it",
         "at most the " + std::to_string(m_session->undo_steps()) + " that can be taken back"});
  }
  std::vector<DoneStep> steps = before;
  DoneStep& cutting = steps.front();
  cutting.step.cuts.erase(cutting.step.cuts.begin() + std::ptrdiff_t(place));
  cutting.step.keys["cut"].erase(place);
  if (cutting.step.cuts.empty()) cutting.step.keys.erase("cut");
  if (cutting.step.does_nothing()) steps.erase(steps.begin());
  const std::vector<DoneStep> undone = m_undone;
  const auto take_back_to_it = [&] {
    while (m_done.size() > at) take_back();
  };
  take_back_to_it();
  try {
    for (const DoneStep& step : steps) make_again(step, progress);
  } catch (...) {
    take_back_to_it();
    for (const DoneStep& step : before) make_again(step, nullptr);
    m_undone = undone;
    throw;
  }
  m_undone.clear();
  m_grab.reset();
}

}  // namespace supple::tools
