// Metadata in the tags of a TIFF file: the slice, channel and frame of each page, and the size of
// voxels. Sources: ImageJ's ij.io.TiffDecoder and FileOpener (ImageDescription "ImageJ=...");
// OME-TIFF (docs.openmicroscopy.org/ome-model, 2016-06); TIFF 6.0 for resolutions.
// Cost: an OME description is held as a tree, some ten times its text of at most 64 MiB.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "volumes/geometry/geometry.h"
#include "volumes/io/tiff/tiff_pages.h"

namespace supple {

/// How the pages of a file make volumes.
struct TiffLayout {
  std::int64_t slices = 1;
  std::int64_t channels = 1;  // pages that make one slice together
  std::int64_t frames = 1;
  /// Pages lie this far apart; channels next to each other unless said otherwise.
  std::int64_t slice_stride = 1, channel_stride = 1, frame_stride = 1;
  std::vector<std::size_t> pages;   // where strides do not hold: page of their number
  bool is_run = false;              // the values follow those of the only page, without directories
  bool palette_is_display = false;  // a colour map changes the picture, not the values
  Vec3d spacing_mm{1, 1, 1};
  double slope = 1, intercept = 0;  // of a calibration
  /// Index to LPS in mm, the columns i, j, k and the origin, as supple's own writer notes it.
  std::optional<std::vector<double>> affine;
  std::vector<std::string> warnings;

  /// The page, or the place in the run, of one channel of one slice.
  std::int64_t page_of(std::int64_t slice, std::int64_t channel, std::int64_t frame) const;
};

/// Throws InputError for metadata that are damaged or do not fit the pages.
TiffLayout tiff_layout(const TiffPages& pages);

/// The three kinds of metadata behind tiff_layout.
TiffLayout imagej_layout(const TiffPages& pages);
TiffLayout ome_layout(const TiffPages& pages);
TiffLayout plain_layout(const TiffPages& pages);

/// The key of the affine in ImageDescription; other programs pass over it.
constexpr const char* kTiffAffineKey = "supple_index_to_lps_mm";

}  // namespace supple
