// MetaImage headers as ITK reads them. TransformMatrix lists the unit vectors of i, j, k in turn.
#include <array>
#include <charconv>

#include "volumes/base/error.h"
#include "volumes/io/dense_header.h"

namespace supple {

namespace {

// In the order of ValueType.
constexpr std::array<const char*, 10> kTypeNames = {
    "MET_CHAR", "MET_UCHAR",     "MET_SHORT",      "MET_USHORT", "MET_INT",
    "MET_UINT", "MET_LONG_LONG", "MET_ULONG_LONG", "MET_FLOAT",  "MET_DOUBLE"};

std::string triple(const Vec3d& v) {
  return exact_decimal(v.x) + " " + exact_decimal(v.y) + " " + exact_decimal(v.z);
}

}  // namespace

std::string metaimage_header(const DenseImage& image, const std::string& path) {
  if (!image.geometry.is_orthogonal()) {
    throw InputError(
        {path, "geometry", "sheared axes", "perpendicular axes in MetaImage (NRRD keeps shear)"});
  }
  const Vec3i& dims = image.geometry.dims();
  const auto direction = image.geometry.direction();

  std::string text;
  if (image.components > 1) {
    text += "Comment = supple direction " + image.direction + ", vectors in mm LPS\n";
  }
  text += "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n";
  text += "CompressedData = False\n";
  text += "TransformMatrix = " + triple(direction[0]) + " " + triple(direction[1]) + " " +
          triple(direction[2]) + "\n";
  text += "Offset = " + triple(image.geometry.origin_lps_mm()) + "\n";
  text += "CenterOfRotation = 0 0 0\n";
  text += "ElementSpacing = " + triple(image.geometry.spacing_mm()) + "\n";
  text += "DimSize = " + std::to_string(dims.x) + " " + std::to_string(dims.y) + " " +
          std::to_string(dims.z) + "\n";
  if (image.components > 1) {
    text += "ElementNumberOfChannels = " + std::to_string(image.components) + "\n";
  }
  text += std::string("ElementType = ") + kTypeNames[std::size_t(image.type)] + "\n";
  return text + "ElementDataFile = " + (image.data_file.empty() ? "LOCAL" : image.data_file) + "\n";
}

std::string exact_decimal(double value) {
  char digits[32];
  const auto end = std::to_chars(digits, digits + sizeof digits, value).ptr;
  return {digits, end};
}

}  // namespace supple
