// How the pages want to see what is open: sizes, slices, at rest or not. It belongs to the session:
// all pages that watch it see the same.
#pragma once

#include "tools/viewer/slice_panes.h"

namespace supple::tools {

struct ViewSettings {
  std::array<PixelSize, kViewCount> sizes{PixelSize{512, 512}, {0, 0}, {0, 0}, {0, 0}};
  SliceSettings slices;
  double amount = 1;     // of the displacement: 0 at rest, 1 as the body is
  bool curtain = false;  // pictures of the body at rest, too

  bool deformed() const { return amount > 0; }
};

}  // namespace supple::tools
