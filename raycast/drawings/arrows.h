// Displacements as arrows in space: a shaft and a head each, as triangles that a picture draws with
// its other surfaces, hidden by nearer tissue.
// Cost: 46 triangles per arrow.
#pragma once

#include <functional>
#include <vector>

#include "raycast/scene/surface.h"
#include "volumes/base/fields.h"
#include "volumes/geometry/geometry.h"

namespace supple {

struct Arrow {
  Vec3d from_lps_mm, to_lps_mm;
};

/// The arrow of the tissue at a place of the index frame; false where there is none.
using ArrowAt = std::function<bool(const Vec3d& index, Arrow& arrow)>;

/// The arrows of places `apart_mm` from each other along the grid axes, evenly about the middle of
/// the volume's box; those shorter than a fiftieth of `apart_mm` are left out. Throws InputError:
/// more than 10^6 places.
std::vector<Arrow> arrows_on_lattice(const Geometry& geometry, double apart_mm,
                                     const ArrowAt& arrow_at);

/// Makes a surface for each colour that occurs, of `kArrowColours` up to `longest_mm`; longer
/// arrows have the last. Shafts are an eighth of `apart_mm` thick, and heads shorter than arrows.
std::vector<Surface> arrow_surfaces(const std::vector<Arrow>& arrows, double apart_mm,
                                    double longest_mm,
                                    const std::function<Rgb(double share)>& colour);
constexpr int kArrowColours = 32;

}  // namespace supple
