// RGBA images: 8 bits per channel, straight (not premultiplied) alpha, sRGB, row 0 at the top.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace supple {

struct Image {
  int width = 0;
  int height = 0;
  bool has_alpha = true;
  std::vector<std::uint8_t> rgba;  // 4 * (y * width + x); alpha 255 when has_alpha is false

  Image() = default;
  Image(int width_, int height_) : width(width_), height(height_), rgba(4ul * width_ * height_) {}
};

class AtomicFile;

/// Atomic write; `comment` goes into a tEXt chunk (effective configuration). Throws as AtomicFile.
void write_png(const std::string& path, const Image& image, const std::string& comment = "");
/// Writes the file without committing it.
void write_png(const AtomicFile& target, const Image& image, const std::string& comment);
/// Grey, RGB and palette images are expanded. Throws InputError.
Image read_png(const std::string& path);

// A PNG in memory, for who sends it on.

/// The bytes that write_png() writes, at a level of compression from 0 to 9. Throws SystemError.
std::vector<std::uint8_t> png_bytes(const Image& image, int level);

}  // namespace supple
