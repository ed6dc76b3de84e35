// The headers of NIfTI-1 and NIfTI-2 as one, for reader and writer: NIfTI-2 has every field at
// least as wide, so that its struct stands for both. libnifti2 knows the structs, the byte swap and
// the quaternion; its own reading and writing of files is left out, since it loads whole volumes
// and prints on stderr.
// Source: nifti1.h and nifti2.h (nifti.nimh.nih.gov). RAS becomes LPS, and LPS RAS, here and
// nowhere else.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nifti/nifti2_io.h>

#include "volumes/geometry/geometry.h"
#include "volumes/io/bytes/byte_source.h"

namespace supple {

struct NiftiHeader {
  nifti_2_header values{};
  int version = 1;
  bool big_endian = false;
  bool in_one_file = true;  // by its magic; else the values are in an .img file

  /// Size of the fixed fields; four bytes of the extender follow.
  std::int64_t size() const { return version == 1 ? 348 : 540; }
};

/// Decodes a header; false when the bytes are no NIfTI header.
bool decode_nifti(const std::string& head, NiftiHeader& header);
/// The fixed fields as a file of our byte order has them: 348 or 540 bytes. NIfTI-1 rounds numbers
/// to 32-bit floats.
std::string encode_nifti(const NiftiHeader& header);

/// The first `limit` bytes of the file, after decompression where it is gzipped.
std::string nifti_head(const InputFile& file, std::size_t limit);

/// Throws InputError that names a field of the header and the number in it.
[[noreturn]] void fail_nifti(const std::string& path, const std::string& field, double found,
                             const std::string& expected);

/// The grid in LPS mm: sform, else qform, else the spacings alone. Where sform and qform are both
/// set and put a corner of the box more than 0.05 voxel apart, `warnings` says so. Throws
/// InputError for numbers that give no grid.
Geometry nifti_geometry(const std::string& path, nifti_2_header header, const Vec3i& dims,
                        const ReadOptions& options, std::vector<std::string>& warnings);

/// Sets dim[1..3], pixdim, sform, qform and the unit mm. The qform's code is set only where its
/// quaternion, rounded to 32-bit floats, keeps every corner of the box within 0.01 voxel: sheared
/// axes have none, nor have some turns of nearly 180 degrees, whose first component is lost in the
/// rounding. The sform holds any affine; rounded to floats it moves no coordinate by more than
/// 2^-24 of the sum of |origin| and the box's extents along that coordinate (6e-5 mm in 1 m).
void set_nifti_geometry(const Geometry& geometry, nifti_2_header& header);

}  // namespace supple
