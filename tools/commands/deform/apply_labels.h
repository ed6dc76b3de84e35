// Label volumes that follow a deformation (volumes/io/load/followed_labels.h), into files, with
// their counts before and after. Memory: that of StoredLabels and one slice.
#pragma once

#include <string>

#include "lib/state/state_outputs.h"
#include "tools/console/console.h"
#include "volumes/base/value.h"
#include "volumes/field/points/point_motion.h"
#include "volumes/io/load/stored_labels.h"

namespace supple::tools {

struct LabelOptions {
  std::string path;
  ReadOptions read;
  GridChoice grid;
};

struct LabelReport {
  Geometry grid;
  LabelCounts before, after;
  std::int64_t unresolved = 0;  // voxels whose origin was not found; they are 0
};

/// Writes for each voxel x the label at x + o(x), 0 in the void.
LabelReport write_labels(const std::string& path, const StoredLabels& labels,
                         const OffsetField& offsets, const Geometry& grid, Console& console);
/// Writes for each voxel the label at the place that the motion leads to; 0 outside of the motion.
LabelReport write_labels(const std::string& path, const StoredLabels& labels,
                         const PointMotion& motion, const Geometry& grid, Console& console);

/// Labels that are gone, voxels that were not found.
void warn_of(const LabelReport& report, const std::string& path, Console& console);

/// The report of `apply` about labels with --json; at most 1000 labels.
Value to_value(const LabelReport& report);

}  // namespace supple::tools
