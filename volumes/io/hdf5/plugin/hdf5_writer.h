// Volumes and warps on their way into an HDF5 file.
#pragma once

#include <memory>
#include <string>

#include "volumes/io/format/dense_writer.h"

namespace supple::hdf5 {

/// Expects perpendicular axes. Throws InputError for a path that can be no output, SystemError.
std::unique_ptr<DenseWriter> create_file(const std::string& path, const DenseImage& image,
                                         const WriteOptions& options);

}  // namespace supple::hdf5
