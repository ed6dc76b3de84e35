// What program and plugin agree on (volumes/base/plugin.h).
#pragma once

#include "raycast/pictures/colour_map.h"
#include "raycast/pictures/compare.h"
#include "raycast/pictures/float_image.h"
#include "raycast/pictures/overlay.h"
#include "volumes/base/atomic_file.h"
#include "volumes/base/plugin.h"

namespace supple {

/// The functions of these names in colour_map.h, compare.h, float_image.h and overlay.h.
struct PicturesPlugin {
  static constexpr PluginName kName{"supple_pictures.so", "supple_pictures_plugin",
                                    "compares pictures, draws legends and words, and writes EXR"};
  static constexpr std::array<std::size_t, 5> kSizes{sizeof(Image), sizeof(FloatImage),
                                                     sizeof(Comparison), sizeof(AtomicFile),
                                                     sizeof(OverlayShape)};

  std::array<std::size_t, 5> sizes;
  Comparison (*compare)(const Image& a, const Image& b, bool foreground_only);
  Image (*difference_image)(const Image& a, const Image& b);
  Image (*offset_image)(const FloatImage& picture, const ScalarRange& range_mm,
                        const std::array<float, 3>& towards_camera);
  Image (*depth_image)(const FloatImage& picture, const ScalarRange& range_mm);
  void (*write_exr)(const AtomicFile& target, const FloatImage& picture,
                    const std::string& comment);
  void (*draw_overlay)(FloatImage& picture, const Overlay& overlay);
};

}  // namespace supple
