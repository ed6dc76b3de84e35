// The module's only exported symbol (pictures_module.h).
#include "raycast/pictures/pictures_module.h"

extern "C" __attribute__((visibility("default")))
const supple::PicturesModule supple_pictures_module;

const supple::PicturesModule supple_pictures_module = {
    supple::PicturesModule::kSizes, supple::compare,     supple::difference_image,
    supple::offset_image,           supple::depth_image, supple::write_exr};
