// NIfTI-1 and NIfTI-2: one file (.nii) or .hdr with .img, each gzipped or not, either byte order.
// libnifti2 knows the header's structs, byte swap and quaternion; its own file reading is left
// out, since it loads whole volumes and prints on stderr.
// Source: nifti1.h and nifti2.h. sform goes before qform, and both before pixdim alone; RAS becomes
// LPS here and nowhere else. Bytes behind the values are legal in NIfTI and are skipped.
#include <cmath>
#include <cstring>
#include <filesystem>

#include <nifti/nifti2_io.h>

#include "volumes/base/error.h"
#include "volumes/io/formats.h"
#include "volumes/io/streamed_volume.h"
#include "volumes/io/text_header.h"

namespace supple {

namespace {

/// Both versions of the header as one: NIfTI-2 has every field at least as wide.
struct NiftiHeader {
  nifti_2_header values{};
  bool big_endian = false;
  bool in_one_file = true;
};

[[noreturn]] void fail(const std::string& path, const char* field, double found,
                       const std::string& expected) {
  std::string text = std::to_string(found);
  if (found == std::floor(found) && std::abs(found) < 1e15)
    text = std::to_string(std::int64_t(found));
  throw InputError({path, field, text, expected});
}

template <class Narrow, class Wide>
void widen(const Narrow& from, Wide& to) {
  for (std::size_t n = 0; n < std::size(from); ++n) to[n] = from[n];
}

/// The fields of NIfTI-1 that are used here, in NIfTI-2's places.
nifti_2_header from_nifti1(const nifti_1_header& old) {
  nifti_2_header header{};
  header.datatype = old.datatype;
  header.bitpix = old.bitpix;
  widen(old.dim, header.dim);
  widen(old.pixdim, header.pixdim);
  // Out of range in int64 stays out of range of every file.
  header.vox_offset =
      std::abs(double(old.vox_offset)) < 1e15 ? std::int64_t(old.vox_offset) : std::int64_t(-1);
  header.scl_slope = old.scl_slope;
  header.scl_inter = old.scl_inter;
  header.qform_code = old.qform_code;
  header.sform_code = old.sform_code;
  header.quatern_b = old.quatern_b;
  header.quatern_c = old.quatern_c;
  header.quatern_d = old.quatern_d;
  header.qoffset_x = old.qoffset_x;
  header.qoffset_y = old.qoffset_y;
  header.qoffset_z = old.qoffset_z;
  widen(old.srow_x, header.srow_x);
  widen(old.srow_y, header.srow_y);
  widen(old.srow_z, header.srow_z);
  header.xyzt_units = old.xyzt_units;
  return header;
}

/// False when the bytes are no NIfTI header.
bool decode(const std::string& head, NiftiHeader& header) {
  constexpr std::int32_t kSize1 = 348, kSize2 = 540;
  if (head.size() < std::size_t(kSize1)) return false;
  std::int32_t size = 0;
  std::memcpy(&size, head.data(), sizeof size);
  const std::int32_t swapped = std::int32_t(__builtin_bswap32(std::uint32_t(size)));
  header.big_endian = swapped == kSize1 || swapped == kSize2;
  if (header.big_endian) size = swapped;

  if (size == kSize1) {
    nifti_1_header old;
    std::memcpy(&old, head.data(), sizeof old);
    if (header.big_endian) nifti_swap_as_nifti1(&old);
    header.in_one_file = std::memcmp(old.magic, "n+1", 4) == 0;
    header.values = from_nifti1(old);
    return header.in_one_file || std::memcmp(old.magic, "ni1", 4) == 0;
  }
  if (size == kSize2 && head.size() >= std::size_t(kSize2)) {
    std::memcpy(&header.values, head.data(), sizeof header.values);
    if (header.big_endian) nifti_swap_as_nifti2(&header.values);
    header.in_one_file = std::memcmp(header.values.magic, "n+2", 4) == 0;
    return header.in_one_file || std::memcmp(header.values.magic, "ni2", 4) == 0;
  }
  return false;
}

std::string head_of(const InputFile& file) {
  constexpr std::size_t kLongest = 540;
  const std::string head = file.head(kLongest);
  return is_gzip(head) ? gzip_head(file, kLongest) : head;
}

ValueType parse_type(const std::string& path, const nifti_2_header& header) {
  ValueType type = ValueType::uint8;
  switch (header.datatype) {
    case DT_INT8:
      type = ValueType::int8;
      break;
    case DT_UINT8:
      type = ValueType::uint8;
      break;
    case DT_INT16:
      type = ValueType::int16;
      break;
    case DT_UINT16:
      type = ValueType::uint16;
      break;
    case DT_INT32:
      type = ValueType::int32;
      break;
    case DT_UINT32:
      type = ValueType::uint32;
      break;
    case DT_INT64:
      type = ValueType::int64;
      break;
    case DT_UINT64:
      type = ValueType::uint64;
      break;
    case DT_FLOAT32:
      type = ValueType::float32;
      break;
    case DT_FLOAT64:
      type = ValueType::float64;
      break;
    default:
      fail(path, "datatype", header.datatype, "a scalar type (2, 4, 8, 16, 64, 256 ... 1280)");
  }
  if (header.bitpix != 8 * bytes_of(type)) {
    fail(path, "bitpix", header.bitpix,
         std::to_string(8 * bytes_of(type)) + " for " + numpy_name(type));
  }
  return type;
}

Vec3i parse_dims(const std::string& path, const nifti_2_header& header) {
  constexpr std::int64_t kMaxDim = 2147483647;
  const std::int64_t count = header.dim[0];
  if (count < 1 || count > 7) fail(path, "dim[0]", double(count), "1 to 7");
  Vec3i dims(1, 1, 1);
  for (int a = 1; a <= int(count); ++a) {
    const std::string field = "dim[" + std::to_string(a) + "]";
    const std::int64_t size = header.dim[a];
    if (size < 1 || size > kMaxDim) fail(path, field.c_str(), double(size), "1 to 2147483647");
    if (a > 3 && size != 1) fail(path, field.c_str(), double(size), "1 (a single scalar volume)");
    if (a <= 3) dims[a - 1] = int(size);
  }
  return dims;
}

double mm_per_unit(const nifti_2_header& header) {
  switch (XYZT_TO_SPACE(header.xyzt_units)) {
    case NIFTI_UNITS_METER:
      return 1000.0;
    case NIFTI_UNITS_MICRON:
      return 0.001;
    default:
      return 1.0;
  }
}

/// Rows of the index-to-RAS affine, in the header's unit.
nifti_dmat44 ras_affine(const std::string& path, const nifti_2_header& header) {
  nifti_dmat44 affine{};
  if (header.sform_code > 0) {
    std::memcpy(affine.m[0], header.srow_x, sizeof affine.m[0]);
    std::memcpy(affine.m[1], header.srow_y, sizeof affine.m[1]);
    std::memcpy(affine.m[2], header.srow_z, sizeof affine.m[2]);
    return affine;
  }
  for (int a = 1; a <= 3; ++a) {
    const bool used = a <= header.dim[0];
    const std::string field = "pixdim[" + std::to_string(a) + "]";
    if (used && !(header.pixdim[a] > 0)) fail(path, field.c_str(), header.pixdim[a], "more than 0");
  }
  const auto step = [&](int a) { return a <= header.dim[0] ? header.pixdim[a] : 1.0; };
  if (header.qform_code > 0) {
    return nifti_quatern_to_dmat44(header.quatern_b, header.quatern_c, header.quatern_d,
                                   header.qoffset_x, header.qoffset_y, header.qoffset_z, step(1),
                                   step(2), step(3), header.pixdim[0] < 0 ? -1.0 : 1.0);
  }
  for (int a = 0; a < 3; ++a) affine.m[a][a] = step(a + 1);
  return affine;
}

Geometry parse_geometry(const std::string& path, const nifti_2_header& header) {
  const Vec3i dims = parse_dims(path, header);
  const nifti_dmat44 affine = ras_affine(path, header);
  const Vec3d lps_from_ras = Vec3d(-1, -1, 1) * mm_per_unit(header);
  const auto column = [&](int c) {
    return Vec3d(affine.m[0][c], affine.m[1][c], affine.m[2][c]) * lps_from_ras +
           Vec3d(0);  // no -0
  };
  return make_geometry(path, dims, column(3), {column(0), column(1), column(2)});
}

/// "scan.img.gz" with `from` ".img" and `to` ".hdr" becomes "scan.hdr.gz" or, where that does not
/// exist, "scan.hdr".
std::string partner(const std::string& path, const std::string& from, const std::string& to) {
  std::string stem = path, suffix;
  if (lower_case(std::filesystem::path(path).extension().string()) == ".gz") {
    suffix = path.substr(path.size() - 3);
    stem.resize(path.size() - 3);
  }
  const std::filesystem::path file(stem);
  if (lower_case(file.extension().string()) != from) return path;
  const std::string plain = stem.substr(0, stem.size() - from.size()) + to;
  for (const std::string& candidate : {plain + suffix, plain, plain + ".gz"}) {
    if (std::filesystem::exists(candidate)) return candidate;
  }
  return plain;
}

}  // namespace

bool is_nifti_head(const std::string& head) {
  NiftiHeader header;
  return decode(head, header);
}

std::unique_ptr<VolumeFile> open_nifti(const std::string& path, const ReadOptions& options) {
  chosen_frame(options, 1, path, "frames");
  const std::string header_path = partner(path, ".img", ".hdr");
  NiftiHeader header;
  const auto header_file = std::make_shared<InputFile>(header_path);
  if (!decode(head_of(*header_file), header)) {
    throw InputError({header_path, "header", "no NIfTI-1 or NIfTI-2 header",
                      "sizeof_hdr 348 or 540 and magic n+1, ni1, n+2 or ni2"});
  }
  StreamLayout layout;
  layout.header.path = path;
  layout.header.format = "nifti";
  layout.header.type = parse_type(header_path, header.values);
  layout.header.geometry = parse_geometry(header_path, header.values);
  layout.big_endian = header.big_endian;
  const double slope = header.values.scl_slope, intercept = header.values.scl_inter;
  if (std::isfinite(slope) && slope != 0) {
    if (!std::isfinite(intercept)) fail(header_path, "scl_inter", intercept, "a finite number");
    layout.header.slope = slope;
    layout.header.intercept = intercept;
  }

  // The values, in this file or in the .img beside it.
  const auto data = header.in_one_file
                        ? header_file
                        : std::make_shared<InputFile>(partner(header_path, ".hdr", ".img"));
  const std::int64_t least = header.in_one_file ? (header.values.magic[0] == 'n' ? 544 : 352) : 0;
  std::int64_t offset = header.values.vox_offset;
  if (offset == 0) offset = least;
  if (offset < least || offset > std::int64_t(1) << 50) {
    fail(header_path, "vox_offset", double(offset), std::to_string(least) + " or more");
  }
  const bool deflated = is_gzip(data->head(2));
  layout.range.compression = deflated ? Compression::deflate : Compression::none;
  (deflated ? layout.range.stream_offset : layout.range.file_offset) = offset;
  layout.range.surplus = Surplus::ignore;
  return open_stream(data, std::move(layout));
}

}  // namespace supple
