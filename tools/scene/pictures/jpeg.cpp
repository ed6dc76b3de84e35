#include "tools/scene/pictures/jpeg.h"

#include <memory>

#include <turbojpeg.h>

#include "volumes/base/error.h"

namespace supple::tools {

namespace {

constexpr int kJpegQuality = 85;

struct CloseCompressor {
  void operator()(void* compressor) const { tjDestroy(compressor); }
};

/// Pixels that hide what is behind in part are rare: at edges of what is drawn on nothing.
std::vector<std::uint8_t> rgbx_on_black(const Image& image) {
  std::vector<std::uint8_t> rgba = image.rgba;
  for (std::size_t i = 0; i < rgba.size(); i += 4) {
    const unsigned alpha = rgba[i + 3];
    if (alpha == 255) continue;
    for (std::size_t c = 0; c < 3; ++c) rgba[i + c] = std::uint8_t(rgba[i + c] * alpha / 255);
  }
  return rgba;
}

}  // namespace

std::vector<std::uint8_t> jpeg_of(const Image& image) {
  static thread_local const std::unique_ptr<void, CloseCompressor> compressor(tjInitCompress());
  if (compressor == nullptr) throw SystemError("libjpeg-turbo: not enough memory");
  std::vector<std::uint8_t> flattened;
  if (image.has_alpha) flattened = rgbx_on_black(image);
  const std::uint8_t* rgba = image.has_alpha ? flattened.data() : image.rgba.data();
  std::vector<std::uint8_t> bytes(tjBufSize(image.width, image.height, TJSAMP_420));
  unsigned char* out = bytes.data();
  unsigned long size = static_cast<unsigned long>(bytes.size());
  if (tjCompress2(compressor.get(), rgba, image.width, 0, image.height, TJPF_RGBX, &out, &size,
                  TJSAMP_420, kJpegQuality, TJFLAG_NOREALLOC | TJFLAG_FASTDCT) != 0) {
    throw Error(std::string("libjpeg-turbo: ") + tjGetErrorStr2(compressor.get()));
  }
  bytes.resize(size);
  return bytes;
}

}  // namespace supple::tools
