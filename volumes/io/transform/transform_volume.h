// Transform files as warps.
#pragma once

#include "volumes/io/format/volume_file.h"
#include "volumes/io/transform/transform_chain.h"

namespace supple {

enum class TransformKind { none, itk, elastix };

/// The kind of transform file that begins with these bytes.
TransformKind transform_kind(const std::string& head);

/// The vectors T(x) - x of a transform file, LPS mm, at the points of the grid that it names or
/// else of `grid`. Throws InputError as the readers of transform_chain.h, where there is no
/// grid, and where the file's has more than 2^28 points. Cost: as PointMap per point, on all
/// threads; the parameters and a slice in memory.
std::unique_ptr<VolumeFile> open_transform(const std::string& path, TransformKind kind,
                                           const Geometry* grid = nullptr);

/// The transform of such a file; it needs no grid.
TransformChain read_chain(const std::string& path, TransformKind kind);

/// The vectors of a chain on a grid, as open_transform gives them.
std::unique_ptr<VolumeFile> transform_volume(const std::string& path, const Geometry& grid,
                                             TransformChain chain);

}  // namespace supple
