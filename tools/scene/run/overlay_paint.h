// Values that `overlay` of a view or a slice paints over tissue: how far it has moved (mm), det F,
// or the values of a volume at rest, on any grid.
#pragma once

#include "raycast/drawings/annotations.h"
#include "raycast/drawings/painted_values.h"
#include "tools/scene/file/tissue_marks.h"
#include "volumes/field/offset_field.h"

namespace supple::tools {

/// The body that is painted.
struct PaintedBody {
  const Geometry& geometry;
  const BrickTopology& elements;  // only these are painted; of a plain volume its voxels
  RestPlaceAt rest_place;         // null: tissue is at rest
};

/// Between elements and air: painted as far as the nearest voxel is an element, as slices are, or
/// as far as any corner of the cell is, since surfaces are seen up to a voxel beyond elements.
enum class PaintEdge { halfway, beside };

/// The marks with the range of their overlay decided: of displacements 0 to `longest_mm`, of values
/// of both signs as far to each side of 0.
TissueMarks with_overlay_range(TissueMarks marks, double longest_mm);
/// Paints an overlay with a range; one about 0 has colours about its middle. Those voxels of a file
/// count that are elements and above its least value. Refers to the marks and to the body.
ValuePaint overlay_paint(const TissueMarks& marks, const PaintedBody& body, PaintEdge edge);

/// The legend of an overlay's colours: the n-th of so many, from above.
void add_overlay_legend(Annotations& annotations, const TissueMarks& marks, const ValuePaint& paint,
                        int n, int count);

/// Finds rest places by the offsets, to which it refers.
RestPlaceAt rest_place_of(const OffsetField& offsets);

}  // namespace supple::tools
