// Pieces that the readers of transforms share.
#pragma once

#include "volumes/io/bytes/text_header.h"
#include "volumes/io/transform/transform_chain.h"

namespace supple {

/// The whole of a text file. Throws InputError as InputFile, and beyond 1 GiB.
std::string transform_text(const std::string& path);

/// Exactly `count` finite numbers.
std::vector<double> finite_numbers(const HeaderField& field, std::size_t count);

/// A grid from its numbers: whole sizes of 1 to 2^31 - 1, the LPS place of its first point,
/// spacings above 0 and unit vectors of the axes.
Geometry transform_grid(const HeaderField& field, const Vec3d& sizes, const Vec3d& origin_lps_mm,
                        const Vec3d& spacing_mm, const std::array<Vec3d, 3>& direction);

/// One vector per grid point: all components x, then all y and all z, or with `interleaved` the
/// three of a point together.
std::vector<Vec3d> vectors_of(const Geometry& grid, const HeaderField& field, bool interleaved);

}  // namespace supple
