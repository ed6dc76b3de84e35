// Opens a volume file of any supported format and streams it slab by slab, so that memory holds
// the active voxels and a few slices, never the box.
#pragma once

#include <cstdint>
#include <memory>
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

/// What a header claims, checked against the file's length before anything is allocated.
struct VolumeHeader {
  std::string path;    // as the user gave it
  std::string format;  // "nrrd", "metaimage", "nifti", "png", "tiff", "raw", "vdb"
  Geometry geometry;
  ValueType type = ValueType::uint8;
  double slope = 1;  // value = slope * stored + intercept
  double intercept = 0;
  int components = 1;          // values per voxel: 1, or 3 in a file of vectors
  std::string warp_direction;  // of vectors, where the header records it as write_warp does
};

/// Bytes of all values, before compression.
std::int64_t stored_bytes(const VolumeHeader& header);

/// A file being read front to back.
class VolumeFile {
 public:
  virtual ~VolumeFile() = default;
  const VolumeHeader& header() const { return m_header; }
  /// Reads the next slice k: dims.x * dims.y stored values in native byte order, times the
  /// components, which lie together.
  /// Throws InputError when the data end early or cannot be decoded.
  virtual void read_slice(void* out) = 0;

 protected:
  VolumeHeader m_header;
};

/// Chooses the format by the file's content first and its extension second.
/// `raw_spec` (of `--raw dims=X,Y,Z,type=int16,spacing=A,B,C[,endian=big][,offset=BYTES]`) makes
/// the file headerless raw; empty otherwise.
/// Throws InputError: missing, folder, empty, unknown format, bad header, wrong length, vectors
/// instead of scalars (read_warp of warp_file.h takes those).
std::unique_ptr<VolumeFile> open_volume(const std::string& path, const std::string& raw_spec = "");

/// What `supple info` prints beyond the header.
struct VolumeDigest {
  VolumeStatistics statistics;
  std::string sha256;             // of the stored values, little-endian, i fastest, before slope
  std::int64_t sparse_bytes = 0;  // of load_volume's grid, counted without building it
};
VolumeDigest digest_volume(VolumeFile& file, Progress* progress = nullptr);

/// Every voxel above the file's minimum becomes active; background is the minimum. NaN, infinity
/// and what overflows a float are void (statistics.nan_count). Comparisons are those of floats.
Volume load_volume(const std::string& path, const std::string& raw_spec = "",
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
ElementVolume load_elements(const std::string& path, const std::string& raw_spec, double lo,
                            double hi, int components, int rings = 2, Progress* progress = nullptr);
ElementVolume load_elements(VolumeFile& file, double lo, double hi, int components, int rings = 2,
                            Progress* progress = nullptr);

}  // namespace supple
