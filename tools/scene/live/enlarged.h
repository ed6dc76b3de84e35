// Small pictures at the size of the view.
#pragma once

#include "raycast/pictures/image.h"

namespace supple::tools {

/// Stretches an image to that size, linear between pixels.
Image enlarged(const Image& image, int width, int height);

}  // namespace supple::tools
