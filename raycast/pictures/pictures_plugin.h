// Interface between the program and its picture plugin (volumes/base/plugin.h).
#pragma once

#include "raycast/pictures/compare.h"
#include "raycast/pictures/image.h"
#include "raycast/pictures/overlay.h"
#include "volumes/base/atomic_file.h"
#include "volumes/base/plugin.h"

namespace supple {

/// 8 bits of red, green and blue.
using ColourTable = std::array<std::array<std::uint8_t, 3>, 256>;
/// The table of offset_colour().
ColourTable offset_colours();

/// The functions of these names in compare.h, image.h and overlay.h.
struct PicturesPlugin {
  static constexpr PluginName kName{"supple_pictures.so", "supple_pictures_plugin",
                                    "compares pictures, draws legends and words, and writes EXR"};
  static constexpr std::array<std::size_t, 6> kSizes{sizeof(Image),        sizeof(FloatImage),
                                                     sizeof(Comparison),   sizeof(AtomicFile),
                                                     sizeof(OverlayShape), sizeof(ExrFacts)};

  std::array<std::size_t, 6> sizes;
  Comparison (*compare)(const Image& a, const Image& b, bool foreground_only);
  Image (*difference_image)(const Image& a, const Image& b);
  ColourTable (*offset_colours)();
  void (*write_exr)(const AtomicFile& target, const FloatImage& picture, const ExrFacts& facts);
  void (*draw_overlay)(FloatImage& picture, const Overlay& overlay);
};

}  // namespace supple
