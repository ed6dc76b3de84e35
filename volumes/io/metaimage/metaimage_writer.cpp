// MetaImage as ITK reads it. TransformMatrix lists the unit vectors of i, j, k in turn. MetaIO
// inflates gzip as well as zlib streams; without CompressedDataSize it reads garbage behind LOCAL.
#include <array>

#include "volumes/base/text.h"
#include "volumes/io/format/header_writer.h"

namespace supple {

namespace {

// Names in the order of ValueType.
constexpr std::array<const char*, 10> kTypeNames = {
    "MET_CHAR", "MET_UCHAR",     "MET_SHORT",      "MET_USHORT", "MET_INT",
    "MET_UINT", "MET_LONG_LONG", "MET_ULONG_LONG", "MET_FLOAT",  "MET_DOUBLE"};

std::string triple(const Vec3d& v) {
  return exact_text(v.x) + " " + exact_text(v.y) + " " + exact_text(v.z);
}

std::string header_of(const DenseImage& image, const std::string& data_file, bool compress) {
  const Vec3i& dims = image.geometry.dims();
  const auto direction = image.geometry.direction();

  std::string text;
  if (image.components > 1) {
    text += "Comment = supple direction " + image.direction + ", vectors in mm LPS\n";
  }
  text += "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n";
  text += std::string("CompressedData = ") + (compress ? "True" : "False") + "\n";
  if (compress) text += std::string("CompressedDataSize = ") + kStreamSize + "\n";
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
  if (!image.certificate.empty()) text += "SuppleCertificate = " + image.certificate + "\n";
  text += std::string("ElementType = ") + kTypeNames[std::size_t(image.type)] + "\n";
  return text + "ElementDataFile = " + (data_file.empty() ? "LOCAL" : data_file) + "\n";
}

}  // namespace

std::unique_ptr<DenseWriter> create_metaimage(const std::string& path, const std::string& raw_path,
                                              const DenseImage& image,
                                              const WriteOptions& options) {
  require_perpendicular(image, path, "MetaImage");
  const std::string header = header_of(image, file_name_of(raw_path), options.compress);
  return write_after_header(path, raw_path, header, image,
                            options.compress ? StreamCoding::gzip : StreamCoding::plain);
}

}  // namespace supple
