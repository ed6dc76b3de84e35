// The scene that is open in the viewer: a live session with its loop, its pictures on their way to
// the pages, and what the pages ask about it. Everything here runs on the thread of the loop.
#pragma once

#include <memory>
#include <string>

#include "raycast/drawings/rest_outline.h"
#include "tools/console/console.h"
#include "tools/scene/live/live_loop.h"
#include "tools/viewer/curtain.h"
#include "tools/viewer/frame_encoder.h"
#include "tools/viewer/kept_sessions.h"
#include "tools/viewer/opened_file.h"
#include "tools/viewer/page_progress.h"
#include "tools/viewer/scene_json.h"

namespace supple::tools {

/// The objects through which a scene speaks to the pages.
struct SceneOutlets {
  Pages& pages;
  FrameEncoder& encoder;
  PageProgress& progress;
  Console& console;
};

class OpenScene final : public LoopWatcher {
 public:
  /// Opens what the root of a scene or journal describes and carries out its steps or events; where
  /// there are none, the largest bone is fixed (first_anchor()), and finite elements settle tissue
  /// that it holds (first_model()). Throws as LiveSession.
  OpenScene(const Table& root, double budget_ms, const ViewSettings& settings,
            const SceneOutlets& outlets);

  /// See LiveLoop::run().
  void run(EventMailbox& mailbox);
  void leave() { m_loop.leave(); }
  /// Tells the loop from another thread that something was posted.
  void interrupt() {
    m_loop.interrupt();
    m_curtain.interrupt();
  }

  /// Takes other wishes of the pages; `number` as of Pages::note().
  void see(const ViewSettings& settings, std::uint64_t number);
  /// Notes the number of what was asked last.
  void seen(std::uint64_t number) { m_number = number; }
  /// Ends what settles. Where a release is among the events that were given up, what is grabbed is
  /// let go of where it has got to, or goes back if that restores.
  void stop(const std::vector<LiveEvent>& given_up);
  /// Writes what is carried out from now on into a journal on disk.
  void keep(std::unique_ptr<KeptJournal> journal);
  /// Begins CT without a given look with the skin: bone hides where soft tissue moves.
  void begin_outside();
  /// Begins with the look that a page remembers, once; false where one was chosen.
  bool begin_with_look(const Value& look);
  /// Notes what the pages tell of the file; `number` counts those that were opened.
  void note_opening(const OpenedFile& file, int number);
  /// Notes that a file holds all that was done.
  void saved() {
    if (m_kept) m_kept->saved();
  }
  /// Restores what a page held that is gone, as Esc does.
  void page_left(int page, double at_ms);

  LiveSession& live() { return m_live; }
  LivePicture& picture() { return m_loop.picture(); }
  Curtain& curtain() { return m_curtain; }
  const ViewSettings& settings() const { return m_settings; }
  const SceneOutlets& outlets() const { return m_outlets; }

  void tell_scene();
  /// Draws a slice as the settings ask for it.
  SlicePane pane_of(int view, const PixelSize& size, const RestPlaceAt& rest, int every);

 private:
  void begins() override;
  void check(const LiveEvent& event) override;
  void carried_out(const LiveEvent& event) override;
  void went_on() override;
  void ends();
  bool refused(const LiveEvent& event, const std::string& why) override;
  void drew(const Image& first, const LiveCost& cost, const Stopwatch& since_event) override;
  void settled(const Image& image, const Stopwatch& since_event) override;
  bool work() override;
  bool has_later_work() const override { return !m_is_told; }
  bool draw_next_pane();
  bool may_tell() const;
  void choose_painter();
  ScalarRange overlay_range();
  FrameMessage frame_of(int view, double ms) const;

  SceneOutlets m_outlets;
  ViewSettings m_settings;
  LiveSession m_live;
  LiveLoop m_loop;
  Curtain m_curtain;
  SceneDescription m_description;
  std::unique_ptr<KeptJournal> m_kept;
  std::uint64_t m_number = 0;
  double m_budget_ms;
  /// State of panes: 0 up to date, 1 to be drawn exactly, 2 to be drawn in haste and then exactly.
  std::array<int, kViewCount> m_stale{};
  std::optional<ScalarRange> m_range;         // of the values that the overlay shows
  std::optional<RestOutline> m_rest_outline;  // while it is drawn in space
  Value m_warned_model;                       // keys of an expensive one that was refused once
  bool m_was_begun = false;                   // with the look of a page, if none was chosen
  bool m_is_told = false;
  bool m_is_moving = false;
  bool m_moves_view = false;  // the event changes how the body is looked at, not the body
  std::chrono::steady_clock::time_point m_told;
};

}  // namespace supple::tools
