#include "raycast/pictures/image.h"

#include <cerrno>
#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>

#include <png.h>

#include "volumes/base/atomic_file.h"
#include "volumes/base/error.h"
#include "volumes/base/files.h"

namespace supple {

namespace {

constexpr std::uint64_t kMaxPixels = std::uint64_t(1) << 28;

struct FileCloser {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using PngFile = std::unique_ptr<std::FILE, FileCloser>;

/// libpng reports through this struct and a long jump; no C++ object lives across the jump.
struct PngFailure {
  char message[256] = "";
  int errno_value = 0;
};

void on_error(png_structp png, png_const_charp message) {
  auto* failure = static_cast<PngFailure*>(png_get_error_ptr(png));
  std::snprintf(failure->message, sizeof failure->message, "%s", message);
  failure->errno_value = errno;
  longjmp(png_jmpbuf(png), 1);
}
void on_warning(png_structp, png_const_charp) {}

struct PngWriter {
  png_structp png = nullptr;
  png_infop info = nullptr;
  PngFailure failure;
  PngWriter()
      : png(png_create_write_struct(PNG_LIBPNG_VER_STRING, &failure, on_error, on_warning)),
        info(png != nullptr ? png_create_info_struct(png) : nullptr) {
    if (info == nullptr) throw SystemError("libpng: out of memory");
  }
  ~PngWriter() { png_destroy_write_struct(&png, &info); }
  PngWriter(const PngWriter&) = delete;
  PngWriter& operator=(const PngWriter&) = delete;
};

struct PictureReader {
  png_structp png = nullptr;
  png_infop info = nullptr;
  PngFailure failure;
  PictureReader()
      : png(png_create_read_struct(PNG_LIBPNG_VER_STRING, &failure, on_error, on_warning)),
        info(png != nullptr ? png_create_info_struct(png) : nullptr) {
    if (info == nullptr) throw SystemError("libpng: out of memory");
  }
  ~PictureReader() { png_destroy_read_struct(&png, &info, nullptr); }
  PictureReader(const PictureReader&) = delete;
  PictureReader& operator=(const PictureReader&) = delete;
};

/// RGBA of 8 or 16 bits (in the machine's byte order).
struct Raster {
  int width, height, bits;
  bool has_alpha;
  const void* rgba;
};

bool encode(PngWriter& writer, std::FILE* file, const Raster& image, png_textp text,
            png_bytepp rows) {
  if (setjmp(png_jmpbuf(writer.png)) != 0) return false;
  png_init_io(writer.png, file);
  png_set_IHDR(writer.png, writer.info, png_uint_32(image.width), png_uint_32(image.height),
               image.bits, image.has_alpha ? PNG_COLOR_TYPE_RGB_ALPHA : PNG_COLOR_TYPE_RGB,
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB(writer.png, writer.info, PNG_sRGB_INTENT_PERCEPTUAL);
  if (text != nullptr) png_set_text(writer.png, writer.info, text, 1);
  png_write_info(writer.png, writer.info);
  if (!image.has_alpha) png_set_filler(writer.png, 0, PNG_FILLER_AFTER);
  if (image.bits == 16) png_set_swap(writer.png);  // files are big-endian
  png_write_image(writer.png, rows);
  png_write_end(writer.png, nullptr);
  return true;
}

/// Reads the header and asks for 8-bit RGBA, whatever is stored.
bool decode_header(PictureReader& reader, std::FILE* file, bool& has_alpha) {
  if (setjmp(png_jmpbuf(reader.png)) != 0) return false;
  png_init_io(reader.png, file);
  png_read_info(reader.png, reader.info);
  const int colour = png_get_color_type(reader.png, reader.info);
  const bool keyed = png_get_valid(reader.png, reader.info, PNG_INFO_tRNS) != 0;
  has_alpha = keyed || (colour & PNG_COLOR_MASK_ALPHA) != 0;
  png_set_expand(reader.png);
  png_set_scale_16(reader.png);
  if ((colour & PNG_COLOR_MASK_COLOR) == 0) png_set_gray_to_rgb(reader.png);
  if (!has_alpha) png_set_add_alpha(reader.png, 0xff, PNG_FILLER_AFTER);
  png_set_interlace_handling(reader.png);
  png_read_update_info(reader.png, reader.info);
  return true;
}

bool decode_rows(PictureReader& reader, png_bytepp rows) {
  if (setjmp(png_jmpbuf(reader.png)) != 0) return false;
  png_read_image(reader.png, rows);
  png_read_end(reader.png, nullptr);
  return true;
}

std::vector<png_bytep> row_pointers(std::uint8_t* rgba, std::size_t row_bytes, int height) {
  std::vector<png_bytep> rows(height);
  for (int y = 0; y < height; ++y) rows[y] = rgba + row_bytes * y;
  return rows;
}

/// libpng takes non-const rows but does not change them.
std::vector<png_bytep> rows_of(const Raster& image) {
  return row_pointers(static_cast<std::uint8_t*>(const_cast<void*>(image.rgba)),
                      std::size_t(image.width) * image.bits / 2, image.height);
}

void write_raster(const AtomicFile& target, const Raster& image, const std::string& comment) {
  const std::string& path = target.final_path();
  if (image.width < 1 || image.height < 1) {
    throw InputError({path, "image",
                      std::to_string(image.width) + "x" + std::to_string(image.height) + " pixels",
                      "at least one pixel"});
  }
  PngFile file(std::fopen(target.path().c_str(), "wb"));
  if (!file) throw SystemError(path + ": cannot write: " + std::strerror(errno));

  std::vector<png_bytep> rows = rows_of(image);
  char key[] = "Comment";
  png_text text{};
  text.compression = PNG_TEXT_COMPRESSION_NONE;
  text.key = key;
  text.text = const_cast<char*>(comment.c_str());
  text.text_length = comment.size();

  PngWriter writer;
  if (!encode(writer, file.get(), image, comment.empty() ? nullptr : &text, rows.data())) {
    throw SystemError(path + ": cannot write: " + std::strerror(writer.failure.errno_value));
  }
  if (std::fclose(file.release()) != 0) {
    throw SystemError(path + ": cannot write: " + std::strerror(errno));
  }
}

}  // namespace

void write_png(const AtomicFile& target, const Image& image, const std::string& comment) {
  write_raster(target, {image.width, image.height, 8, image.has_alpha, image.rgba.data()}, comment);
}

std::vector<std::uint8_t> png_bytes(const Image& image, int level) {
  char* data = nullptr;
  std::size_t size = 0;
  PngFile file(open_memstream(&data, &size));
  if (!file) throw SystemError("PNG: not enough memory");
  const Raster raster{image.width, image.height, 8, image.has_alpha, image.rgba.data()};
  std::vector<png_bytep> rows = rows_of(raster);
  PngWriter writer;
  png_set_compression_level(writer.png, level);
  const bool is_encoded = encode(writer, file.get(), raster, nullptr, rows.data());
  const bool is_whole = std::fclose(file.release()) == 0;
  const std::unique_ptr<char, void (*)(void*)> owner(data, std::free);
  if (!is_encoded || !is_whole) throw SystemError("PNG: not enough memory");
  return {data, data + size};
}

void write_png(const std::string& path, const Image& image, const std::string& comment) {
  AtomicFile target(path);
  write_png(target, image, comment);
  target.commit();
}

void write_png16(const AtomicFile& target, const FloatImage& picture, const std::string& comment) {
  const std::vector<std::uint16_t> rgba = to_16_bit(picture);
  write_raster(target, {picture.width, picture.height, 16, picture.has_alpha, rgba.data()},
               comment);
}

Image read_png(const std::string& path) {
  require_regular_file(path);
  PngFile file(std::fopen(path.c_str(), "rb"));
  if (!file) throw_open_error(path, errno);
  unsigned char signature[8];
  errno = 0;
  if (std::fread(signature, 1, 8, file.get()) != 8 || png_sig_cmp(signature, 0, 8) != 0) {
    if (errno != 0) throw_open_error(path, errno);
    throw InputError({path, "image", "something else", "a PNG file"});
  }
  std::rewind(file.get());

  PictureReader reader;
  Image image;
  if (!decode_header(reader, file.get(), image.has_alpha)) {
    throw InputError({path, "PNG header", reader.failure.message, "a valid PNG file"});
  }
  const std::uint64_t width = png_get_image_width(reader.png, reader.info);
  const std::uint64_t height = png_get_image_height(reader.png, reader.info);
  if (width * height > kMaxPixels) {
    throw InputError({path, "size", std::to_string(width) + "x" + std::to_string(height),
                      "at most 2^28 pixels"});
  }
  image.width = int(width);
  image.height = int(height);
  image.rgba.resize(4 * width * height);
  std::vector<png_bytep> rows = row_pointers(image.rgba.data(), 4 * width, image.height);
  if (!decode_rows(reader, rows.data())) {
    throw InputError({path, "PNG data", reader.failure.message, "complete image data"});
  }
  return image;
}

}  // namespace supple
