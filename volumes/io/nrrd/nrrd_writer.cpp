// NRRD as of http://teem.sourceforge.net/nrrd/format.html, version 4 (space, kinds). Always in LPS:
// a RAS space flips geometry but not vectors in ITK. Any affine.
#include <array>

#include "volumes/base/text.h"
#include "volumes/io/format/header_writer.h"

namespace supple {

namespace {

// Names in the order of ValueType.
constexpr std::array<const char*, 10> kTypeNames = {
    "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "float", "double"};

std::string tuple(const Vec3d& v) {
  return "(" + exact_text(v.x) + "," + exact_text(v.y) + "," + exact_text(v.z) + ")";
}

/// Names of labels as in a segmentation of 3D Slicer (nrrd_segments.h).
std::string segments_of(const DenseImage& image) {
  const Vec3i& dims = image.geometry.dims();
  const std::string extent = "0 " + std::to_string(dims.x - 1) + " 0 " +
                             std::to_string(dims.y - 1) + " 0 " + std::to_string(dims.z - 1);
  std::string text;
  for (std::size_t n = 0; n < image.label_names.size(); ++n) {
    const auto& [label, name] = image.label_names[n];
    const std::string key = "Segment" + std::to_string(n) + "_";
    text += key + "ID:=Segment_" + std::to_string(n + 1) + "\n" + key + "Name:=" + name + "\n" +
            key + "LabelValue:=" + std::to_string(label) + "\n" + key + "Layer:=0\n" + key +
            "Extent:=" + extent + "\n";
  }
  if (text.empty()) return text;
  return text + "Segmentation_MasterRepresentation:=Binary labelmap\n";
}

std::string header_of(const DenseImage& image, const std::string& data_file, bool compress) {
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
  text += std::string("encoding: ") + (compress ? "gzip" : "raw") + "\n";
  text += "space origin: " + tuple(image.geometry.origin_lps_mm()) + "\n";
  text += "space units: \"mm\" \"mm\" \"mm\"\n";
  if (is_vector) {
    text += "supple direction:=" + image.direction + "\nsupple vectors:=mm LPS\n";
    // 3D Slicer says it in these words, from 5.9 on.
    const bool moves_points = image.direction == "material";
    text += std::string("displacement field type:=") + (moves_points ? "modeling" : "resampling") +
            "\n";
  }
  text += segments_of(image);
  if (!image.certificate.empty()) text += "supple certificate:=" + image.certificate + "\n";
  if (data_file.empty()) return text + "\n";
  return text + "data file: " + data_file + "\n";
}

}  // namespace

std::unique_ptr<DenseWriter> create_nrrd(const std::string& path, const std::string& raw_path,
                                         const DenseImage& image, const WriteOptions& options) {
  const std::string header = header_of(image, file_name_of(raw_path), options.compress);
  return write_after_header(path, raw_path, header, image,
                            options.compress ? StreamCoding::gzip : StreamCoding::plain);
}

}  // namespace supple
