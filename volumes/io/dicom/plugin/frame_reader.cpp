#include "volumes/io/dicom/plugin/frame_reader.h"

#include <algorithm>
#include <cstring>

#include "volumes/base/error.h"
#include "volumes/io/dicom/plugin/encapsulated_frame.h"
#include "volumes/io/dicom/plugin/inflate_range.h"
#include "volumes/io/dicom/plugin/jpeg2000_frame.h"

namespace supple {

namespace {

constexpr std::uint32_t kUndefinedLength = 0xFFFFFFFF;

/// Bytes of pixels that one byte of the file can hold at most.
double densest(E_TransferSyntax syntax) {
  switch (syntax) {
    case EXS_DeflatedLittleEndianExplicit:
      return 1032;
    case EXS_RLELossless:
      return 64;  // 128 bytes from 2
    case EXS_JPEGLSLossless:
    case EXS_JPEGLSLossy:
      return 65536;  // runs of 2^15 values per bit, in theory
    case EXS_JPEG2000LosslessOnly:
    case EXS_JPEG2000:
      return 4096;  // headers of empty pictures; the decoder takes 4 bytes per value and as many
                    // more
    default:
      return 7000;  // Huffman codes of a bit per block at best
  }
}

bool is_native(E_TransferSyntax syntax) {
  return syntax == EXS_LittleEndianImplicit || syntax == EXS_LittleEndianExplicit ||
         syntax == EXS_BigEndianExplicit || syntax == EXS_DeflatedLittleEndianExplicit;
}

struct PixelElement {
  std::string representation;  // the VR, empty where it is implicit
  std::uint32_t length = 0;
};

/// The head of the Pixel Data element, which ends at file.pixel_offset.
PixelElement pixel_element(const DicomFile& file) {
  const std::string& path = file.file->path();
  const bool implicit = file.syntax == EXS_LittleEndianImplicit;
  const bool big = file.syntax == EXS_BigEndianExplicit;
  std::string head(implicit ? 8 : 12, '\0');
  const std::int64_t start = file.pixel_offset - std::int64_t(head.size());
  if (file.syntax == EXS_DeflatedLittleEndianExplicit) {
    const std::string bytes = inflate_range(*file.file, file.data_offset, start, head.size());
    head.replace(0, bytes.size(), bytes);
  } else {
    file.file->read_at(start, head.data(), head.size());
  }
  const std::uint32_t group = number_at(head, 0, 2, big), element = number_at(head, 2, 2, big);
  if (group == 0x7FE0 && (element == 0x0008 || element == 0x0009)) {
    throw InputError({path, "PixelData", "floating-point pixels", "integers"});
  }
  if (group != 0x7FE0 || element != 0x0010) {
    throw InputError({path, "PixelData", "nothing", "the pixels of the image"});
  }
  if (implicit) return {"", number_at(head, 4, 4, false)};
  return {head.substr(4, 2), number_at(head, 8, 4, big)};
}

void check_native(const DicomFile& file, const PixelFormat& format, const PixelElement& element,
                  std::int64_t claimed) {
  const std::string& path = file.file->path();
  if (element.length == kUndefinedLength || std::int64_t(element.length) < claimed) {
    throw InputError({path, "PixelData length",
                      element.length == kUndefinedLength
                          ? "undefined"
                          : std::to_string(element.length) + " bytes",
                      std::to_string(claimed) + " bytes"});
  }
  if (file.syntax == EXS_BigEndianExplicit && format.bits_allocated == 32) {
    throw InputError({path, "BitsAllocated", "32 in a big-endian file", "8 or 16 there"});
  }
  if (file.syntax == EXS_DeflatedLittleEndianExplicit) return;
  const std::int64_t present = file.file->size() - file.pixel_offset;
  if (present >= claimed) return;
  throw InputError({path, "PixelData",
                    std::to_string(present) + " bytes before the end of the file",
                    std::to_string(claimed) + " bytes"});
}

}  // namespace

PixelPlace check_pixels(const DicomFile& file, const PixelFormat& format, int frames) {
  const PixelElement element = pixel_element(file);
  // Frames and bytes of a frame fit 31 and 35 bits.
  const double claimed = double(format.frame_bytes()) * frames;
  const bool native = is_native(file.syntax);
  const bool plain = native && file.syntax != EXS_DeflatedLittleEndianExplicit;
  const double capacity = double(file.file->size()) * (plain ? 1 : densest(file.syntax));
  // An encapsulated frame has an item of its own.
  if (claimed > capacity || (!native && 8.0 * frames > double(file.file->size()))) {
    throw InputError({file.file->path(), "file length",
                      std::to_string(file.file->size()) + " bytes",
                      "enough for " + number_text(claimed) + " bytes of pixels"});
  }
  if (!native) return {};
  check_native(file, format, element, std::int64_t(claimed));
  const bool words = format.bits_allocated == 16 || element.representation == "OW";
  return {file.pixel_offset, words && file.syntax == EXS_BigEndianExplicit};
}

void FrameReader::read(const DicomImage& image, int frame, void* out) {
  if (is_native(image.syntax)) {
    read_native(image, frame, static_cast<char*>(out));
  } else {
    read_encapsulated(image, frame, out);
  }
  unpack_stored_bits(image.format, out);
}

void FrameReader::read_native(const DicomImage& image, int frame, char* out) const {
  const InputFile file(image.path);
  const std::int64_t size = image.format.frame_bytes(), start = frame * size;
  // Words can span frames of an odd number of bytes.
  const std::int64_t first = image.pixels.swapped_words ? start / 2 * 2 : start;
  const std::int64_t end = start + size + (image.pixels.swapped_words ? (start + size) % 2 : 0);
  const std::int64_t offset = image.pixels.offset + first;
  std::string bytes(std::size_t(end - first), '\0');
  if (image.syntax == EXS_DeflatedLittleEndianExplicit) {
    bytes = inflate_range(file, image.data_offset, offset, bytes.size());
  } else {
    bytes.resize(file.read_at(offset, bytes.data(), bytes.size()));
  }
  if (std::int64_t(bytes.size()) < end - first) {
    throw InputError({image.path, "PixelData", std::to_string(bytes.size()) + " bytes of a frame",
                      std::to_string(end - first) + " bytes"});
  }
  if (image.pixels.swapped_words) {
    for (std::size_t n = 0; n + 1 < bytes.size(); n += 2) std::swap(bytes[n], bytes[n + 1]);
  }
  std::memcpy(out, bytes.data() + (start - first), std::size_t(size));
}

void FrameReader::open_encapsulated(const DicomImage& image) {
  if (m_path == image.path && m_pixels != nullptr) return;
  m_pixels = nullptr;
  m_cache.clear();
  m_path = image.path;
  m_next_fragment = 0;
  m_next_frame = 0;
  m_file = std::make_unique<DcmFileFormat>();
  // Nothing behind the pixels is parsed; values beyond some kB stay in the file until asked for.
  const OFCondition condition =
      m_file->loadFileUntilTag(image.path.c_str(), EXS_Unknown, EGL_noChange, DCM_MaxReadLength,
                               ERM_fileOnly, DcmTagKey(0x7FE0, 0x0011));
  DcmElement* element = nullptr;
  if (condition.good()) m_file->getDataset()->findAndGetElement(DCM_PixelData, element);
  m_pixels = dynamic_cast<DcmPixelData*>(element);
  if (m_pixels != nullptr) {
    check_first_frame(image, *m_pixels);
    return;
  }
  throw InputError({image.path, "PixelData", condition.good() ? "nothing" : condition.text(),
                    "encapsulated pixels"});
}

void FrameReader::read_encapsulated(const DicomImage& image, int frame, void* out) {
  open_encapsulated(image);
  if (is_jpeg2000(image.syntax)) {
    return decode_jpeg2000(image, frame, frame_bytes(image, *m_pixels, frame), out);
  }
  check_frame(image, *m_pixels, frame);
  const std::int64_t size = image.format.frame_bytes();
  m_buffer.assign(std::size_t(size + size % 2), 0);
  // Frames share no fragment: the next one starts where the last one ended.
  Uint32 fragment = frame == m_next_frame ? m_next_fragment : 0;
  OFString color_model;
  const OFCondition condition =
      m_pixels->getUncompressedFrame(m_file->getDataset(), Uint32(frame), fragment, m_buffer.data(),
                                     Uint32(m_buffer.size()), color_model, &m_cache);
  if (condition.bad()) {
    throw InputError({image.path, "PixelData of frame " + std::to_string(frame), condition.text(),
                      "intact compressed pixels"});
  }
  m_next_fragment = fragment;
  m_next_frame = frame + 1;
  std::memcpy(out, m_buffer.data(), std::size_t(size));
}

}  // namespace supple
