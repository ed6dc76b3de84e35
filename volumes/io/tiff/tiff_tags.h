// Directories of TIFF and BigTIFF as bytes, little-endian.
// Source: TIFF 6.0, section 2; BigTIFF (libtiff.gitlab.io/libtiff/specification/bigtiff.html).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace supple {

/// The tags that are written, with their numbers.
enum TiffTag : std::uint16_t {
  image_width = 256,
  image_length = 257,
  bits_per_sample = 258,
  compression = 259,
  photometric = 262,
  image_description = 270,
  strip_offsets = 273,
  samples_per_pixel = 277,
  rows_per_strip = 278,
  strip_byte_counts = 279,
  x_resolution = 282,
  y_resolution = 283,
  resolution_unit = 296,
  predictor = 317,
  sample_format = 339
};
enum TiffType : std::uint16_t {
  tiff_ascii = 2,
  tiff_short = 3,
  tiff_long = 4,
  tiff_rational = 5,
  tiff_long8 = 16
};

/// One directory, with the values that do not fit into its entries behind it.
class TiffDirectory {
 public:
  explicit TiffDirectory(bool is_big) : m_is_big(is_big) {}

  /// Tags must come in ascending order. A rational takes two values.
  void add(TiffTag tag, TiffType type, const std::vector<std::uint64_t>& values);
  void add(TiffTag tag, const std::string& text);

  /// The directory's bytes for `place` of the file, a multiple of 8, as is their number. The next
  /// directory follows right behind unless this is the last one.
  std::string bytes_at(std::uint64_t place, bool is_last) const;

 private:
  struct Field {
    TiffTag tag;
    TiffType type;
    std::uint64_t count;
    std::string bytes;
  };
  bool m_is_big;
  std::vector<Field> m_fields;
};

/// Pixels per mm as numerator and denominator: the continued fraction of the spacing as far as 32
/// bits go, which is the very fraction of short decimal numbers.
std::vector<std::uint64_t> tiff_resolution(double spacing_mm);

}  // namespace supple
