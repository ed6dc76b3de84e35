// Grey TIFF and BigTIFF images (8 to 64-bit integers, 32 and 64-bit floats; strips or tiles) as
// one-slice volumes. MinIsWhite becomes slope -1 over the stored values, so that the brighter
// pixel has the larger density. Cost: the decoded image plus one strip or tile.
#include <algorithm>
#include <cstdio>
#include <cstring>
#include <vector>

#include <tiffio.h>

#include "volumes/base/error.h"
#include "volumes/io/byte_source.h"
#include "volumes/io/formats.h"
#include "volumes/io/text_header.h"

namespace supple {

namespace {

constexpr tmsize_t kMaxSingleAllocation = tmsize_t(1) << 30;

int keep_message(TIFF*, void* user_data, const char*, const char* format, va_list arguments) {
  char text[200];
  std::vsnprintf(text, sizeof text, format, arguments);
  auto* message = static_cast<std::string*>(user_data);
  if (message->empty()) *message = text;
  return 1;
}

int ignore_message(TIFF*, void*, const char*, const char*, va_list) {
  return 1;
}

/// Library errors are kept in `message` instead of being printed.
TIFF* open_quietly(const std::string& path, std::string& message) {
  TIFFOpenOptions* options = TIFFOpenOptionsAlloc();
  TIFFOpenOptionsSetErrorHandlerExtR(options, keep_message, &message);
  TIFFOpenOptionsSetWarningHandlerExtR(options, ignore_message, nullptr);
  TIFFOpenOptionsSetMaxSingleMemAlloc(options, kMaxSingleAllocation);
  // 'm': no memory mapping, so that a file that shrinks meanwhile is an error, not a signal.
  TIFF* tiff = TIFFOpenExt(path.c_str(), "rm", options);
  TIFFOpenOptionsFree(options);
  return tiff;
}

class TiffVolume : public VolumeFile {
 public:
  explicit TiffVolume(const std::string& path) {
    const InputFile file(path);
    m_header.path = path;
    m_header.format = "tiff";
    m_tiff.reset(open_quietly(path, m_message));
    if (!m_tiff) fail_library();
    if (!TIFFLastDirectory(m_tiff.get())) fail("TIFF pages", "several", "one image");
    parse_size();
    parse_type();
    parse_photometric();
    check_length(file.size());
  }

  void read_slice(void* out) override {
    const bool done = TIFFIsTiled(m_tiff.get()) ? read_tiles(static_cast<char*>(out))
                                                : read_strips(static_cast<char*>(out));
    if (!done || !m_message.empty()) fail_library();
  }

 private:
  struct Closer {
    void operator()(TIFF* tiff) const { TIFFClose(tiff); }
  };

  [[noreturn]] void fail(const char* field, const std::string& found, const char* expected) const {
    throw InputError({m_header.path, field, found, expected});
  }
  [[noreturn]] void fail_library() const {
    fail("TIFF", m_message.empty() ? "damaged pixels" : printable(m_message),
         "an intact TIFF image");
  }

  /// A 16-bit tag, or what the format says where it is absent.
  int tag(std::uint32_t name, int fallback) const {
    std::uint16_t value = 0;
    return TIFFGetFieldDefaulted(m_tiff.get(), name, &value) ? value : fallback;
  }

  void parse_size() {
    std::uint32_t width = 0, height = 0;
    TIFFGetField(m_tiff.get(), TIFFTAG_IMAGEWIDTH, &width);
    TIFFGetField(m_tiff.get(), TIFFTAG_IMAGELENGTH, &height);
    m_header.geometry = image_geometry(m_header.path, width, height);
    const int orientation = tag(TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT);
    if (orientation != ORIENTATION_TOPLEFT) {
      fail("Orientation", std::to_string(orientation),
           "1 (rows from the top, columns from the left)");
    }
  }

  void parse_type() {
    const int bits = tag(TIFFTAG_BITSPERSAMPLE, 1);
    const int format = tag(TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_UINT);
    const char* kind = format == SAMPLEFORMAT_UINT     ? "uint"
                       : format == SAMPLEFORMAT_INT    ? "int"
                       : format == SAMPLEFORMAT_IEEEFP ? "float"
                                                       : "unknown format with bits ";
    const std::string name = kind + std::to_string(bits);
    if (!find_numpy_type(name, m_header.type)) {
      fail("BitsPerSample and SampleFormat", name, "8 to 64-bit integers or 32 or 64-bit floats");
    }
    const int samples = tag(TIFFTAG_SAMPLESPERPIXEL, 1);
    if (samples != 1) fail("SamplesPerPixel", std::to_string(samples), "1 (grey)");
  }

  void parse_photometric() {
    const int photometric = tag(TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
    if (photometric == PHOTOMETRIC_MINISBLACK) return;
    if (photometric != PHOTOMETRIC_MINISWHITE) {
      fail("PhotometricInterpretation", std::to_string(photometric), "0 or 1 (grey)");
    }
    const bool is_unsigned = std::strncmp(numpy_name(m_header.type), "uint", 4) == 0;
    if (!is_unsigned) {
      fail("PhotometricInterpretation", std::string("MinIsWhite for ") + numpy_name(m_header.type),
           "MinIsBlack, or unsigned values");
    }
    m_header.slope = -1;
    m_header.intercept = double(~std::uint64_t(0) >> (64 - 8 * bytes_of(m_header.type)));
  }

  void check_length(std::int64_t file_bytes) const {
    // The codecs of TIFF differ; deflate and LZMA reach about 1000:1 and 7000:1.
    const double ratio = tag(TIFFTAG_COMPRESSION, COMPRESSION_NONE) == COMPRESSION_NONE ? 1 : 7000;
    const std::int64_t claimed = m_header.geometry.voxel_count() * bytes_of(m_header.type);
    if (double(claimed) <= double(file_bytes) * ratio) return;
    fail("file length", std::to_string(file_bytes) + " bytes",
         ("enough for " + std::to_string(claimed) + " bytes of pixels").c_str());
  }

  bool read_strips(char* out) {
    const std::size_t total =
        std::size_t(m_header.geometry.voxel_count()) * bytes_of(m_header.type);
    std::size_t done = 0;
    const std::uint32_t strips = TIFFNumberOfStrips(m_tiff.get());
    for (std::uint32_t strip = 0; strip < strips && done < total; ++strip) {
      const tmsize_t got =
          TIFFReadEncodedStrip(m_tiff.get(), strip, out + done, tmsize_t(total - done));
      if (got <= 0) return false;
      done += std::size_t(got);
    }
    return done == total;
  }

  bool read_tiles(char* out) {
    const Vec3i& dims = m_header.geometry.dims();
    const int width = bytes_of(m_header.type);
    std::uint32_t tile_x = 0, tile_y = 0;
    TIFFGetField(m_tiff.get(), TIFFTAG_TILEWIDTH, &tile_x);
    TIFFGetField(m_tiff.get(), TIFFTAG_TILELENGTH, &tile_y);
    const tmsize_t bytes = TIFFTileSize(m_tiff.get());
    if (tile_x == 0 || tile_y == 0 || bytes <= 0 || bytes > kMaxSingleAllocation ||
        std::uint64_t(bytes) < std::uint64_t(tile_x) * tile_y * width) {
      return false;
    }
    std::vector<char> tile(static_cast<std::size_t>(bytes));
    for (std::uint32_t j0 = 0; j0 < std::uint32_t(dims.y); j0 += tile_y) {
      for (std::uint32_t i0 = 0; i0 < std::uint32_t(dims.x); i0 += tile_x) {
        if (TIFFReadTile(m_tiff.get(), tile.data(), i0, j0, 0, 0) < 0) return false;
        const std::size_t run = std::min(tile_x, std::uint32_t(dims.x) - i0) * std::size_t(width);
        const std::uint32_t rows = std::min(tile_y, std::uint32_t(dims.y) - j0);
        for (std::uint32_t j = 0; j < rows; ++j) {
          std::memcpy(out + (std::size_t(j0 + j) * dims.x + i0) * width,
                      tile.data() + std::size_t(j) * tile_x * width, run);
        }
      }
    }
    return true;
  }

  std::string m_message;
  std::unique_ptr<TIFF, Closer> m_tiff;
};

}  // namespace

std::unique_ptr<VolumeFile> open_tiff(const std::string& path, const ReadOptions& options) {
  chosen_frame(options, 1, path, "frames");
  return std::make_unique<TiffVolume>(path);
}

}  // namespace supple
