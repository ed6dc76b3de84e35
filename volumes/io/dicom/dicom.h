// DICOM series as volumes. Other folders include this header only. Everything that needs DCMTK lies
// in a plugin of its own, which is loaded when a DICOM file is opened; programs that open none
// neither start later nor hold its libraries in memory.
#pragma once

#include <memory>
#include <string>

#include "volumes/io/bytes/input_file.h"
#include "volumes/io/format/volume_file.h"

namespace supple {

/// Bytes that tell if a file is a DICOM file.
constexpr std::size_t kDicomHead = 132;

/// How a DICOM file starts: with a preamble, as it should, or without it, with "DICM", with its
/// meta information, or with its data set, of which nothing but the bytes tells the coding.
enum class DicomStart {
  none,
  preamble,
  prefix,
  meta,
  implicit_little,
  explicit_little,
  explicit_big
};
DicomStart dicom_start(const std::string& head);

/// True when the bytes (kDicomHead or more of them) are the start of a DICOM file.
bool is_dicom(const std::string& head);
/// True for a gzipped DICOM file.
bool is_gzipped_dicom(const InputFile& file);

/// True when a regular file of the folder itself is a DICOM file, gzipped or not; false for a path
/// that is no folder. Files that cannot be opened do not count. Opens files until one is found.
bool holds_dicom(const std::string& folder);

/// The one series of a folder (flat), the series that a file belongs to (in the file's folder), or
/// one multi-frame file. Slices are sorted by position along row x column; options.frame chooses
/// among several at the same positions. Throws InputError for several series, slices of different
/// kinds, uneven distances, and data that cannot be decoded; SystemError when a file may not be
/// read or the plugin cannot be loaded.
std::unique_ptr<VolumeFile> open_dicom(const std::string& path, const ReadOptions& options);

}  // namespace supple
