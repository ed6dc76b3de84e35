// The plugin's only exported symbol (pictures_plugin.h).
#include "raycast/pictures/pictures_plugin.h"

extern "C" __attribute__((visibility("default")))
const supple::PicturesPlugin supple_pictures_plugin;

const supple::PicturesPlugin supple_pictures_plugin = {
    supple::PicturesPlugin::kSizes, supple::compare,   supple::difference_image,
    supple::offset_colours,         supple::write_exr, supple::draw_overlay};
