#include "volumes/io/dicom/plugin/jpeg2000_frame.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>

#include <openjpeg.h>

#include "volumes/base/error.h"
#include "volumes/base/text.h"
#include "volumes/io/dicom/plugin/encapsulated_frame.h"

namespace supple {

namespace {

/// The codestream as OpenJPEG reads it.
struct Bytes {
  const std::string& all;
  std::size_t at = 0;

  std::size_t left() const { return all.size() - at; }
};

OPJ_SIZE_T read_bytes(void* out, OPJ_SIZE_T count, void* user) {
  auto& bytes = *static_cast<Bytes*>(user);
  if (bytes.left() == 0) return OPJ_SIZE_T(-1);
  const std::size_t taken = std::min<std::size_t>(count, bytes.left());
  std::memcpy(out, bytes.all.data() + bytes.at, taken);
  bytes.at += taken;
  return taken;
}

OPJ_OFF_T skip_bytes(OPJ_OFF_T count, void* user) {
  auto& bytes = *static_cast<Bytes*>(user);
  if (count < 0 || bytes.left() == 0) return -1;
  const std::size_t taken = std::min(std::size_t(count), bytes.left());
  bytes.at += taken;
  return OPJ_OFF_T(taken);
}

OPJ_BOOL seek_bytes(OPJ_OFF_T offset, void* user) {
  auto& bytes = *static_cast<Bytes*>(user);
  if (offset < 0 || std::size_t(offset) > bytes.all.size()) return OPJ_FALSE;
  bytes.at = std::size_t(offset);
  return OPJ_TRUE;
}

/// Keeps the first message.
void keep_message(const char* message, void* user) {
  auto& kept = *static_cast<std::string*>(user);
  if (kept.empty()) kept = trimmed(message);
}

template <auto destroy>
struct Destroy {
  template <class T>
  void operator()(T* object) const {
    destroy(object);
  }
};
using Codec = std::unique_ptr<opj_codec_t, Destroy<opj_destroy_codec>>;
using Stream = std::unique_ptr<opj_stream_t, Destroy<opj_stream_destroy>>;
using Picture = std::unique_ptr<opj_image_t, Destroy<opj_image_destroy>>;

Stream stream_of(Bytes& bytes) {
  Stream stream(opj_stream_create(65536, OPJ_TRUE));
  if (stream == nullptr) throw std::bad_alloc();
  opj_stream_set_read_function(stream.get(), read_bytes);
  opj_stream_set_skip_function(stream.get(), skip_bytes);
  opj_stream_set_seek_function(stream.get(), seek_bytes);
  opj_stream_set_user_data(stream.get(), &bytes, nullptr);
  opj_stream_set_user_data_length(stream.get(), bytes.all.size());
  return stream;
}

Codec codec_of(std::string& message) {
  Codec codec(opj_create_decompress(OPJ_CODEC_J2K));
  if (codec == nullptr) throw std::bad_alloc();
  opj_set_error_handler(codec.get(), keep_message, &message);
  opj_dparameters_t parameters;
  opj_set_default_decoder_parameters(&parameters);
  opj_setup_decoder(codec.get(), &parameters);
  opj_decoder_set_strict_mode(codec.get(), OPJ_TRUE);
  return codec;
}

std::string sizes_text(std::int64_t columns, std::int64_t rows, int components, int bits) {
  return std::to_string(columns) + " x " + std::to_string(rows) + " values of " +
         with_count(components, "component") + " and " + std::to_string(bits) + " bits";
}

/// The main header of a codestream (T.800, A.5 and A.6), of which the decoder makes tables before
/// it reads any values.
class MainHeader {
 public:
  MainHeader(const DicomImage& image, const std::string& stream)
      : m_image(image), m_stream(stream) {}

  void check() const {
    constexpr std::size_t kSizes = 2, kSizesEnd = 45;
    if (m_stream.size() < kSizesEnd || number(kSizes, 2) != 0xFF51) fail("no sizes");
    check_sizes();
    for (std::size_t at = kSizes; at + 4 <= m_stream.size();) {
      const std::uint32_t marker = number(at, 2), length = number(at + 2, 2);
      if (marker == 0xFF90) return;  // a tile
      if (marker == 0xFF52) check_blocks(at + 9, length >= 12, (number(at + 4, 1) & 1) != 0);
      if (marker == 0xFF53) check_blocks(at + 6, length >= 9, (number(at + 5, 1) & 1) != 0);
      at += 2 + std::max(2u, length);
    }
  }

 private:
  [[noreturn]] void fail(const std::string& found) const {
    throw InputError({m_image.path, "JPEG 2000 stream", found, "one as scanners write it"});
  }
  /// A number of the header; 0 beyond the end.
  std::uint32_t number(std::size_t at, std::size_t width) const {
    return at + width <= m_stream.size() ? number_at(m_stream, at, width, true) : 0;
  }

  void check_sizes() const {
    const PixelFormat& format = m_image.format;
    const std::int64_t columns = std::int64_t(number(8, 4)) - number(16, 4);
    const std::int64_t rows = std::int64_t(number(12, 4)) - number(20, 4);
    const int components = int(number(40, 2)), bits = int(number(42, 1) & 0x7F) + 1;
    if (components != 1 || columns != format.columns || rows != format.rows ||
        bits > format.bits_allocated || number(43, 2) != 0x0101) {
      throw InputError(
          {m_image.path, "JPEG 2000 stream", sizes_text(columns, rows, components, bits),
           sizes_text(format.columns, format.rows, 1, format.bits_stored) + " as its attributes"});
    }
    constexpr double kMaxTiles = 4096;
    const double tiles = (double(columns) / number(24, 4) + 1) * (double(rows) / number(28, 4) + 1);
    if (!(tiles <= kMaxTiles)) fail(number_text(tiles) + " tiles");
  }

  /// Coding parameters from the number of levels on.
  void check_blocks(std::size_t at, bool is_whole, bool has_precincts) const {
    const int levels = int(number(at, 1));
    if (!is_whole || levels > 32) fail("damaged coding parameters");
    double blocks = 0;
    for (int r = 0; r <= levels; ++r) {
      const std::uint32_t precinct = has_precincts ? number(at + 5 + std::size_t(r), 1) : 0xFF;
      const double shrunk = std::pow(2.0, r == 0 ? levels : levels - r + 1);
      const int halved = r == 0 ? 0 : 1;
      const auto along = [&](int pixels, std::uint32_t block, std::uint32_t most) {
        const int exponent = std::min(int(block & 15) + 2, int(most) - halved);
        return std::ceil(pixels / shrunk / std::pow(2.0, exponent));
      };
      blocks += (r == 0 ? 1 : 3) * along(m_image.format.columns, number(at + 1, 1), precinct & 15) *
                along(m_image.format.rows, number(at + 2, 1), precinct >> 4);
    }
    const double pixels = double(m_image.format.columns) * m_image.format.rows;
    if (blocks > std::max(4096.0, pixels / 64)) fail(number_text(blocks) + " blocks");
  }

  const DicomImage& m_image;
  const std::string& m_stream;
};

template <class T>
void copy_values(const opj_image_comp_t& values, std::size_t count, void* out) {
  auto* numbers = static_cast<T*>(out);
  for (std::size_t n = 0; n < count; ++n) numbers[n] = T(values.data[n]);
}

}  // namespace

bool is_jpeg2000(E_TransferSyntax syntax) {
  return syntax == EXS_JPEG2000LosslessOnly || syntax == EXS_JPEG2000;
}

void decode_jpeg2000(const DicomImage& image, int frame, const std::string& codestream, void* out) {
  std::string message;
  const auto fail = [&] {
    throw InputError({image.path, "PixelData of frame " + std::to_string(frame),
                      message.empty() ? "a stream that ends early" : printable(message),
                      "an intact JPEG 2000 stream"});
  };
  MainHeader(image, codestream).check();
  Bytes bytes{codestream};
  const Stream stream = stream_of(bytes);
  const Codec codec = codec_of(message);
  opj_image_t* header = nullptr;
  const bool has_header = opj_read_header(stream.get(), codec.get(), &header) != OPJ_FALSE;
  const Picture picture(header);
  if (!has_header || picture == nullptr || picture->numcomps != 1) fail();
  if (opj_decode(codec.get(), stream.get(), picture.get()) == OPJ_FALSE ||
      opj_end_decompress(codec.get(), stream.get()) == OPJ_FALSE) {
    fail();
  }
  const opj_image_comp_t& values = picture->comps[0];
  const PixelFormat& format = image.format;
  if (values.data == nullptr || values.w != std::uint32_t(format.columns) ||
      values.h != std::uint32_t(format.rows)) {
    fail();
  }
  const std::size_t count = std::size_t(format.columns) * std::size_t(format.rows);
  if (format.bits_allocated == 8) copy_values<std::uint8_t>(values, count, out);
  if (format.bits_allocated == 16) copy_values<std::uint16_t>(values, count, out);
  if (format.bits_allocated == 32) copy_values<std::uint32_t>(values, count, out);
}

}  // namespace supple
