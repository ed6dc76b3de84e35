// Headers of dense images for other programs: what is common, and one function per format.
#pragma once

#include <string>

#include "volumes/geometry/geometry.h"
#include "volumes/io/volume_file.h"

namespace supple {

/// Raw little-endian values, components fastest, then i, j, k.
struct DenseImage {
  Geometry geometry;
  ValueType type = ValueType::float32;
  int components = 1;     // 1: scalars; 3: vectors in mm LPS
  std::string direction;  // of vectors: "resample" or "material"
  std::string data_file;  // name beside the header; empty: the values follow the header
};

/// NRRD0004, always in LPS: a RAS space flips geometry but not vectors in ITK. Any affine.
std::string nrrd_header(const DenseImage& image);

/// MetaImage. Throws InputError, naming `path`, for axes that are not perpendicular.
std::string metaimage_header(const DenseImage& image, const std::string& path);

/// The shortest decimal number that reads back to the same bits.
std::string exact_decimal(double value);

}  // namespace supple
