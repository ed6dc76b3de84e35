// The part of a live session that takes steps and looks back, makes them again, and takes out one
// of the cuts.
#include <utility>

#include "lib/session/step_model.h"
#include "tools/scene/file/measure.h"
#include "tools/scene/live/led_stroke.h"
#include "tools/scene/live/live_view.h"

namespace supple::tools {

namespace {

/// Looks or clips that follow each other so soon are one step: a point that is dragged, a slider.
constexpr double kOneLookMs = 1000;

constexpr std::size_t kMostMeasures = 100;

/// Returns the keys of all measures after those looks.
Value measures_after(const std::vector<DoneLook>& looks) {
  for (auto look = looks.rbegin(); look != looks.rend(); ++look) {
    if (look->kind == EventKind::measure) return look->after;
  }
  return {{"measure", Value::List()}};
}

/// Adds what the event adds, or takes away what it takes away.
Value measures_after(const LiveEvent& event, Value measures) {
  Value& list = measures["measure"];
  const std::size_t count = list.size();
  if (std::size_t(event.remove) > count) {
    throw InputError({event.place, "remove", std::to_string(event.remove),
                      "one of " + std::to_string(count) + " measures that there are, from 1"});
  }
  if (event.all) {
    list = Value::List();
  } else if (event.remove > 0) {
    list.erase(std::size_t(event.remove) - 1);
  } else if (count == kMostMeasures) {
    throw InputError({event.place, "measure", "one more than " + std::to_string(count),
                      "some taken away before"});
  } else {
    list.push_back(event.view);
  }
  return measures;
}

bool is_of_picture(const DoneLook& look) {
  return look.kind != EventKind::measure;
}

/// Moves the last of one list to the end of another.
template <class Done>
void hand_over(std::vector<Done>& from, std::vector<Done>& to) {
  to.push_back(std::move(from.back()));
  from.pop_back();
}

}  // namespace

int LiveHistory::stroke_of(EventKind kind, const Step& step) {
  const bool follows_its_kind = !done.empty() && done.back().kind == kind;
  const bool settles = step.turn_pieces || (model_of(step).waits_for_hands && step.drags.empty());
  if (settles && !done.empty() && done.back().kind == EventKind::drag) return done.back().stroke;
  if (kind == EventKind::relax && follows_its_kind) return done.back().stroke;
  if (kind != EventKind::drag) return ++stroke;
  const bool goes_on = follows_its_kind && done.back().stroke == hand_stroke;
  if (!goes_on) hand_stroke = ++stroke;
  return hand_stroke;
}

std::vector<Measure> LiveHistory::measures() const {
  std::vector<Measure> measures;
  Table root(measures_after(looks), "");
  for (Table& table : root.tables("measure")) measures.push_back(read_measure(table));
  return measures;
}

/// Records the last of cameras in a row alone, and of looks or clips the last of one step.
void LiveSession::change_view(const LiveEvent& event) {
  if (event.kind == EventKind::measure) {
    const Value before = measures_after(m_history.looks);
    const Value after = measures_after(event, before);
    m_history.undone_looks.clear();
    m_history.looks.push_back({event.kind, ++m_history.order, event.at_ms, before, after});
    return m_journal->add(event);
  }
  const Value before = m_view->part(event.kind);
  m_view->set_part(event.kind, event.view, event.place);
  LiveEvent carried_out = event;
  carried_out.view = m_view->part(event.kind);
  const bool follows_its_kind = event.kind == m_journal->last();
  if (event.kind == EventKind::camera) return m_journal->add(carried_out, follows_its_kind);
  m_history.undone_looks.clear();
  std::vector<DoneLook>& looks = m_history.looks;
  const bool goes_on = !looks.empty() && looks.back().kind == event.kind &&
                       looks.back().order == m_history.order &&
                       event.at_ms <= looks.back().at_ms + kOneLookMs;
  if (goes_on) {
    looks.back().at_ms = event.at_ms;
    looks.back().after = carried_out.view;
  } else {
    looks.push_back({event.kind, ++m_history.order, event.at_ms, before, carried_out.view});
  }
  m_journal->add(carried_out, goes_on && follows_its_kind);
}

/// Takes one step back; false where none is left.
bool LiveSession::take_back() {
  if (m_led->take_back()) return true;
  if (m_history.done.empty() || !m_session->undo()) return false;
  m_led->drop_lead();
  m_hand.reached = m_history.done.back().reached_before;
  hand_over(m_history.done, m_history.undone);
  return true;
}

void LiveSession::undo(const LiveEvent& event) {
  std::vector<DoneLook>& looks = m_history.looks;
  const std::vector<DoneStep>& done = m_history.done;
  int newest = done.empty() ? 0 : done.back().order;
  if (m_led->moves()) newest = m_led->order();
  if (event.looks && !looks.empty() && newest < looks.back().order) {
    if (is_of_picture(looks.back())) m_view->set_part(looks.back().kind, looks.back().before);
    return hand_over(looks, m_history.undone_looks);
  }
  if (!take_back()) return;
  const int stroke = m_history.undone.back().stroke;
  while (event.all && !done.empty() && done.back().stroke == stroke && take_back()) {
  }
}

/// Does a step again; the same body gives the same. Steps since a cut that is not there may get
/// further, or less far, but nothing is grabbed then that would count on where they got to.
void LiveSession::make_again(const DoneStep& done, Progress* progress) {
  m_session->step(done.step, progress);
  m_hand.reached = done.reached;
  m_history.done.push_back(done);
}

void LiveSession::redo(const LiveEvent& event, Progress* progress) {
  std::vector<DoneLook>& looks = m_history.undone_looks;
  std::vector<DoneStep>& undone = m_history.undone;
  if (event.looks && !looks.empty() &&
      (undone.empty() || looks.back().order < undone.back().order)) {
    if (is_of_picture(looks.back())) m_view->set_part(looks.back().kind, looks.back().after);
    return hand_over(looks, m_history.looks);
  }
  if (undone.empty()) return;
  const int stroke = undone.back().stroke;
  do {
    make_again(undone.back(), progress);
    undone.pop_back();
  } while (event.all && !undone.empty() && undone.back().stroke == stroke);
}

void LiveSession::take_out_cut(const LiveEvent& event, Progress* progress) {
  const std::vector<DoneStep>& done = m_history.done;
  std::size_t cuts = 0, at = done.size(), place = 0;
  for (std::size_t n = 0; n < done.size(); ++n) {
    const std::size_t own = done[n].step.cuts.size();
    if (at == done.size() && cuts + own >= std::size_t(event.cut)) {
      at = n;
      place = std::size_t(event.cut) - 1 - cuts;
    }
    cuts += own;
  }
  if (at == done.size()) {
    throw InputError({event.place, "cut", std::to_string(event.cut),
                      "one of " + std::to_string(cuts) + " that there are, from 1"});
  }
  const std::vector<DoneStep> before(done.begin() + std::ptrdiff_t(at), done.end());
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
  const std::vector<DoneStep> undone = m_history.undone;
  const auto take_back_to_it = [&] {
    while (done.size() > at) take_back();
  };
  take_back_to_it();
  try {
    for (const DoneStep& step : steps) make_again(step, progress);
  } catch (...) {
    take_back_to_it();
    for (const DoneStep& step : before) make_again(step, nullptr);
    m_history.undone = undone;
    throw;
  }
  m_history.undone.clear();
  m_hand.grab.reset();
}

}  // namespace supple::tools
