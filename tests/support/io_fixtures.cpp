#include "tests/support/io_fixtures.h"

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <gtest/gtest.h>
#include <png.h>
#include <tiffio.h>
#include <unistd.h>
#include <zlib.h>

#include "tests/support/errors.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/warp_file.h"

namespace supple::test {

namespace {

std::string deflate_all(const std::string& bytes, int window_bits) {
  z_stream zlib{};
  if (deflateInit2(&zlib, 6, Z_DEFLATED, window_bits, 8, Z_DEFAULT_STRATEGY) != Z_OK) {
    throw std::runtime_error("deflateInit2");
  }
  std::string out(deflateBound(&zlib, bytes.size()) + 64, '\0');
  std::string in = bytes;
  zlib.next_in = reinterpret_cast<Bytef*>(in.data());
  zlib.avail_in = uInt(in.size());
  zlib.next_out = reinterpret_cast<Bytef*>(out.data());
  zlib.avail_out = uInt(out.size());
  deflate(&zlib, Z_FINISH);
  out.resize(zlib.total_out);
  deflateEnd(&zlib);
  return out;
}

}  // namespace

std::string gzip(const std::string& bytes) {
  return deflate_all(bytes, 15 + 16);
}
std::string zlib_stream(const std::string& bytes) {
  return deflate_all(bytes, 15);
}

std::string nifti_header(const std::vector<int>& dims) {
  std::string header(352, '\0');
  patch(header, 0, std::int32_t(348));
  patch(header, 40, std::int16_t(dims.size()));
  for (std::size_t a = 0; a < dims.size(); ++a) patch(header, 42 + 2 * a, std::int16_t(dims[a]));
  patch(header, 70, std::int16_t(4));   // datatype int16
  patch(header, 72, std::int16_t(16));  // bitpix
  for (std::size_t a = 0; a < 4; ++a) patch(header, 76 + 4 * a, 1.0f);
  patch(header, 108, 352.0f);   // vox_offset
  patch(header, 123, char(2));  // mm
  std::memcpy(header.data() + 344, "n+1", 4);
  return header;
}

void write_png(const std::string& path, int width, int height, int bits, int color_type,
               const std::string& rows, bool interlaced) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_init_io(png, file);
  png_set_IHDR(png, info, png_uint_32(width), png_uint_32(height), bits, color_type,
               interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  const png_color palette[2] = {{0, 0, 0}, {255, 255, 255}};
  if (color_type == PNG_COLOR_TYPE_PALETTE) png_set_PLTE(png, info, palette, 2);
  png_write_info(png, info);
  std::string copy = rows;
  const std::size_t row_bytes = rows.size() / std::size_t(height);
  std::vector<png_bytep> pointers;
  for (int j = 0; j < height; ++j) {
    pointers.push_back(reinterpret_cast<png_bytep>(copy.data()) + std::size_t(j) * row_bytes);
  }
  png_write_image(png, pointers.data());
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &info);
  std::fclose(file);
}

namespace {

void set_optional_tags(TIFF* tiff, const TiffOptions& options) {
  if (options.photometric == PHOTOMETRIC_PALETTE) {
    std::vector<std::uint16_t> ramp(std::size_t(1) << options.bits, 7);
    TIFFSetField(tiff, TIFFTAG_COLORMAP, ramp.data(), ramp.data(), ramp.data());
  }
  if (options.subfile != 0) TIFFSetField(tiff, TIFFTAG_SUBFILETYPE, options.subfile);
  if (!options.description.empty()) {
    TIFFSetField(tiff, TIFFTAG_IMAGEDESCRIPTION, options.description.c_str());
  }
  if (options.x_resolution != 0) TIFFSetField(tiff, TIFFTAG_XRESOLUTION, options.x_resolution);
  if (options.y_resolution != 0) TIFFSetField(tiff, TIFFTAG_YRESOLUTION, options.y_resolution);
  if (options.resolution_unit != 0) {
    TIFFSetField(tiff, TIFFTAG_RESOLUTIONUNIT, options.resolution_unit);
  }
}

}  // namespace

void write_tiff(const std::string& path, int width, int height, const TiffOptions& options,
                const std::string& rows) {
  TIFF* tiff = TIFFOpen(path.c_str(), options.mode);
  TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, width);
  TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, height);
  TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, options.bits);
  TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, options.samples);
  TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, options.sample_format);
  TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, options.photometric);
  TIFFSetField(tiff, TIFFTAG_COMPRESSION, options.compression);
  TIFFSetField(tiff, TIFFTAG_PLANARCONFIG,
               options.planar ? PLANARCONFIG_SEPARATE : PLANARCONFIG_CONTIG);
  set_optional_tags(tiff, options);
  std::string copy = rows;
  const int planes = options.planar ? options.samples : 1;
  const std::size_t pixel = std::size_t(options.bits) / 8 * options.samples / planes;
  const std::size_t row_bytes = pixel * width;
  if (options.tile == 0) {
    TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, 3);
    for (int j = 0; j < height * planes; ++j) {
      TIFFWriteScanline(tiff, copy.data() + j * row_bytes, std::uint32_t(j % height),
                        std::uint16_t(j / height));
    }
    TIFFClose(tiff);
    return;
  }
  TIFFSetField(tiff, TIFFTAG_TILEWIDTH, options.tile);
  TIFFSetField(tiff, TIFFTAG_TILELENGTH, options.tile);
  for (int j0 = 0; j0 < height; j0 += options.tile) {
    for (int i0 = 0; i0 < width; i0 += options.tile) {
      std::string tile(pixel * options.tile * options.tile, '\0');
      for (int j = 0; j < std::min(options.tile, height - j0); ++j) {
        const std::size_t run = pixel * std::min(options.tile, width - i0);
        std::memcpy(tile.data() + j * pixel * options.tile,
                    rows.data() + (j0 + j) * row_bytes + i0 * pixel, run);
      }
      TIFFWriteTile(tiff, tile.data(), std::uint32_t(i0), std::uint32_t(j0), 0, 0);
    }
  }
  TIFFClose(tiff);
}

ReadOptions choice(std::optional<int> frame, std::optional<int> channel) {
  ReadOptions options;
  options.frame = frame;
  options.channel = channel;
  return options;
}

std::string read_all(VolumeFile& file) {
  const Vec3i& dims = file.header().geometry.dims();
  const std::size_t slice =
      std::size_t(dims.x) * dims.y * file.header().components * bytes_of(file.header().type);
  std::string bytes(slice * dims.z, '\0');
  for (int k = 0; k < dims.z; ++k) file.read_slice(bytes.data() + slice * k);
  return bytes;
}

std::string read_all(const std::string& path) {
  return read_all(*open_volume(path));
}

std::string failure_of(const std::string& path, const ReadOptions& options) {
  return input_error([&] { read_all(*open_volume(path, options)); });
}

std::string failure_of_warp(const std::string& path) {
  return input_error([&] { read_warp(path); });
}

void expect_failure(const std::string& path, const std::vector<std::string>& parts,
                    const ReadOptions& options) {
  const std::string line = failure_of(path, options);
  EXPECT_EQ(line.find('\n'), std::string::npos) << line;
  EXPECT_LT(line.size(), 400u) << line;
  expect_parts(path, line, parts);
}

void expect_parts(const std::string& path, const std::string& line,
                  const std::vector<std::string>& parts) {
  EXPECT_NE(line, "") << path << " was read";
  for (const std::string& part : parts) {
    EXPECT_NE(line.find(part), std::string::npos) << "\"" << part << "\" in: " << line;
  }
}

}  // namespace supple::test
