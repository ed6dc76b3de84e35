// Dense volumes and warps on their way into a file, slice by slice: one writer per format, chosen
// by the extension. All write under temporary names and rename at the end.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "volumes/base/fields.h"
#include "volumes/base/progress.h"
#include "volumes/field/offset_field.h"
#include "volumes/geometry/geometry.h"
#include "volumes/io/format/volume_file.h"

namespace supple {

/// Description of the values, as the file will record it.
struct DenseImage {
  Geometry geometry;
  ValueType type = ValueType::float32;
  double slope = 1;  // value = slope * stored + intercept; only where keeps_scaling() holds
  double intercept = 0;
  int components = 1;       // 1: scalars; 3: vectors in mm LPS, float32
  std::string direction;    // of vectors: "resample" or "material"
  std::string certificate;  // of an inversion, one line of JSON; empty: none
  LabelNames label_names;   // of a segmentation; NRRD keeps them as 3D Slicer does
};

class DenseWriter {
 public:
  virtual ~DenseWriter() = default;
  /// Writes the next slice k: dims.x * dims.y values as in memory, components together.
  virtual void write_slice(const void* values) = 0;
  /// Writes, in place of all slices, these vectors at the voxels of these bricks, and 0 elsewhere.
  /// False where the format is dense; nothing has been written then.
  virtual bool write_bricks(const VectorBricks& vectors) {
    return static_cast<void>(vectors), false;
  }
  /// Does what remains after the last slice and may take long, such as compressing values that had
  /// to be put in order first. Throws Cancelled. commit() does it where the caller has not.
  virtual void complete(Progress* progress) { static_cast<void>(progress); }
  /// Completes the files after the last slice, and gives them their names.
  virtual void commit() = 0;
  /// Properties that the format could not keep, known after commit(): each a line without the
  /// file's name.
  virtual std::vector<std::string> warnings() const { return {}; }
};

/// Throws InputError: unknown extension, a format that cannot hold the image (sheared axes,
/// vectors, an option that it does not have); SystemError.
std::unique_ptr<DenseWriter> create_dense(const std::string& path, const DenseImage& image,
                                          const WriteOptions& options = {});

/// The files that writing to `path` creates or replaces: itself, and for detached headers the
/// `.raw` beside it. Throws InputError for an unknown extension.
std::vector<std::string> output_files(const std::string& path);

/// True when a file holds the bricks that are not uniform alone, so that DenseWriter::write_bricks
/// does what it says.
bool keeps_bricks(const std::string& path);

/// True when the format of `path` records slope and intercept, so that stored values can stay.
bool keeps_scaling(const std::string& path);

// The writers behind create_dense. `raw_path` names the file of the values; empty: behind the
// header.
std::unique_ptr<DenseWriter> create_nrrd(const std::string& path, const std::string& raw_path,
                                         const DenseImage& image, const WriteOptions& options);
std::unique_ptr<DenseWriter> create_metaimage(const std::string& path, const std::string& raw_path,
                                              const DenseImage& image, const WriteOptions& options);
std::unique_ptr<DenseWriter> create_tiff(const std::string& path, const std::string& raw_path,
                                         const DenseImage& image, const WriteOptions& options);
std::unique_ptr<DenseWriter> create_vti(const std::string& path, const std::string& raw_path,
                                        const DenseImage& image, const WriteOptions& options);
std::unique_ptr<DenseWriter> create_vdb(const std::string& path, const std::string& raw_path,
                                        const DenseImage& image, const WriteOptions& options);

std::unique_ptr<DenseWriter> create_nifti(const std::string& path, const std::string& raw_path,
                                          const DenseImage& image, const WriteOptions& options);
std::unique_ptr<DenseWriter> create_hdf5(const std::string& path, const std::string& raw_path,
                                         const DenseImage& image, const WriteOptions& options);

/// Throws InputError for axes that are not perpendicular.
void require_perpendicular(const DenseImage& image, const std::string& path,
                           const std::string& format);

/// "head.raw" of "scans/head.raw".
std::string file_name_of(const std::string& path);

}  // namespace supple
