// TIFF files as volumes: one page or several per slice, as tiff_metadata.h finds. MinIsWhite
// becomes slope -1 over the stored values, so that the brighter pixel has the larger density.
// Channels in pages of their own come out as components of a voxel. ImageJ stacks beyond 4 GB,
// one directory before a run of values, are read without libtiff.
// Cost: see tiff_pages.h; with channels in pages of their own one more page.
#include <algorithm>
#include <array>
#include <cstring>

#include "volumes/base/error.h"
#include "volumes/io/bytes/text_header.h"
#include "volumes/io/format/formats.h"
#include "volumes/io/tiff/tiff_directories.h"
#include "volumes/io/tiff/tiff_metadata.h"

namespace supple {

namespace {

constexpr int kMinIsWhite = 0, kPalette = 3;

class TiffVolume : public VolumeFile {
 public:
  TiffVolume(const std::string& path, const ReadOptions& options)
      : m_pages(path), m_layout(tiff_layout(m_pages)) {
    const TiffPage& page = m_pages.format();
    m_header.path = path;
    m_header.format = "tiff";
    m_header.type = page.type;
    m_header.warnings = m_layout.warnings;
    m_header.geometry = geometry();
    const std::int64_t components = page.samples * m_layout.channels;
    m_header.components = int(components);
    m_frame = chosen_frame(options, m_layout.frames, path, "frames");
    if (m_layout.is_run) m_swap = is_big_endian_tiff(m_pages.file());
    parse_photometric();
    m_header.intercept = m_layout.slope * m_header.intercept + m_layout.intercept;
    m_header.slope *= m_layout.slope;
    // Samples of a pixel are colours; so are bytes (open_volume).
    constexpr int kRgb = 2;
    m_header.are_vectors = page.photometric < kRgb;
  }

  void read_slice(void* out) override {
    if (m_slice >= m_layout.slices) {
      throw Error(m_header.path + ": more slices were asked for than the volume has");
    }
    const std::int64_t k = m_slice++;
    if (m_layout.channels == 1) return read_page(m_layout.page_of(k, 0, m_frame), out);
    const std::size_t channels = std::size_t(m_layout.channels);
    const std::size_t width = std::size_t(bytes_of(m_header.type)) * m_pages.format().samples;
    m_page.resize(std::size_t(m_pages.format().bytes()));
    for (std::size_t c = 0; c < channels; ++c) {
      read_page(m_layout.page_of(k, std::int64_t(c), m_frame), m_page.data());
      char* to = static_cast<char*>(out) + c * width;
      for (std::size_t n = 0; n < m_page.size(); n += width, to += channels * width) {
        std::memcpy(to, m_page.data() + n, width);
      }
    }
  }

  void skip_slices(int count) override { m_slice += count; }

 private:
  Geometry geometry() const {
    const TiffPage& page = m_pages.format();
    const std::string text = std::to_string(page.width) + " " + std::to_string(page.height) + " " +
                             std::to_string(m_layout.slices);
    const Vec3i dims =
        dims_from({m_header.path, "image size", text}, {page.width, page.height, m_layout.slices});
    const Vec3d& s = m_layout.spacing_mm;
    std::array<Vec3d, 3> axes = {Vec3d(s.x, 0, 0), {0, s.y, 0}, {0, 0, s.z}};
    Vec3d origin(0, 0, 0);
    if (m_layout.affine) {
      const std::vector<double>& m = *m_layout.affine;
      for (std::size_t a = 0; a < 3; ++a) axes[a] = {m[3 * a], m[3 * a + 1], m[3 * a + 2]};
      origin = {m[9], m[10], m[11]};
    }
    return make_geometry(m_header.path, dims, origin, axes);
  }

  void parse_photometric() {
    const int photometric = m_pages.format().photometric;
    if (photometric == kPalette && !m_layout.palette_is_display) {
      throw InputError(
          {m_header.path, "PhotometricInterpretation", "3 (palette)", "0 or 1 (grey) or 2 (RGB)"});
    }
    if (photometric != kMinIsWhite) return;
    const bool is_unsigned = std::strncmp(numpy_name(m_header.type), "uint", 4) == 0;
    if (!is_unsigned) {
      throw InputError({m_header.path, "PhotometricInterpretation",
                        std::string("MinIsWhite for ") + numpy_name(m_header.type),
                        "MinIsBlack, or unsigned values"});
    }
    m_header.slope = -1;
    m_header.intercept = double(~std::uint64_t(0) >> (64 - 8 * bytes_of(m_header.type)));
  }

  void read_page(std::int64_t page, void* out) {
    if (!m_layout.is_run) return m_pages.read(std::size_t(page), out);
    const auto bytes = std::size_t(m_pages.format().bytes());
    const std::int64_t offset = *m_pages.first_byte() + page * m_pages.format().bytes();
    if (m_pages.file().read_at(offset, out, bytes) < bytes) {
      throw InputError(
          {m_header.path, "file length", "the file ends early", "all images of ImageDescription"});
    }
    const auto width = std::size_t(bytes_of(m_header.type));
    if (!m_swap || width == 1) return;
    auto* text = static_cast<char*>(out);
    for (std::size_t n = 0; n < bytes; n += width) std::reverse(text + n, text + n + width);
  }

  TiffPages m_pages;
  TiffLayout m_layout;
  std::int64_t m_frame = 0;
  std::int64_t m_slice = 0;
  bool m_swap = false;
  std::vector<char> m_page;  // of one channel
};

}  // namespace

std::unique_ptr<VolumeFile> open_tiff(const std::string& path, const ReadOptions& options) {
  return std::make_unique<TiffVolume>(path, options);
}

}  // namespace supple
