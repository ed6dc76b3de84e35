#include "volumes/io/nifti/nifti_header.h"

#include <cmath>
#include <cstring>

#include "volumes/base/error.h"
#include "volumes/io/format/formats.h"

namespace supple {

namespace {

constexpr std::int32_t kSize1 = 348, kSize2 = 540;
static_assert(sizeof(nifti_1_header) == kSize1 && sizeof(nifti_2_header) == kSize2);

/// Arrays of the same length, value by value.
template <class From, class To>
void copy_values(const From& from, To& to) {
  static_assert(std::size(From{}) == std::size(To{}));
  using Value = std::remove_reference_t<decltype(to[0])>;
  for (std::size_t n = 0; n < std::size(from); ++n) to[n] = static_cast<Value>(from[n]);
}

/// The fields that are used here, from one version's struct to the other's.
template <class From, class To>
void copy_fields(const From& from, To& to) {
  to.datatype = from.datatype;
  to.bitpix = from.bitpix;
  copy_values(from.dim, to.dim);
  copy_values(from.pixdim, to.pixdim);
  to.intent_code = static_cast<decltype(to.intent_code)>(from.intent_code);
  to.scl_slope = static_cast<decltype(to.scl_slope)>(from.scl_slope);
  to.scl_inter = static_cast<decltype(to.scl_inter)>(from.scl_inter);
  to.qform_code = static_cast<decltype(to.qform_code)>(from.qform_code);
  to.sform_code = static_cast<decltype(to.sform_code)>(from.sform_code);
  to.quatern_b = static_cast<decltype(to.quatern_b)>(from.quatern_b);
  to.quatern_c = static_cast<decltype(to.quatern_c)>(from.quatern_c);
  to.quatern_d = static_cast<decltype(to.quatern_d)>(from.quatern_d);
  to.qoffset_x = static_cast<decltype(to.qoffset_x)>(from.qoffset_x);
  to.qoffset_y = static_cast<decltype(to.qoffset_y)>(from.qoffset_y);
  to.qoffset_z = static_cast<decltype(to.qoffset_z)>(from.qoffset_z);
  copy_values(from.srow_x, to.srow_x);
  copy_values(from.srow_y, to.srow_y);
  copy_values(from.srow_z, to.srow_z);
  to.xyzt_units = static_cast<decltype(to.xyzt_units)>(from.xyzt_units);
  static_assert(sizeof from.descrip == sizeof to.descrip);
  std::memcpy(to.descrip, from.descrip, sizeof to.descrip);
  static_assert(sizeof from.intent_name == sizeof to.intent_name);
  std::memcpy(to.intent_name, from.intent_name, sizeof to.intent_name);
}

nifti_2_header from_nifti1(const nifti_1_header& old) {
  nifti_2_header header{};
  copy_fields(old, header);
  // Out of range in int64 stays out of range of every file.
  header.vox_offset =
      std::abs(double(old.vox_offset)) < 1e15 ? std::int64_t(old.vox_offset) : std::int64_t(-1);
  return header;
}

nifti_1_header to_nifti1(const nifti_2_header& header) {
  nifti_1_header old{};
  copy_fields(header, old);
  old.sizeof_hdr = kSize1;
  old.regular = 'r';
  old.vox_offset = float(header.vox_offset);
  return old;
}

template <class Struct>
std::string bytes_of_struct(const Struct& header) {
  return {reinterpret_cast<const char*>(&header), sizeof header};
}

}  // namespace

bool decode_nifti(const std::string& head, NiftiHeader& header) {
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
    header.version = 1;
    header.in_one_file = std::memcmp(old.magic, "n+1", 4) == 0;
    header.values = from_nifti1(old);
    return header.in_one_file || std::memcmp(old.magic, "ni1", 4) == 0;
  }
  if (size == kSize2 && head.size() >= std::size_t(kSize2)) {
    std::memcpy(&header.values, head.data(), sizeof header.values);
    if (header.big_endian) nifti_swap_as_nifti2(&header.values);
    header.version = 2;
    header.in_one_file = std::memcmp(header.values.magic, "n+2", 4) == 0;
    return header.in_one_file || std::memcmp(header.values.magic, "ni2", 4) == 0;
  }
  return false;
}

std::string encode_nifti(const NiftiHeader& header) {
  if (header.version == 1) {
    nifti_1_header old = to_nifti1(header.values);
    std::memcpy(old.magic, header.in_one_file ? "n+1" : "ni1", 4);
    return bytes_of_struct(old);
  }
  nifti_2_header values = header.values;
  values.sizeof_hdr = kSize2;
  std::memcpy(values.magic, header.in_one_file ? "n+2\0\r\n\032\n" : "ni2\0\r\n\032\n", 8);
  return bytes_of_struct(values);
}

std::string nifti_head(const InputFile& file, std::size_t limit) {
  return is_gzip(file.head(2)) ? gzip_head(file, limit) : file.head(limit);
}

bool is_nifti_head(const std::string& head) {
  NiftiHeader header;
  return decode_nifti(head, header);
}

void fail_nifti(const std::string& path, const std::string& field, double found,
                const std::string& expected) {
  std::string text = std::to_string(found);
  if (found == std::floor(found) && std::abs(found) < 1e15)
    text = std::to_string(std::int64_t(found));
  throw InputError({path, field, text, expected});
}

}  // namespace supple
