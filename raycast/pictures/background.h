// Background of a picture: transparent, one colour, or the checkerboard by which programs show
// transparency. Colours are composited as they are displayed, like those of the marcher.
#pragma once

#include <string>

#include "raycast/pictures/image.h"
#include "volumes/base/fields.h"

namespace supple {

struct Background {
  enum class Kind { transparent, colour, checker };
  Kind kind = Kind::transparent;
  Rgb rgb{0, 0, 0};  // of the colour
};

/// "transparent", "checker", "#RRGGBB" or a name of background_names(). Throws InputError.
Background parse_background(const std::string& text);
/// Colours that have names.
std::vector<std::string> background_names();

/// True if dark words are more legible on it than pale ones.
bool is_light(const Background& background);

/// The picture over the background, opaque from now on; a transparent one changes nothing. Squares
/// of a checkerboard are 1/32 of the height, at least 4 pixels, in two greys.
void put_over(const Background& background, FloatImage& picture);

}  // namespace supple
