// Marks on tissue, over slices and in pictures in space: a grid that was straight at rest, arrows,
// the labels of a segmentation, and values in colour.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "volumes/base/fields.h"
#include "volumes/grid/density_grid.h"
#include "volumes/io/load/stored_labels.h"

namespace supple::tools {

struct TissueMarks {
  std::string labels_path;                   // of a segmentation at rest; empty: none
  std::optional<double> grid_mm, arrows_mm;  // distance of lines and arrows; absent: none
  std::string overlay;  // displacement, det_f, or a file of values at rest; empty: none
  std::optional<NumberPair> overlay_range;  // at the ends of its colours; absent: of all values

  bool has_surfaces() const { return arrows_mm || labels != nullptr; }
  bool empty() const { return !grid_mm && !has_surfaces() && overlay.empty(); }

  bool shows_displacement() const { return overlay == "displacement"; }
  bool shows_det_f() const { return overlay == "det_f"; }
  bool names_overlay_file() const {
    return !overlay.empty() && !shows_displacement() && !shows_det_f();
  }

  /// Read by read_marks.
  std::shared_ptr<const StoredLabels> labels;
  std::shared_ptr<const Volume> overlay_volume;
};

/// Keys of a [[view]] and of its slice.
Fields fields(TissueMarks& marks);

/// Reads the files that are named. Throws InputError: as a volume file, a range that does not
/// ascend, with `place`.
void read_marks(TissueMarks& marks, const std::string& place);

/// Returns the marks as they are recorded: files by their names alone.
TissueMarks recorded(TissueMarks marks);

}  // namespace supple::tools
