// Finds the series that a path stands for, and its images.
// Cost: the attributes of every DICOM file of the folder are read once, one file at a time.
#pragma once

#include <string>
#include <vector>

#include "volumes/io/dicom/plugin/dicom_image.h"

namespace supple {

struct DicomSeries {
  std::string path;  // as the user gave it
  std::vector<DicomImage> images;
  std::vector<std::string> warnings;
};

/// Throws InputError when a folder holds no image or several series, and as read_image does.
DicomSeries find_series(const std::string& path, const ReadOptions& options);

/// Throws InputError, naming two files and both values, unless all images agree in size, type,
/// pixel spacing and orientation.
void check_alike(const DicomSeries& series);

}  // namespace supple
