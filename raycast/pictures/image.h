// Pictures in floats, with depths, normals and other channels beside their colours, and in 8 bits.
// RGBA images have 8 bits per channel, straight (not premultiplied) alpha, sRGB, row 0 at the top.
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

// The marcher's result. Colours are composited as they are displayed (sRGB-encoded values, as VTK
// does it); EXR files get linear ones, so that viewers show the same picture.

struct FloatImage {
  int width = 0;
  int height = 0;
  bool has_alpha = true;
  std::vector<float> rgba;  // 4 * (y * width + x); premultiplied sRGB; highlights may pass 1

  /// Values at the sample where the opacity of a ray passes one half, or at its maximum; empty
  /// unless asked for, NaN where there is none.
  std::vector<float> depth_mm;    // from the camera, along its view
  std::vector<float> normal_lps;  // 3 per pixel: unit, towards the viewer
  std::vector<float> offset_mm;   // length of the offset, 0 where tissue is at rest
  std::vector<int> surface;       // index of the surface that is seen; -1: the volume, or nothing

  /// Motion in a film, filled by screen_motion(): pixels to the right and upwards, 2 per pixel.
  std::vector<float> forward_px;   // to the next picture
  std::vector<float> backward_px;  // to the one before
  std::vector<float> id;           // label of the tissue, or number of the mesh; 0: none

  FloatImage() = default;
  FloatImage(int width_, int height_, bool has_auxiliary = false);
  std::size_t pixel_count() const { return std::size_t(width) * height; }
  bool has_auxiliary() const { return !depth_mm.empty(); }
};

/// The sRGB transfer curve, 0…1.
float linear_from_srgb(float encoded);
float srgb_from_linear(float linear);

/// Straight 8 bits; pixels without opacity are black.
Image to_image(const FloatImage& picture);
/// The same in 16 bits, 4 per pixel.
std::vector<std::uint16_t> to_16_bit(const FloatImage& picture);
/// The inverse of to_image where the opacity is not 0; without auxiliary channels.
FloatImage to_float(const Image& image);

/// Writes straight 16 bits; otherwise as write_png(), not committed.
void write_png16(const AtomicFile& target, const FloatImage& picture, const std::string& comment);

/// A matrix that a row vector is multiplied with from the left, row by row.
using RowMatrix = std::array<double, 16>;

/// Attributes of an EXR file, and how it stores its floats.
struct ExrFacts {
  std::string comment = {};            // attribute `comments`
  bool half = false;                   // 16 bits, but for Z and id
  std::vector<RowMatrix> camera = {};  // worldToCamera and worldToNDC, of LPS mm; empty: none
  double frames_per_second = 0;        // 0: none
};

/// Floats, compressed without loss: R, G, B (linear, premultiplied), A unless the picture is
/// opaque, and of the other channels Z, N.X, N.Y, N.Z, offset, forward.u, forward.v, backward.u,
/// backward.v and id; where there is none Z is infinite and the others 0. Not committed. Throws
/// SystemError.
void write_exr(const AtomicFile& target, const FloatImage& picture, const ExrFacts& facts);

/// Pictures from left to right, top edges aligned, transparent (opaque ones: on black) between.
FloatImage side_by_side(const FloatImage& left, const FloatImage& right);

}  // namespace supple
