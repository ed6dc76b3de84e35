// What `overlay` of a view or a slice paints over tissue: how far it has moved (mm), det F, or the
// values of a volume at rest, on any grid.
#pragma once

#include "raycast/drawings/annotations.h"
#include "raycast/drawings/painted_values.h"
#include "tools/scene/tissue_marks.h"
#include "volumes/field/offset_field.h"

namespace supple::tools {

/// The body that is painted.
struct PaintedBody {
  const Geometry& geometry;
  const BrickTopology* elements;  // only these are painted; null or empty: all that is seen
  RestPlaceAt rest_place;         // null: tissue is at rest
};

/// How a value of a volume is known between its voxels: nearer to voxels that count than to others,
/// or beside one that counts, which surfaces ask for. Elements count where the volume has a
/// value; of a volume without a body those above its least value.
enum class PaintEdge { halfway, beside };

/// The marks with the range of their overlay decided: of displacements 0 to `longest_mm`, of values
/// of both signs as far to each side of 0.
TissueMarks with_overlay_range(TissueMarks marks, double longest_mm);
/// Of an overlay with a range; one that lies about 0 has colours about its middle. Refers to the
/// marks and to the body, whose functions it copies.
ValuePaint overlay_paint(const TissueMarks& marks, const PaintedBody& body, PaintEdge edge);

/// The legend of an overlay's colours: the n-th of so many, from above.
void add_overlay_legend(Annotations& annotations, const TissueMarks& marks, const ValuePaint& paint,
                        int n, int count);

/// Through offsets, which it refers to; null for tissue at rest.
RestPlaceAt rest_place_of(const OffsetField* offsets);

}  // namespace supple::tools
