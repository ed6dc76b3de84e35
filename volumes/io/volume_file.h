// Opens a volume file of any supported format and streams it slab by slab, so that memory holds
// the active voxels and a few slices, never the box.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "volumes/base/progress.h"
#include "volumes/grid/volume.h"

namespace supple {

/// Element types of files; names as numpy's.
enum class ValueType { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };
const char* numpy_name(ValueType type);
/// False when `name` is none of numpy's names in ValueType.
bool find_numpy_type(const std::string& name, ValueType& type);
int bytes_of(ValueType type);

/// What the user says where a file leaves a choice or says nothing.
struct ReadOptions {
  /// dims=X,Y,Z,type=int16,spacing=A,B,C[,endian=big][,offset=BYTES] makes the file headerless raw.
  std::string raw = {};
  std::optional<int> frame = {};    // of a time series, from 0
  std::optional<int> channel = {};  // of several values per voxel, from 0
  /// Spacing of i, j, k in place of the file's; directions and the origin stay.
  std::optional<Vec3d> spacing_mm = {};
};

/// What a header claims, checked against the file's length before anything is allocated.
struct VolumeHeader {
  std::string path;    // as the user gave it
  std::string format;  // "nrrd", "metaimage", "nifti", "png", "tiff", "hdf5", "vdb", "dicom", "raw"
  Geometry geometry;
  ValueType type = ValueType::uint8;
  double slope = 1;  // value = slope * stored + intercept
  double intercept = 0;
  int components = 1;           // values per voxel; 3 in a file of vectors
  bool are_vectors = true;      // three components are; false where they are said to be colours
  std::string warp_direction;   // of vectors, where the header records it as write_warp does
  std::string certificate;      // of the inversion that gave the vectors, one line of JSON
  bool vectors_in_ras = false;  // x and y of the vectors point right and anterior
  /// What the user should know of a file that can be read: each a line without the file's name.
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
  /// for what is no length.
  void set_spacing(const Vec3d& spacing_mm);
  /// Reads the next slice k: dims.x * dims.y stored values in native byte order, times the
  /// components, which lie together.
  /// Throws InputError when the data end early or cannot be decoded.
  virtual void read_slice(void* out) = 0;

 protected:
  VolumeHeader m_header;
};

/// Chooses the format by the file's content first and its extension second.
/// Throws InputError: missing, empty, unknown format, bad header, wrong length, an option that does
/// not fit the file, several frames or channels of which none was chosen, vectors instead of
/// scalars (read_warp of warp_file.h takes those).
std::unique_ptr<VolumeFile> open_volume(const std::string& path, const ReadOptions& options = {});

/// What `supple info` prints beyond the header.
struct VolumeDigest {
  VolumeStatistics statistics;
  std::string sha256;             // of the stored values, little-endian, i fastest, before slope
  std::int64_t sparse_bytes = 0;  // of load_volume's grid, counted without building it
};
VolumeDigest digest_volume(VolumeFile& file, Progress* progress = nullptr);

/// Every voxel above the file's minimum becomes active; background is the minimum. NaN, infinity
/// and what overflows a float are void (statistics.nan_count). Comparisons are those of floats.
Volume load_volume(const std::string& path, const ReadOptions& options = {},
                   Progress* progress = nullptr);
/// The same from an open file of which no slice was read yet.
Volume load_volume(VolumeFile& file, Progress* progress = nullptr);

/// Densities within [lo, hi] become elements; `rings` further voxels around them (Chebyshev, inside
/// the box, not NaN; 0 to 8) are kept as the shell of design "The air". Background is the file's
/// minimum.
struct ElementVolume {
  Volume volume;           // active: elements and shell
  BrickTopology elements;  // active: elements
};
/// `components` > 0 keeps that many largest face-connected pieces of the elements; 0 keeps all.
/// Throws InputError when no voxel lies in the range.
ElementVolume load_elements(const std::string& path, const ReadOptions& options, double lo,
                            double hi, int components, int rings = 2, Progress* progress = nullptr);
ElementVolume load_elements(VolumeFile& file, double lo, double hi, int components, int rings = 2,
                            Progress* progress = nullptr);

}  // namespace supple
