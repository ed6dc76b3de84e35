#include "tools/scene/tissue_marks.h"

#include <filesystem>

#include "volumes/io/open_volume.h"

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
  };
}

void read_labels(TissueMarks& marks) {
  if (marks.labels_path.empty()) return;
  marks.labels = std::make_shared<StoredLabels>(*open_volume(marks.labels_path, {}));
}

TissueMarks recorded(TissueMarks marks) {
  marks.labels_path = std::filesystem::path(marks.labels_path).filename().string();
  return marks;
}

}  // namespace supple::tools
