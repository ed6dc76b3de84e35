// NRRD headers as of http://teem.sourceforge.net/nrrd/format.html, version 4 (space, kinds).
#include <array>

#include "volumes/io/dense_header.h"

namespace supple {

namespace {

// In the order of ValueType.
constexpr std::array<const char*, 10> kTypeNames = {
    "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "float", "double"};

std::string tuple(const Vec3d& v) {
  return "(" + exact_decimal(v.x) + "," + exact_decimal(v.y) + "," + exact_decimal(v.z) + ")";
}

}  // namespace

std::string nrrd_header(const DenseImage& image) {
  const bool is_vector = image.components > 1;
  const Vec3i& dims = image.geometry.dims();
  const auto& axes = image.geometry.axes_mm();

  std::string text = "NRRD0004\n# written by supple\n";
  text += std::string("type: ") + kTypeNames[std::size_t(image.type)] + "\n";
  text += std::string("dimension: ") + (is_vector ? "4" : "3") + "\n";
  text += "space: left-posterior-superior\n";
  text += "sizes: " + (is_vector ? std::to_string(image.components) + " " : "") +
          std::to_string(dims.x) + " " + std::to_string(dims.y) + " " + std::to_string(dims.z) +
          "\n";
  text += std::string("space directions: ") + (is_vector ? "none " : "") + tuple(axes[0]) + " " +
          tuple(axes[1]) + " " + tuple(axes[2]) + "\n";
  text += std::string("kinds: ") + (is_vector ? "vector " : "") + "domain domain domain\n";
  if (bytes_of(image.type) > 1) text += "endian: little\n";
  text += "encoding: raw\n";
  text += "space origin: " + tuple(image.geometry.origin_lps_mm()) + "\n";
  text += "space units: \"mm\" \"mm\" \"mm\"\n";
  if (is_vector) {
    text += "supple direction:=" + image.direction + "\nsupple vectors:=mm LPS\n";
  }
  if (image.data_file.empty()) return text + "\n";
  return text + "data file: " + image.data_file + "\n";
}

}  // namespace supple
