// Dense volumes and warp fields for other programs, one slice at a time, written atomically.
// Design section 7. Cost: one slice of memory; the disk's speed.
#pragma once

#include <string>

#include "volumes/field/dense/resample.h"
#include "volumes/field/dense/warp.h"
#include "volumes/io/format/dense_writer.h"

namespace supple {

/// Scalar volume; the format follows the extension. Values are rounded and clamped for integer
/// types; NaN becomes 0 there. Returns DenseWriter::warnings(). Throws as create_dense.
std::vector<std::string> write_volume(const std::string& path, const Geometry& geometry,
                                      ValueType type, const ScalarSliceSource& slices,
                                      Progress* progress = nullptr,
                                      const WriteOptions& options = {});

/// Records of a warp file beside its vectors.
struct WarpFacts {
  Geometry geometry;
  WarpDirection direction = WarpDirection::resample;
  std::string certificate = {};  // of the inversion, one line of JSON; empty: none
};

/// Vector field in LPS mm, float32. Direction and certificate are recorded in the file. Returns
/// DenseWriter::warnings(). Throws as create_dense.
std::vector<std::string> write_warp(const std::string& path, const WarpFacts& facts,
                                    const VectorSliceSource& slices, Progress* progress = nullptr,
                                    const WriteOptions& options = {});

/// The same of vectors that are 0 but in these bricks, for formats in which such space costs
/// nothing (keeps_bricks()): the file that all their slices would give.
std::vector<std::string> write_warp(const std::string& path, const WarpFacts& facts,
                                    const VectorBricks& vectors_mm, Progress* progress = nullptr,
                                    const WriteOptions& options = {});

}  // namespace supple
