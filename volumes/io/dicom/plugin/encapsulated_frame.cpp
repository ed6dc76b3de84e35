#include "volumes/io/dicom/plugin/encapsulated_frame.h"

#include <algorithm>

#include <dcmtk/dcmdata/dcpixseq.h>
#include <dcmtk/dcmdata/dcpxitem.h>

#include "volumes/base/error.h"

namespace supple {

namespace {

void check_jpeg(const DicomImage& image, const std::string& stream) {
  for (std::size_t at = 2; at + 9 <= stream.size();) {
    const std::uint32_t marker = number_at(stream, at, 2, true);
    if (marker < 0xFF01) return;  // not a segment: the decoder will say what is wrong
    const bool fill = marker == 0xFFFF;
    const bool frame = marker >= 0xFFC0 && marker <= 0xFFCF && marker != 0xFFC4 &&
                       marker != 0xFFC8 && marker != 0xFFCC;
    if (!frame) {
      at += fill ? 1 : 2 + std::max<std::uint32_t>(2, number_at(stream, at + 2, 2, true));
      continue;
    }
    const auto bits = int(number_at(stream, at + 4, 1, true));
    const auto rows = int(number_at(stream, at + 5, 2, true));
    const auto columns = int(number_at(stream, at + 7, 2, true));
    const PixelFormat& format = image.format;
    const bool fits = (bits > 8) == (format.bits_allocated > 8) && columns == format.columns &&
                      (rows == format.rows || rows == 0);
    if (fits) return;
    const auto text = [](int x, int y, int depth) {
      return std::to_string(x) + " x " + std::to_string(y) + " values of " + std::to_string(depth) +
             " bits";
    };
    throw InputError(
        {image.path, "JPEG stream", text(columns, rows, bits),
         text(format.columns, format.rows, format.bits_allocated) + " as its attributes"});
  }
}

/// Fragment `n` of the pixels, behind the offset table; at most `most` bytes of it.
std::string fragment(DcmPixelData& pixels, E_TransferSyntax syntax, unsigned long n,
                     std::size_t most, std::size_t& length) {
  DcmPixelSequence* fragments = nullptr;
  DcmPixelItem* item = nullptr;
  Uint8* bytes = nullptr;
  length = 0;
  if (pixels.getEncapsulatedRepresentation(syntax, nullptr, fragments).bad() ||
      fragments->getItem(item, n + 1).bad() || item->getUint8Array(bytes).bad() ||
      bytes == nullptr) {
    return "";
  }
  length = item->getLength();
  return {reinterpret_cast<const char*>(bytes), std::min(length, most)};
}

unsigned long fragment_count(DcmPixelData& pixels, E_TransferSyntax syntax) {
  DcmPixelSequence* fragments = nullptr;
  if (pixels.getEncapsulatedRepresentation(syntax, nullptr, fragments).bad()) return 0;
  return fragments->card() > 0 ? fragments->card() - 1 : 0;
}

/// The first markers of a codestream (T.800, A.4).
bool begins_jpeg2000(const std::string& bytes) {
  return bytes.rfind("\xff\x4f\xff\x51", 0) == 0;
}

bool is_jpeg(E_TransferSyntax syntax) {
  return syntax == EXS_JPEGProcess1 || syntax == EXS_JPEGProcess2_4 ||
         syntax == EXS_JPEGProcess14 || syntax == EXS_JPEGProcess14SV1;
}

/// The header of an RLE frame: the number of its segments and where each begins.
bool is_rle_header(const std::string& header, std::size_t length) {
  constexpr std::size_t kHeaderBytes = 64;
  if (header.size() < kHeaderBytes) return false;
  const std::uint32_t segments = number_at(header, 0, 4, false);
  if (segments < 1 || segments > 15) return false;
  std::uint32_t last = kHeaderBytes - 1;
  for (std::uint32_t n = 1; n <= segments; ++n) {
    const std::uint32_t begin = number_at(header, 4 * n, 4, false);
    if (begin <= last || begin >= length) return false;
    last = begin;
  }
  return true;
}

}  // namespace

std::uint32_t number_at(const std::string& bytes, std::size_t at, std::size_t width, bool big) {
  std::uint32_t number = 0;
  for (std::size_t b = 0; b < width; ++b) {
    number |= std::uint32_t(std::uint8_t(bytes[at + (big ? width - 1 - b : b)])) << (8 * b);
  }
  return number;
}

void check_first_frame(const DicomImage& image, DcmPixelData& pixels) {
  constexpr std::size_t kMostBytes = 65536;
  std::size_t length = 0;
  if (!is_jpeg(image.syntax)) return;
  check_jpeg(image, fragment(pixels, image.syntax, 0, kMostBytes, length));
}

void check_frame(const DicomImage& image, DcmPixelData& pixels, int frame) {
  if (image.syntax != EXS_RLELossless) return;
  const unsigned long fragments = fragment_count(pixels, image.syntax);
  if (fragments != image.planes.size()) {
    throw InputError({image.path, "PixelData", std::to_string(fragments) + " fragments",
                      std::to_string(image.planes.size()) + ", one for each RLE frame"});
  }
  std::size_t length = 0;
  const std::string header =
      fragment(pixels, image.syntax, static_cast<unsigned long>(frame), 64, length);
  if (is_rle_header(header, length)) return;
  throw InputError({image.path, "PixelData of frame " + std::to_string(frame),
                    "an RLE header whose segments lie nowhere", "intact compressed pixels"});
}

std::string frame_bytes(const DicomImage& image, DcmPixelData& pixels, int frame) {
  constexpr std::size_t kAll = ~std::size_t(0);
  const unsigned long fragments = fragment_count(pixels, image.syntax);
  const bool is_one_each = fragments == image.planes.size();
  std::size_t length = 0;
  std::string bytes;
  unsigned long n = is_one_each ? static_cast<unsigned long>(frame) : 0;
  for (int begun = int(n) - 1; n < fragments && begun <= frame; ++n) {
    const bool begins =
        is_one_each || begins_jpeg2000(fragment(pixels, image.syntax, n, 4, length));
    begun += begins;
    if (begun == frame) bytes += fragment(pixels, image.syntax, n, kAll, length);
  }
  if (!bytes.empty()) return bytes;
  throw InputError({image.path, "PixelData", std::to_string(fragments) + " fragments",
                    "a JPEG 2000 stream of frame " + std::to_string(frame)});
}

}  // namespace supple
