// The message `scene`: all that the page's panels show.
#pragma once

#include "raycast/scene/transfer_function.h"
#include "tools/scene/file/measure.h"
#include "tools/scene/live/live_picture.h"
#include "tools/scene/live/live_session.h"
#include "tools/scene/live/state_parts.h"
#include "tools/viewer/opened_file.h"
#include "tools/viewer/view_settings.h"

namespace supple::tools {

/// A transfer function as the message `presets` has it.
Value transfer_json(const TransferFunction& function);

/// The parts that a session holds, fixes and has cut: keys of events, and where they are now.
/// Numbered as a release counts them, where one can be let go of; those of the state that was
/// opened have no number, and its handles hold nothing. Handles without a middle are not listed.
Value handles_json(const HeldParts& held, const StateParts& of_state, const State& state,
                   const Displacement& moved);
Value anchors_json(const HeldParts& held, const StateParts& of_state, const State& state,
                   const Displacement& moved);
Value cuts_json(const std::vector<DoneStep>& done, const StateParts& of_state, const State& state,
                const Displacement& moved);

/// Their values at rest and as the body is shown, mm or degrees, and their points, LPS mm.
Value measures_json(const std::vector<Measure>& measures, const Displacement& moved);

class SceneDescription {
 public:
  /// All outlive it. No event has been carried out so far.
  SceneDescription(LiveSession& live, LivePicture& picture, const ViewSettings& settings);

  /// Notes what the pages tell of the file; `number` counts those that were opened.
  void note_opening(const OpenedFile& file, int number);
  /// The message, but for `event`, which each page counts for itself. While the body is being
  /// moved, it is described as it was.
  /// `overlay_range`: of the values that an overlay shows.
  Value told(bool is_moving, const ScalarRange& overlay_range);

 private:
  Value body();
  const ScalarRange& densities();

  LiveSession& m_live;
  LivePicture& m_picture;
  const ViewSettings& m_settings;
  StateParts m_state_parts;  // of a state that was opened
  std::string m_assumed;
  Value m_modality;
  int m_number = 0;
  Value m_first;                           // look and window, once they were told
  std::optional<ScalarRange> m_densities;  // once they were asked for
  Value m_body_told;                       // before the body moved
};

}  // namespace supple::tools
