#include "volumes/io/streamed_volume.h"

#include <algorithm>

#include "volumes/base/error.h"

namespace supple {

namespace {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "the readers assume a little-endian host");

void swap_bytes(void* values, std::size_t count, int width) {
  auto* bytes = static_cast<unsigned char*>(values);
  for (std::size_t n = 0; n < count; ++n) {
    std::reverse(bytes + n * width, bytes + (n + 1) * width);
  }
}

class StreamedVolume : public VolumeFile {
 public:
  StreamedVolume(StreamLayout layout, std::unique_ptr<ByteSource> source)
      : m_source(std::move(source)), m_swap(layout.big_endian) {
    m_header = std::move(layout.header);
  }

  void read_slice(void* out) override {
    const Vec3i& dims = m_header.geometry.dims();
    if (m_slices_read >= dims.z) {
      throw Error(m_header.path + ": more slices were asked for than the volume has");
    }
    const std::size_t values = std::size_t(dims.x) * dims.y * m_header.components;
    const int width = bytes_of(m_header.type);
    m_source->read(out, values * width);
    if (m_swap && width > 1) swap_bytes(out, values, width);
    if (++m_slices_read == dims.z) m_source->finish();
  }

 private:
  std::unique_ptr<ByteSource> m_source;
  bool m_swap;
  int m_slices_read = 0;
};

}  // namespace

std::unique_ptr<VolumeFile> open_stream(std::shared_ptr<const InputFile> data,
                                        StreamLayout layout) {
  layout.range.size = stored_bytes(layout.header);
  std::unique_ptr<ByteSource> source = open_source(std::move(data), layout.range);
  return std::make_unique<StreamedVolume>(std::move(layout), std::move(source));
}

}  // namespace supple
