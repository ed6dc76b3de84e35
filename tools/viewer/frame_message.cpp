#include "tools/viewer/frame_message.h"

#include <cstring>

#include <turbojpeg.h>

#include "volumes/base/error.h"

namespace supple::tools {

const std::array<const char*, kViewCount> kViewNames = {"3d", "axial", "coronal", "sagittal"};

namespace {

constexpr int kJpegQuality = 85;

struct CloseCompressor {
  void operator()(void* compressor) const { tjDestroy(compressor); }
};

template <class T>
void append(std::vector<std::uint8_t>& bytes, T value) {
  const std::size_t at = bytes.size();
  bytes.resize(at + sizeof(T));
  std::memcpy(&bytes[at], &value, sizeof(T));  // x86-64 is little-endian, as the head
}

/// Pixels that hide what is behind in part are rare: at edges of what is drawn on nothing.
std::vector<std::uint8_t> on_black(const Image& image) {
  std::vector<std::uint8_t> rgba = image.rgba;
  for (std::size_t i = 0; i < rgba.size(); i += 4) {
    const unsigned alpha = rgba[i + 3];
    if (alpha == 255) continue;
    for (std::size_t c = 0; c < 3; ++c) rgba[i + c] = std::uint8_t(rgba[i + c] * alpha / 255);
  }
  return rgba;
}

}  // namespace

std::vector<std::uint8_t> head_of(const FrameMessage& frame, std::uint32_t event,
                                  std::uint32_t frame_number) {
  std::vector<std::uint8_t> head = {'S', 'V', 'F', '1'};
  append(head, event);
  append(head, frame_number);
  append(head, std::uint8_t(frame.view));
  append(head, std::uint8_t(frame.is_png));
  append(head, std::uint8_t(frame.is_settled));
  append(head, std::uint8_t(0));
  append(head, std::uint16_t(frame.width));
  append(head, std::uint16_t(frame.height));
  append(head, float(frame.ms));
  if (frame.pixels) {
    for (const Vec3d& v :
         {frame.pixels->first_lps_mm, frame.pixels->right_mm, frame.pixels->down_mm}) {
      for (int a = 0; a < 3; ++a) append(head, v[a]);
    }
  }
  return head;
}

std::vector<std::uint8_t> jpeg_of(const Image& image) {
  static thread_local const std::unique_ptr<void, CloseCompressor> compressor(tjInitCompress());
  if (compressor == nullptr) throw SystemError("libjpeg-turbo: not enough memory");
  std::vector<std::uint8_t> flattened;
  if (image.has_alpha) flattened = on_black(image);
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
