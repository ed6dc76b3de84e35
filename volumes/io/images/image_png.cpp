// Grey PNG images of 1 to 16 bits as one-slice volumes; 1, 2 and 4 bits are stretched to 8, as PNG
// prescribes. Colour, palettes and alpha are refused rather than mixed into a grey value.
// Cost: the decoded image, once.
#include <array>
#include <csetjmp>
#include <vector>

#include <png.h>

#include "volumes/base/error.h"
#include "volumes/io/bytes/byte_source.h"
#include "volumes/io/format/formats.h"

namespace supple {

namespace {

/// State of libpng while it reads: errors leave by longjmp, with a message left here.
struct PngReader {
  const InputFile& file;
  std::int64_t offset = 0;
  std::array<char, 128> message{};
  png_structp png = nullptr;
  png_infop info = nullptr;

  explicit PngReader(const InputFile& source) : file(source) {
    png = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, on_error, on_warning);
    info = png != nullptr ? png_create_info_struct(png) : nullptr;
    if (info == nullptr) throw SystemError(file.path() + ": libpng cannot allocate its state");
    png_set_read_fn(png, this, on_read);
  }
  ~PngReader() { png_destroy_read_struct(&png, &info, nullptr); }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;

  static void on_error(png_structp png, png_const_charp text) {
    auto* self = static_cast<PngReader*>(png_get_error_ptr(png));
    for (std::size_t n = 0; n + 1 < self->message.size() && text[n] != 0; ++n) {
      self->message[n] = text[n];
    }
    png_longjmp(png, 1);
  }
  static void on_warning(png_structp, png_const_charp) {}
  static void on_read(png_structp png, png_bytep out, std::size_t size) {
    auto* self = static_cast<PngReader*>(png_get_io_ptr(png));
    if (self->file.read_at(self->offset, out, size) < size) png_error(png, "the file ends early");
    self->offset += std::int64_t(size);
  }

  /// Runs `body` with libpng's errors turned into InputError. No object of `body` or below may
  /// need a destructor: the jump skips it.
  template <class Body>
  void guarded(Body&& body) {
    if (setjmp(png_jmpbuf(png)) != 0) {
      throw InputError({file.path(), "PNG", message.data(), "an intact PNG image"});
    }
    body();
  }
};

class PngVolume : public VolumeFile {
 public:
  explicit PngVolume(const std::string& path) : m_file(path), m_reader(m_file) {
    m_reader.guarded([this] { png_read_info(m_reader.png, m_reader.info); });
    const int color = png_get_color_type(m_reader.png, m_reader.info);
    if (color != PNG_COLOR_TYPE_GRAY) {
      const char* name = color == PNG_COLOR_TYPE_PALETTE      ? "a palette"
                         : color == PNG_COLOR_TYPE_GRAY_ALPHA ? "grey with alpha"
                                                              : "colour";
      throw InputError({path, "PNG colour type", name, "grey"});
    }
    const int bits = png_get_bit_depth(m_reader.png, m_reader.info);
    m_header.path = path;
    m_header.format = "png";
    m_header.type = bits == 16 ? ValueType::uint16 : ValueType::uint8;
    m_header.geometry = image_geometry(path, png_get_image_width(m_reader.png, m_reader.info),
                                       png_get_image_height(m_reader.png, m_reader.info));
    check_length(bits);
  }

  void read_slice(void* out) override {
    const Vec3i& dims = m_header.geometry.dims();
    const std::size_t row_bytes = std::size_t(dims.x) * bytes_of(m_header.type);
    std::vector<png_bytep> rows(std::size_t(dims.y));
    for (int j = 0; j < dims.y; ++j) rows[j] = static_cast<png_bytep>(out) + j * row_bytes;
    m_reader.guarded([&] {
      png_set_expand_gray_1_2_4_to_8(m_reader.png);
      png_set_swap(m_reader.png);
      png_set_interlace_handling(m_reader.png);
      png_read_image(m_reader.png, rows.data());
      png_read_end(m_reader.png, nullptr);
    });
  }

 private:
  void check_length(int bits) const {
    constexpr double kMaxDeflateRatio = 1032;
    const double claimed = double(m_header.geometry.voxel_count()) * bits / 8;
    if (claimed <= double(m_file.size()) * kMaxDeflateRatio) return;
    throw InputError({m_header.path, "file length", std::to_string(m_file.size()) + " bytes",
                      "enough for " + std::to_string(std::int64_t(claimed)) + " bytes of pixels"});
  }

  InputFile m_file;
  PngReader m_reader;
};

}  // namespace

std::unique_ptr<VolumeFile> open_png(const std::string& path) {
  return std::make_unique<PngVolume>(path);
}

}  // namespace supple
