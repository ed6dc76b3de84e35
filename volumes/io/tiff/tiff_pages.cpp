#include "volumes/io/tiff/tiff_pages.h"

#include <algorithm>
#include <cstring>

#include <tiffio.h>

#include "volumes/base/error.h"
#include "volumes/io/bytes/text_header.h"
#include "volumes/io/tiff/tiff_directories.h"
#include "volumes/io/tiff/tiff_library.h"

namespace supple {

namespace {

/// No codec can make more than this many bytes of one byte of the file.
double largest_ratio(int compression) {
  switch (compression) {
    case COMPRESSION_NONE:
      return 1;
    case COMPRESSION_PACKBITS:
      return 64;
    case COMPRESSION_ADOBE_DEFLATE:
    case COMPRESSION_DEFLATE:
      return 1032;
    case COMPRESSION_LZW:
      return 4096;
    case COMPRESSION_LZMA:
      return 8192;
    default:
      return 65536;  // Zstandard and LERC say a constant block in a few bytes
  }
}

std::string words_for(const TiffPage& page) {
  return std::to_string(page.width) + " x " + std::to_string(page.height) + " " +
         numpy_name(page.type) +
         (page.samples > 1 ? " with " + std::to_string(page.samples) + " samples" : "") +
         (page.photometric == PHOTOMETRIC_MINISWHITE ? ", MinIsWhite" : "");
}

}  // namespace

std::int64_t TiffPage::bytes() const {
  return width * height * samples * bytes_of(type);
}

void TiffPages::Closer::operator()(tiff* handle) const {
  TIFFClose(handle);
}

TiffPages::TiffPages(const std::string& path) : m_file(path) {
  const std::vector<std::uint64_t> directories = tiff_directories(m_file);
  m_tiff.reset(open_tiff_quietly(path, "r", m_message));
  if (!m_tiff) fail_library("an intact TIFF image");
  for (std::size_t n = 0; n < directories.size(); ++n) {
    select(directories[n]);
    if (is_reduced()) continue;
    if (m_offsets.empty()) {
      parse_first();
    } else {
      check_same(parse_page(), n);
    }
    m_offsets.push_back(directories[n]);
  }
  if (m_offsets.empty()) fail("TIFF pages", "reduced-resolution copies only", "images");
  check_length(count());
}

TiffPages::~TiffPages() = default;

void TiffPages::fail(const std::string& field, const std::string& found,
                     const std::string& expected) const {
  throw InputError({m_file.path(), field, found, expected});
}

void TiffPages::fail_library(const std::string& what) const {
  fail("TIFF", m_message.empty() ? "damaged pixels" : printable(m_message), what);
}

void TiffPages::select(std::uint64_t offset) {
  if (m_selected == offset) return;
  m_message.clear();
  if (TIFFSetSubDirectory(m_tiff.get(), offset) == 0) fail_library("an intact TIFF directory");
  m_selected = offset;
}

/// A 16-bit tag, or what the format says where it is absent.
int TiffPages::tag(std::uint32_t name, int fallback) const {
  std::uint16_t value = 0;
  return TIFFGetFieldDefaulted(m_tiff.get(), name, &value) ? value : fallback;
}

bool TiffPages::is_reduced() const {
  std::uint32_t kind = 0;
  return TIFFGetField(m_tiff.get(), TIFFTAG_SUBFILETYPE, &kind) != 0 &&
         (kind & FILETYPE_REDUCEDIMAGE) != 0;
}

TiffPage TiffPages::parse_page() const {
  TiffPage page;
  std::uint32_t width = 0, height = 0;
  TIFFGetField(m_tiff.get(), TIFFTAG_IMAGEWIDTH, &width);
  TIFFGetField(m_tiff.get(), TIFFTAG_IMAGELENGTH, &height);
  const HeaderField size{m_file.path(), "image size",
                         std::to_string(width) + " " + std::to_string(height)};
  const Vec3i dims = dims_from(size, {width, height});
  page.width = dims.x;
  page.height = dims.y;
  const int orientation = tag(TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT);
  if (orientation != ORIENTATION_TOPLEFT) {
    fail("Orientation", std::to_string(orientation),
         "1 (rows from the top, columns from the left)");
  }
  const int format = tag(TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_UINT);
  const char* kind = format == SAMPLEFORMAT_UINT     ? "uint"
                     : format == SAMPLEFORMAT_INT    ? "int"
                     : format == SAMPLEFORMAT_IEEEFP ? "float"
                                                     : "unknown format with bits ";
  const std::string name = kind + std::to_string(tag(TIFFTAG_BITSPERSAMPLE, 1));
  if (!find_numpy_type(name, page.type)) {
    fail("BitsPerSample and SampleFormat", name, "8 to 64-bit integers or 32 or 64-bit floats");
  }
  page.samples = tag(TIFFTAG_SAMPLESPERPIXEL, 1);
  if (page.samples < 1) fail("SamplesPerPixel", std::to_string(page.samples), "1 or more");
  page.in_planes =
      page.samples > 1 && tag(TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG) == PLANARCONFIG_SEPARATE;
  page.photometric = tag(TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
  if (page.photometric > PHOTOMETRIC_PALETTE) {
    fail("PhotometricInterpretation", std::to_string(page.photometric), "0 or 1 (grey) or 2 (RGB)");
  }
  page.compression = tag(TIFFTAG_COMPRESSION, COMPRESSION_NONE);
  return page;
}

void TiffPages::parse_first() {
  m_format = parse_page();
  check_length(1);
  char* text = nullptr;
  if (TIFFGetField(m_tiff.get(), TIFFTAG_IMAGEDESCRIPTION, &text) != 0 && text != nullptr) {
    m_description = text;
  }
  float x = 0, y = 0;
  if (TIFFGetField(m_tiff.get(), TIFFTAG_XRESOLUTION, &x) != 0) m_resolution.x = x;
  if (TIFFGetField(m_tiff.get(), TIFFTAG_YRESOLUTION, &y) != 0) m_resolution.y = y;
  m_resolution.unit = tag(TIFFTAG_RESOLUTIONUNIT, RESUNIT_INCH);

  if (m_format.compression != COMPRESSION_NONE || m_format.in_planes || TIFFIsTiled(m_tiff.get())) {
    return;
  }
  const std::uint32_t strips = TIFFNumberOfStrips(m_tiff.get());
  const std::uint64_t first = TIFFGetStrileOffset(m_tiff.get(), 0);
  for (std::uint32_t n = 1; n < strips; ++n) {
    const std::uint64_t end =
        TIFFGetStrileOffset(m_tiff.get(), n - 1) + TIFFGetStrileByteCount(m_tiff.get(), n - 1);
    if (TIFFGetStrileOffset(m_tiff.get(), n) != end) return;
  }
  if (first > 0 && first < std::uint64_t(m_file.size())) m_first_byte = std::int64_t(first);
}

void TiffPages::check_same(const TiffPage& page, std::size_t number) const {
  const std::string found = words_for(page), expected = words_for(m_format);
  if (found == expected) return;
  fail("TIFF page " + std::to_string(number + 1), found, expected + " as in the first page");
}

void TiffPages::check_length(std::size_t pages) const {
  // In doubles, since the claims of a damaged page may pass any integer.
  const double claimed = double(m_format.width) * double(m_format.height) * m_format.samples *
                         bytes_of(m_format.type) * double(pages);
  if (claimed <= double(m_file.size()) * largest_ratio(m_format.compression)) return;
  fail("file length", std::to_string(m_file.size()) + " bytes",
       "enough for " + number_text(claimed) + " bytes of pixels");
}

void TiffPages::read(std::size_t page, void* out) {
  select(m_offsets.at(page));
  // The first page alone was kept; another one may be stored in another way.
  const bool in_planes = parse_page().in_planes;
  m_message.clear();
  auto* bytes = static_cast<char*>(out);
  if (in_planes) return read_planes(bytes);
  const bool done = TIFFIsTiled(m_tiff.get()) ? read_tiles(0, bytes) : read_strips(0, bytes);
  if (!done || !m_message.empty()) fail_library("an intact TIFF image");
}

void TiffPages::read_planes(char* out) {
  const std::size_t width = std::size_t(bytes_of(m_format.type));
  const std::size_t samples = std::size_t(m_format.samples);
  m_plane.resize(std::size_t(m_format.bytes()) / samples);
  for (std::size_t s = 0; s < samples; ++s) {
    const bool done = TIFFIsTiled(m_tiff.get()) ? read_tiles(int(s), m_plane.data())
                                                : read_strips(int(s), m_plane.data());
    if (!done || !m_message.empty()) fail_library("an intact TIFF image");
    for (std::size_t n = 0; n < m_plane.size() / width; ++n) {
      std::memcpy(out + (n * samples + s) * width, m_plane.data() + n * width, width);
    }
  }
}

/// A plane holds all samples where they lie together.
bool TiffPages::read_strips(int plane, char* out) {
  const bool in_planes = tag(TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG) == PLANARCONFIG_SEPARATE &&
                         m_format.samples > 1;
  const std::size_t planes = in_planes ? std::size_t(m_format.samples) : 1;
  const std::size_t total = std::size_t(m_format.bytes()) / planes;
  const std::uint32_t strips = TIFFNumberOfStrips(m_tiff.get()) / std::uint32_t(planes);
  std::size_t done = 0;
  for (std::uint32_t strip = 0; strip < strips && done < total; ++strip) {
    const tmsize_t got = TIFFReadEncodedStrip(m_tiff.get(), std::uint32_t(plane) * strips + strip,
                                              out + done, tmsize_t(total - done));
    if (got <= 0) return false;
    done += std::size_t(got);
  }
  return done == total;
}

bool TiffPages::read_tiles(int plane, char* out) {
  const bool in_planes = tag(TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG) == PLANARCONFIG_SEPARATE;
  const std::size_t pixel =
      std::size_t(bytes_of(m_format.type)) * (in_planes ? 1 : std::size_t(m_format.samples));
  const auto width = std::uint32_t(m_format.width), height = std::uint32_t(m_format.height);
  std::uint32_t tile_x = 0, tile_y = 0;
  TIFFGetField(m_tiff.get(), TIFFTAG_TILEWIDTH, &tile_x);
  TIFFGetField(m_tiff.get(), TIFFTAG_TILELENGTH, &tile_y);
  const tmsize_t bytes = TIFFTileSize(m_tiff.get());
  if (tile_x == 0 || tile_y == 0 || bytes <= 0 || bytes > kMaxTiffAllocation ||
      double(bytes) < double(tile_x) * tile_y * double(pixel)) {
    return false;
  }
  m_tile.resize(static_cast<std::size_t>(bytes));
  for (std::uint64_t j0 = 0; j0 < height; j0 += tile_y) {
    for (std::uint64_t i0 = 0; i0 < width; i0 += tile_x) {
      const auto x = std::uint32_t(i0), y = std::uint32_t(j0);
      if (TIFFReadTile(m_tiff.get(), m_tile.data(), x, y, 0, std::uint16_t(plane)) < 0)
        return false;
      const std::size_t run = std::min(tile_x, width - x) * pixel;
      const std::uint32_t rows = std::min(tile_y, height - y);
      for (std::uint32_t j = 0; j < rows; ++j) {
        std::memcpy(out + (std::size_t(y + j) * width + x) * pixel,
                    m_tile.data() + std::size_t(j) * tile_x * pixel, run);
      }
    }
  }
  return true;
}

}  // namespace supple
