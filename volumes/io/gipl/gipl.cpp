// GIPL of the Guy's Image Processing Lab, which ITK-SNAP and ITK write: a header of 256 bytes and
// the values behind it, both big-endian. Sizes, spacing in mm and origin are read as ITK reads
// them, the axes are those of LPS, and the fourth dimension is time. The matrix and pixval_cal mean
// another thing in every program; they are left alone, as in ITK. Source: itkGiplImageIO.cxx (ITK
// 5).
#include <algorithm>
#include <cstring>

#include "volumes/base/error.h"
#include "volumes/base/text.h"
#include "volumes/io/bytes/text_header.h"
#include "volumes/io/format/formats.h"
#include "volumes/io/format/streamed_volume.h"

namespace supple {

namespace {

constexpr std::size_t kHeaderSize = 256;
// Magic numbers of older programs, and of ITK.
constexpr std::uint32_t kMagics[] = {719555000u, 4026526128u};

enum Offset : std::size_t { kDims = 0, kType = 8, kSpacing = 10, kOrigin = 204, kMagic = 252 };

/// A big-endian number of the header.
template <class T>
T number_at(const std::string& head, std::size_t offset) {
  unsigned char bytes[sizeof(T)];
  for (std::size_t n = 0; n < sizeof(T); ++n) {
    bytes[n] = static_cast<unsigned char>(head[offset + sizeof(T) - 1 - n]);
  }
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

ValueType parse_type(const std::string& path, const std::string& head) {
  switch (const int type = number_at<std::uint16_t>(head, kType)) {
    case 7:
      return ValueType::int8;
    case 1:  // binary: a byte per voxel
    case 8:
      return ValueType::uint8;
    case 15:
      return ValueType::int16;
    case 16:
      return ValueType::uint16;
    case 31:
      return ValueType::uint32;
    case 32:
      return ValueType::int32;
    case 64:
      return ValueType::float32;
    case 65:
      return ValueType::float64;
    default:
      throw InputError({path, "image type", std::to_string(type),
                        "a scalar type (1, 7, 8, 15, 16, 31, 32, 64, 65)"});
  }
}

Geometry parse_geometry(const std::string& path, const std::string& head,
                        const ReadOptions& options) {
  Vec3i dims;
  Vec3d spacing, origin;
  for (int a = 0; a < 3; ++a) {
    const std::string axis = "[" + std::to_string(a) + "]";
    dims[a] = number_at<std::uint16_t>(head, kDims + 2 * std::size_t(a));
    if (dims[a] < 1) throw InputError({path, "dim" + axis, "0", "1 to 65535"});
    spacing[a] =
        own_spacing(double(number_at<float>(head, kSpacing + 4 * std::size_t(a))), options);
    if (!(spacing[a] > 0)) {
      throw InputError({path, "pixdim" + axis, exact_text(spacing[a]), "a positive number of mm"});
    }
    origin[a] = number_at<double>(head, kOrigin + 8 * std::size_t(a));
  }
  return make_geometry(path, dims, origin,
                       {Vec3d(spacing.x, 0, 0), {0, spacing.y, 0}, {0, 0, spacing.z}});
}

}  // namespace

bool is_gipl_head(const std::string& head) {
  if (head.size() < kHeaderSize) return false;
  const auto magic = number_at<std::uint32_t>(head, kMagic);
  return std::find(std::begin(kMagics), std::end(kMagics), magic) != std::end(kMagics);
}

std::unique_ptr<VolumeFile> open_gipl(const std::string& path, const ReadOptions& options) {
  const auto file = std::make_shared<InputFile>(path);
  const std::string head = file->head(kHeaderSize);
  if (head.size() < kHeaderSize) {
    throw InputError({path, "file length", std::to_string(head.size()) + " bytes",
                      "a header of " + std::to_string(kHeaderSize) + " bytes"});
  }
  if (!is_gipl_head(head)) {
    throw InputError({path, "magic", "another number", "719555000 or 4026526128 at byte 252"});
  }
  StreamLayout layout;
  layout.header.path = path;
  layout.header.format = "gipl";
  layout.header.geometry = parse_geometry(path, head, options);
  layout.header.type = parse_type(path, head);
  layout.big_endian = true;
  layout.frames = std::max<std::int64_t>(1, number_at<std::uint16_t>(head, kDims + 6));
  layout.frame = chosen_frame(options, layout.frames, path, "dim[3]");
  layout.range.file_offset = std::int64_t(kHeaderSize);
  return open_stream(file, std::move(layout));
}

}  // namespace supple
