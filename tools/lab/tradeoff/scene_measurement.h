// One scene, row after row: each run of a row is a process of its own (`supple run --method`), so
// that peak memory is that of the setting, and neither a crash nor a time limit ends the rest.
// Times are those of the stages that the run itself reports, not of its start.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "lib/material/material.h"
#include "lib/state/state.h"
#include "raycast/pictures/image.h"
#include "tools/console/console.h"
#include "tools/lab/options/lab_options.h"
#include "tools/scene/choice/trade_row.h"
#include "tools/scene/file/draw_method.h"
#include "tools/scene/file/step_method.h"
#include "volumes/base/process.h"
#include "volumes/base/progress.h"

namespace supple::tools {

// How far a deformed body is from the reference: distances of its elements in mm, over those that
// the reference moves; change of volume, and energy in the springs of the links.

struct ErrorNorms {
  std::int64_t moved = 0;  // elements that are looked at
  double p50_mm = 0, p95_mm = 0, max_mm = 0;
  double volume_percent = 0;
  double energy_uj = 0;
};

/// Elements whose reference moves by less than this part of the largest move do not count: most of
/// a body hardly moves, and would hide the error where it does.
constexpr double kMovedPart = 0.01;

class ErrorReference {
 public:
  /// Reads a state. Throws InputError as read_state.
  ErrorReference(const std::string& state_path, Progress* progress);

  /// Error of another state of the same body. The largest distance is that of all elements, moved
  /// or not. `distances_mm`: gets that of each element, in the order of the bricks. Throws
  /// InputError as read_state, and for another grid or other elements.
  ErrorNorms norms_of(const std::string& state_path, Progress* progress,
                      std::vector<float>* distances_mm = nullptr) const;

  const State& state() const { return m_state; }

  /// Steps in which a state stores places: no error below half of it is seen.
  double resolution_mm() const;

 private:
  State m_state;
  MaterialTable m_material;
  double m_least_mm;  // moves that count
};

/// Settings of a row: how the scene is solved, or drawn.
struct RowSetting {
  std::string family;
  double knob = 0;
  std::vector<std::string> words;  // of the command line
  bool is_drawing = false;

  /// "relax-26:64".
  std::string name() const;
};
RowSetting to_row(const StepMethod& method);
/// A row that draws the body as the fastest method leaves it, since only the picture matters.
RowSetting to_row(const DrawMethod& method);

/// Finite elements to this tolerance are what others are compared with.
constexpr double kReferenceTolerance = 1e-10;
StepMethod reference_method();
/// Pictures are compared with that of samples which solve for themselves, a twentieth of a voxel
/// apart.
constexpr double kReferenceStep = 0.05;
DrawMethod reference_drawing();

class SceneMeasurement {
 public:
  /// `name`: of its files. Refers to the rest.
  SceneMeasurement(const MeasureOptions& options, const Scene& scene, std::string name,
                   Console& console);

  /// True if the row is of the same scene, volume, program and number of threads.
  bool is_current(const TradeRow& row) const { return row.inputs == m_inputs; }
  /// True if the reference that others are compared with is there.
  bool has_reference(bool of_drawings) const;

  /// All runs of a row, and its error. The reference comes before others. Throws Cancelled, and as
  /// ErrorReference.
  TradeRow measure(const RowSetting& setting);
  /// A row that is left out.
  TradeRow leave_out(const RowSetting& setting, const std::string& reason) const;

  double resolution_mm() { return reference().resolution_mm(); }
  /// Path of the row's picture that is compared; empty if it has none.
  std::string picture_of(const RowSetting& setting) const;

 private:
  std::string folder_of(const RowSetting& setting) const;
  std::vector<std::string> arguments(const RowSetting& setting) const;
  TradeRow empty_row(const RowSetting& setting) const;
  bool run_all(TradeRow& row, const RowSetting& setting);
  void compare_states(const RowSetting& setting, TradeRow& row);
  void compare_pictures(const RowSetting& setting, TradeRow& row);
  const ErrorReference& reference();

  const MeasureOptions& m_options;
  const Scene& m_scene;
  std::string m_name;
  Console& m_console;
  std::string m_program = require_program_beside("supple");
  std::string m_inputs;
  std::unique_ptr<ErrorReference> m_reference;
};

}  // namespace supple::tools
