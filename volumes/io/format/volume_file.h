// A volume file that is being read, slice by slice: the result of every reader of a format.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "volumes/base/text.h"
#include "volumes/geometry/geometry.h"
#include "volumes/io/bytes/value_type.h"

namespace supple {

/// Choices of the user where a file leaves one or says nothing.
struct ReadOptions {
  /// dims=X,Y,Z,type=int16,spacing=A,B,C[,endian=big][,offset=BYTES] makes the file headerless raw.
  std::string raw = {};
  std::optional<int> frame = {};  // of a time series, from 0
  /// Given, it takes the number of frames, and the first is read where none is chosen.
  std::int64_t* frames_found = nullptr;
  std::optional<int> channel = {};  // of several values per voxel, from 0
  /// Spacing of i, j, k in place of the file's; directions and the origin stay.
  std::optional<Vec3d> spacing_mm = {};
  /// The grid on which a transform that names none is evaluated.
  const Geometry* grid = nullptr;
};

/// Throws InputError when a choice is made: `path` is a state, which says everything itself.
void require_unused(const ReadOptions& options, const std::string& path);

/// Claims of a header, checked against the file's length before anything is allocated.
struct VolumeHeader {
  std::string path;  // as the user gave it
  /// Files that the volume is read from beside or instead of `path`: of values, of a header, of
  /// slices.
  std::vector<std::string> data_files;
  std::string format;  // "nrrd", "metaimage", "nifti", "png", "tiff", "hdf5", "vdb", "dicom",
                       // "transform", "raw"
  Geometry geometry;
  ValueType type = ValueType::uint8;
  double slope = 1;  // value = slope * stored + intercept
  double intercept = 0;
  int components = 1;           // values per voxel; 3 in a file of vectors
  bool are_vectors = true;      // three components are; false where they are no displacement
  std::string warp_direction;   // of vectors, where the header records it as write_warp does
  std::string certificate;      // of the inversion that gave the vectors, one line of JSON
  bool vectors_in_ras = false;  // x and y of the vectors point right and anterior
  LabelNames label_names;       // of a segmentation that names its labels
  std::vector<std::string> frame_names;  // of a time series that says what its frames are
  std::string modality;  // DICOM's (0008,0060), such as "CT" and "MR"; empty: not said
  /// Warnings about a file that can be read: each a line without the file's name.
  std::vector<std::string> warnings;
};

/// Bytes of all values, before compression.
std::int64_t stored_bytes(const VolumeHeader& header);

/// A file being read front to back.
class VolumeFile {
 public:
  virtual ~VolumeFile() = default;
  const VolumeHeader& header() const { return m_header; }
  /// Puts other voxel sizes in place of the file's; directions and origin stay. Throws InputError
  /// for a spacing that is no length.
  void set_spacing(const Vec3d& spacing_mm);
  /// Reads the next slice k: dims.x * dims.y stored values in native byte order, times the
  /// components, which lie together.
  /// Throws InputError when the data end early or cannot be decoded.
  virtual void read_slice(void* out) = 0;
  /// Leaves out the next slices, unchecked; by arithmetic where values are plain, by reading
  /// otherwise. Throws as read_slice().
  virtual void skip_slices(int count);

 protected:
  VolumeHeader m_header;
};

}  // namespace supple
