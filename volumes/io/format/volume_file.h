// A volume file that is being read, slice by slice: the result of every reader of a format.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "volumes/base/fields.h"
#include "volumes/base/progress.h"
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

/// Choices that a format may offer to a writer (dense_writer.h).
struct WriteOptions {
  bool compress = false;     // NRRD gzip, MetaImage zlib, TIFF deflate, HDF5 deflate
  bool ras_vectors = false;  // NIfTI: intent 1006 with vectors in RAS instead of 1007 in LPS
  /// OpenVDB, a fog for renderers: these densities become 0 and 1, what is beyond is clamped, the
  /// background is 0, and a left-handed grid is stored from its other end.
  std::optional<NumberPair> range = {};
  double scale = 1;   // OpenVDB: units of the scene per mm
  bool half = false;  // OpenVDB: floats of 16 bits
  /// OpenVDB: mm/s of the voxels of a slice, for a grid "v" beside the density, where that is not
  /// 0.
  std::function<void(int k, Vec3f* out)> velocity = {};
};
/// Fields for how values are stored.
Fields fields(WriteOptions& options);
/// Fields for how vectors are stored.
Fields vector_fields(WriteOptions& options);

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

/// Chooses the format by the file's content first and its extension second. Throws InputError:
/// missing, empty, unknown format, bad header, wrong length, an option that does not fit the file,
/// several frames or channels of which none was chosen, vectors instead of scalars (read_warp of
/// warp_file.h takes those). `progress` receives the warnings about a file that can be read.
std::unique_ptr<VolumeFile> open_volume(const std::string& path, const ReadOptions& options = {},
                                        Progress* progress = nullptr);

/// Options for reading a volume that a user names.
Fields fields(ReadOptions& options);

/// Opens the files of open_volume(), and files of vectors when no channel is chosen.
std::unique_ptr<VolumeFile> open_scalars_or_vectors(const std::string& path,
                                                    const ReadOptions& options = {});

/// Every file that the volume is read from.
std::vector<std::string> files_of(const VolumeHeader& header);

}  // namespace supple
