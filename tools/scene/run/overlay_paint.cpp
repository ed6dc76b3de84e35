#include "tools/scene/run/overlay_paint.h"

#include <algorithm>
#include <filesystem>

#include "volumes/base/error.h"
#include "volumes/grid/cell.h"
#include "volumes/grid/density_grid.h"

namespace supple::tools {

namespace {

/// True if a corner of the place's cell is an element.
bool is_beside_element(const BrickTopology& elements, const Vec3d& index) {
  for (int n = 0; n < 8; ++n) {
    if (elements.is_active(floor_voxel(index) + cell_corner(n))) return true;
  }
  return false;
}

/// Values of a volume between its voxels, of those that count alone.
std::optional<double> value_between(const Volume& volume, const PaintedBody& body,
                                    const Vec3d& at_rest, double least_weight) {
  const Vec3d place = volume.geometry.index_from_world(body.geometry.world_from_index(at_rest));
  const Vec3i low = floor_voxel(place);
  const Vec3d t = place - Vec3d(low);
  double sum = 0, weights = 0;
  for (int n = 0; n < 8; ++n) {
    const Vec3i step = cell_corner(n), voxel = low + step;
    const double weight =
        (step.x ? t.x : 1 - t.x) * (step.y ? t.y : 1 - t.y) * (step.z ? t.z : 1 - t.z);
    if (weight == 0 || !volume.density.bricks().is_active(voxel)) continue;
    const Vec3d of_body =
        body.geometry.index_from_world(volume.geometry.world_from_index(Vec3d(voxel)));
    if (!body.elements.is_active(floor_voxel(of_body + Vec3d(0.5)))) continue;
    sum += weight * volume.density.at(voxel);
    weights += weight;
  }
  if (!(weights > least_weight)) return std::nullopt;
  return sum / weights;
}

std::string title_of(const TissueMarks& marks) {
  if (marks.shows_displacement()) return "moved (mm)";
  if (marks.shows_det_f()) return "det F";
  return std::filesystem::path(marks.overlay).stem().string();
}

}  // namespace

void add_overlay_legend(Annotations& annotations, const TissueMarks& marks, const ValuePaint& paint,
                        int n, int count) {
  const auto colour = [&](double value) { return paint.colour(value); };
  annotations.legend(paint.range, colour, title_of(marks), n, count);
}

RestPlaceAt rest_place_of(const OffsetField& offsets) {
  return
      [&offsets](const Vec3d& index, Vec3d& at_rest) { return offsets.source_of(index, at_rest); };
}

TissueMarks with_overlay_range(TissueMarks marks, double longest_mm) {
  if (marks.overlay.empty() || marks.overlay_range) return marks;
  ScalarRange range = kVolumeRatios;
  if (marks.shows_displacement()) range = {0, longest_mm > 0 ? longest_mm : 1};
  if (marks.overlay_volume) {
    const VolumeStatistics& found = marks.overlay_volume->statistics;
    range = {found.min, found.max > found.min ? found.max : found.min + 1};
    if (range.lo < 0 && range.hi > 0) {
      range.hi = std::max(-range.lo, range.hi);
      range.lo = -range.hi;
    }
  }
  marks.overlay_range = NumberPair(range.lo, range.hi);
  return marks;
}

ValuePaint overlay_paint(const TissueMarks& marks, const PaintedBody& body, PaintEdge edge) {
  const auto rest_place = [&rest = body.rest_place](const Vec3d& index, Vec3d& at_rest) {
    at_rest = index;
    return !rest || rest(index, at_rest);
  };
  ValuePaint paint;
  paint.range = {marks.overlay_range->first, marks.overlay_range->second};
  const bool is_det_f = marks.shows_det_f();
  if (is_det_f || paint.range.lo == -paint.range.hi) paint.colours = ValueColours::about_middle;
  if (marks.overlay_volume) {
    const Volume& volume = *marks.overlay_volume;
    const double least_weight = edge == PaintEdge::halfway ? 0.5 : 0;
    paint.value = [&volume, &body, rest_place,
                   least_weight](const Vec3d& index) -> std::optional<double> {
      Vec3d at_rest;
      if (!rest_place(index, at_rest)) return std::nullopt;
      return value_between(volume, body, at_rest, least_weight);
    };
    return paint;
  }
  paint.value = [&body, rest_place, is_det_f, edge](const Vec3d& index) -> std::optional<double> {
    Vec3d at_rest;
    if (!rest_place(index, at_rest)) return std::nullopt;
    const bool is_tissue = edge == PaintEdge::halfway
                               ? body.elements.is_active(floor_voxel(at_rest + Vec3d(0.5)))
                               : is_beside_element(body.elements, at_rest);
    if (!is_tissue) return std::nullopt;
    if (!is_det_f) return body.geometry.world_vector_from_index(index - at_rest).length();
    const auto f = deformation_at(rest_place, index);
    return f ? std::optional<double>(determinant(*f)) : std::nullopt;
  };
  return paint;
}

}  // namespace supple::tools
