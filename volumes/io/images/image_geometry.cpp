#include <limits>

#include "volumes/base/error.h"
#include "volumes/io/bytes/text_header.h"
#include "volumes/io/format/formats.h"

namespace supple {

Geometry image_geometry(const std::string& path, std::int64_t width, std::int64_t height) {
  const std::string text = std::to_string(width) + " " + std::to_string(height);
  const Vec3i dims = dims_from({path, "image size", text}, {width, height});
  return make_geometry(path, dims, {0, 0, 0}, {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}});
}

}  // namespace supple
