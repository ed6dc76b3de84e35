// Marks that show the motion of tissue, over slices and in pictures in space: a grid that was
// straight at rest, arrows, and the labels of a segmentation.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "volumes/base/fields.h"
#include "volumes/io/load/stored_labels.h"

namespace supple::tools {

struct TissueMarks {
  std::string labels_path;                   // of a segmentation at rest; empty: none
  std::optional<double> grid_mm, arrows_mm;  // distance of lines and arrows; absent: none

  bool has_surfaces() const { return arrows_mm || labels != nullptr; }
  bool empty() const { return !grid_mm && !has_surfaces(); }

  /// Read by read_labels.
  std::shared_ptr<const StoredLabels> labels;
};

/// Of a [[view]] and of its slice.
Fields fields(TissueMarks& marks);

/// Reads the labels that are named. Throws InputError: as a volume file.
void read_labels(TissueMarks& marks);

/// As they are recorded: files by their names alone.
TissueMarks recorded(TissueMarks marks);

}  // namespace supple::tools
