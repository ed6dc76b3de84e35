// One DICOM image and the planes in it: a slice (CT, MR, PET), or the frames of an enhanced
// multi-frame image with their functional groups (PS3.3, C.7.6.16), or a dose grid (C.8.8.3).
// Cost: about 400 bytes per frame.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "volumes/base/vec.h"
#include "volumes/io/dicom/plugin/dicom_file.h"
#include "volumes/io/format/volume_file.h"

namespace supple {

// How the pixels of a file are stored (PS3.3, C.7.6.3; PS3.5, 8.1), and the values in them.

struct PixelFormat {
  int rows = 0, columns = 0;
  int bits_allocated = 0, bits_stored = 0, high_bit = 0;
  bool is_signed = false;
  bool inverted = false;  // MONOCHROME1: the smallest value is the brightest

  std::int64_t frame_bytes() const { return std::int64_t(rows) * columns * (bits_allocated / 8); }
  ValueType type() const;
};

/// Throws InputError for colour and for all but 8, 16 and 32-bit grey images.
PixelFormat pixel_format(const std::string& path, DcmItem& dataset);

/// Leaves of every value the stored bits, as a number of the allocated width: other bits (overlays)
/// are masked, the sign is extended. `values` holds one frame in native byte order.
void unpack_stored_bits(const PixelFormat& format, void* values);

/// slope * stored + intercept of an inverted image, as a rescale of the stored values.
void invert_rescale(const PixelFormat& format, double& slope, double& intercept);

/// Place of one frame and the meaning of its values. LPS millimetres.
struct ImagePlane {
  std::size_t image = 0;    // among the images of a series
  int frame = 0;            // within the image
  Vec3d position;           // centre of the first pixel
  Vec3d row, column;        // unit vectors of rising column and rising row number
  double column_mm = 1;     // between columns: one step of i
  double row_mm = 1;        // between rows: one step of j
  double thickness_mm = 0;  // distance of slices if recorded, else their thickness; 0 without both
  double slope = 1, intercept = 0;  // of the stored values, inversion included
  /// Numbers that tell planes at one position apart: one per phase_attributes(), then those of
  /// DimensionIndexValues.
  std::vector<double> phase;
};

struct PixelPlace {
  std::int64_t offset = 0;     // of the first value, as DicomFile::pixel_offset; 0 if encapsulated
  bool swapped_words = false;  // the bytes of 16-bit words are exchanged
};

struct DicomImage {
  std::string path;
  std::string series_uid, description, instance_uid, modality;
  E_TransferSyntax syntax = EXS_Unknown;
  std::int64_t data_offset = 0;  // of the dataset in the file
  PixelPlace pixels;
  bool lossy = false;
  bool is_scout = false;  // a localizer, by its ImageType
  PixelFormat format;
  std::vector<ImagePlane> planes;
};

/// The series that a file belongs to, before anything else of it is understood; nothing for a file
/// that holds no image (reports, contours, directories).
struct SeriesMember {
  std::string series_uid, description;
  bool multi_frame = false;
};
std::optional<SeriesMember> series_member(DicomFile& file);

/// `options` may replace the spacing of pixels. Throws InputError for missing or contradictory
/// attributes, for colour, and when the pixels that they claim cannot lie in the file.
DicomImage read_image(DicomFile& file, const ReadOptions& options);

}  // namespace supple
