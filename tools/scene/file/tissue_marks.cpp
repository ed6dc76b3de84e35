#include "tools/scene/file/tissue_marks.h"

#include <filesystem>

#include "volumes/base/error.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/load/load.h"

namespace supple::tools {

Fields fields(TissueMarks& marks) {
  return {
      Field("labels", marks.labels_path, "Outlines, in space surfaces, of a segmentation at rest")
          .path(),
      Field("grid", marks.grid_mm, "Lines that were straight at rest, so far apart")
          .unit("mm")
          .range(0.5, 1000),
      Field("arrows", marks.arrows_mm, "Displacements as arrows, so far apart")
          .unit("mm")
          .range(0.5, 1000),
      Field("overlay", marks.overlay, "Colours over tissue: displacement, det_f, or values at rest")
          .word_or_path({"displacement", "det_f"})
          .shown_as("NAME|FILE"),
      Field("overlay_range", marks.overlay_range, "Values at the ends of its colours")
          .shown_as("LO,HI")
          .otherwise("of all values"),
  };
}

void read_marks(TissueMarks& marks, const std::string& place) {
  if (!marks.labels_path.empty()) {
    marks.labels = std::make_shared<StoredLabels>(*open_volume(marks.labels_path, {}));
  }
  if (marks.overlay_range) {
    const auto [lo, hi] = *marks.overlay_range;
    if (marks.overlay.empty()) {
      throw InputError({place, "overlay_range", "a range without an overlay", "overlay beside it"});
    }
    if (!(lo < hi)) {
      throw InputError({place, "overlay_range", number_text(lo) + "," + number_text(hi),
                        "two values, the lower one first"});
    }
  }
  if (marks.names_overlay_file()) {
    if (!std::filesystem::exists(marks.overlay)) {
      throw InputError({place, "overlay", marks.overlay + ", no such file",
                        "displacement, det_f or a readable file"});
    }
    marks.overlay_volume = std::make_shared<Volume>(load_volume(marks.overlay));
  }
}

TissueMarks recorded(TissueMarks marks) {
  marks.labels_path = std::filesystem::path(marks.labels_path).filename().string();
  if (marks.names_overlay_file()) {
    marks.overlay = std::filesystem::path(marks.overlay).filename().string();
  }
  return marks;
}

}  // namespace supple::tools
