#include "volumes/io/planar_volume.h"

#include <cstring>

#include "volumes/base/error.h"

namespace supple {

namespace {

std::uint8_t swapped(std::uint8_t value) {
  return value;
}
std::uint16_t swapped(std::uint16_t value) {
  return __builtin_bswap16(value);
}
std::uint32_t swapped(std::uint32_t value) {
  return __builtin_bswap32(value);
}
std::uint64_t swapped(std::uint64_t value) {
  return __builtin_bswap64(value);
}

/// Puts `count` values of a plane at every `stride`-th place of `out`.
template <class Word>
void scatter(const char* plane, std::size_t count, bool swap, std::size_t stride, char* out) {
  for (std::size_t n = 0; n < count; ++n) {
    Word value;
    std::memcpy(&value, plane + n * sizeof value, sizeof value);
    if (swap) value = swapped(value);
    std::memcpy(out + n * stride * sizeof value, &value, sizeof value);
  }
}

using Scatter = void (*)(const char*, std::size_t, bool, std::size_t, char*);

Scatter scatter_of(int width) {
  switch (width) {
    case 1:
      return scatter<std::uint8_t>;
    case 2:
      return scatter<std::uint16_t>;
    case 4:
      return scatter<std::uint32_t>;
    default:
      return scatter<std::uint64_t>;
  }
}

class PlanarVolume : public VolumeFile {
 public:
  PlanarVolume(StreamLayout layout, std::vector<std::unique_ptr<ByteSource>> planes)
      : m_planes(std::move(planes)), m_swap(layout.big_endian) {
    m_header = std::move(layout.header);
  }

  void read_slice(void* out) override {
    const Vec3i& dims = m_header.geometry.dims();
    if (m_slices_read >= dims.z) {
      throw Error(m_header.path + ": more slices were asked for than the volume has");
    }
    const std::size_t voxels = std::size_t(dims.x) * dims.y, width = bytes_of(m_header.type);
    m_plane.resize(voxels * width);
    for (std::size_t c = 0; c < m_planes.size(); ++c) {
      m_planes[c]->read(m_plane.data(), m_plane.size());
      scatter_of(int(width))(m_plane.data(), voxels, m_swap, m_planes.size(),
                             static_cast<char*>(out) + c * width);
    }
    // The last source has seen all bytes: one checksum is enough.
    if (++m_slices_read == dims.z) m_planes.back()->finish();
  }

 private:
  std::vector<std::unique_ptr<ByteSource>> m_planes;
  std::vector<char> m_plane;
  bool m_swap;
  int m_slices_read = 0;
};

}  // namespace

std::unique_ptr<VolumeFile> open_planes(const std::shared_ptr<const InputFile>& data,
                                        StreamLayout layout, std::int64_t stride) {
  const int count = layout.header.components;
  ByteRange range = layout.range;
  range.size = stored_bytes(layout.header) / count;
  range.surplus = Surplus::ignore;  // the next component
  std::int64_t& start =
      range.compression == Compression::deflate ? range.stream_offset : range.file_offset;
  std::vector<std::unique_ptr<ByteSource>> planes;
  for (int c = 0; c < count; ++c) {
    planes.push_back(open_source(data, range));
    start += stride;
  }
  return std::make_unique<PlanarVolume>(std::move(layout), std::move(planes));
}

}  // namespace supple
