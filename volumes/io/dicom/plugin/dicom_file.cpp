#include "volumes/io/dicom/plugin/dicom_file.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <dcmtk/dcmdata/dcistrmb.h>
#include <dcmtk/dcmdata/dcmetinf.h>
#include <dcmtk/dcmdata/dcrledrg.h>
#include <dcmtk/dcmjpeg/djdecode.h>
#include <dcmtk/dcmjpls/djdecode.h>
#include <dcmtk/oflog/oflog.h>

#include "volumes/base/error.h"
#include "volumes/io/dicom/dicom.h"
#include "volumes/io/dicom/plugin/inflate_range.h"

namespace supple {

namespace {

constexpr std::size_t kFirstHeaderBytes = 64 * 1024;

/// DCMTK with its log silenced and its decoders registered.
struct Library {
  Library() {
    OFLog::configure(OFLogger::OFF_LOG_LEVEL);
    // Known attributes that passed through a program that did not know them.
    dcmEnableUnknownVRConversion.set(OFTrue);
    DcmRLEDecoderRegistration::registerCodecs();
    DJDecoderRegistration::registerCodecs();
    DJLSDecoderRegistration::registerCodecs();
    has_dictionary = dcmDataDict.isDictionaryLoaded();
  }
  ~Library() {
    DJLSDecoderRegistration::cleanup();
    DJDecoderRegistration::cleanup();
    DcmRLEDecoderRegistration::cleanup();
  }
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;

  bool has_dictionary = false;
};

/// A value that is longer than all bytes there are, and so is never read.
class MissingValue : public DcmInputStreamFactory {
 public:
  DcmInputStream* create() const override { return nullptr; }
  DcmInputStreamFactory* clone() const override { return new MissingValue; }
  DcmInputStreamFactoryType ident() const override { return DFT_DcmInputFileStreamFactory; }
};

/// Bytes in memory. DCMTK allocates what an element's length claims; with a limit it puts off
/// longer ones, which end the parse here.
class BoundedStream : public DcmInputBufferStream {
 public:
  BoundedStream(const char* bytes, std::size_t size) : m_size(size / 2 * 2) {
    setBuffer(bytes, offile_off_t(m_size));
    setEos();
  }
  DcmInputStreamFactory* newFactory() const override { return new MissingValue; }
  Uint32 limit() const { return Uint32(m_size); }

 private:
  std::size_t m_size;
};

[[noreturn]] void fail(const std::string& path, const std::string& field, const std::string& found,
                       const std::string& expected) {
  throw InputError({path, field, found, expected});
}

bool is_read(E_TransferSyntax syntax) {
  switch (syntax) {
    case EXS_LittleEndianImplicit:
    case EXS_LittleEndianExplicit:
    case EXS_BigEndianExplicit:
    case EXS_DeflatedLittleEndianExplicit:
    case EXS_RLELossless:
    case EXS_JPEGProcess1:
    case EXS_JPEGProcess2_4:
    case EXS_JPEGProcess14:
    case EXS_JPEGProcess14SV1:
    case EXS_JPEGLSLossless:
    case EXS_JPEGLSLossy:
    case EXS_JPEG2000LosslessOnly:
    case EXS_JPEG2000:
      return true;
    default:
      return false;
  }
}

/// Refuses bytes whose sequences nest deeper than any image's: DCMTK's parser recurses. Items are
/// found by their tags, closed by their length or by their delimiter.
void check_depth(const std::string& path, const std::string& bytes) {
  constexpr std::uint32_t kUndefined = 0xFFFFFFFF;
  std::vector<std::uint64_t> ends;  // of the open items
  const auto byte = [&](std::size_t n) { return std::uint32_t(std::uint8_t(bytes[n])); };
  for (std::size_t n = 0; n + 8 <= bytes.size(); n += 2) {
    const bool little = byte(n) == 0xFE && byte(n + 1) == 0xFF && byte(n + 3) == 0xE0;
    const bool big = byte(n) == 0xFF && byte(n + 1) == 0xFE && byte(n + 2) == 0xE0;
    if (!little && !big) continue;
    const std::uint32_t element = little ? byte(n + 2) : byte(n + 3);
    while (!ends.empty() && ends.back() <= n) ends.pop_back();
    if (element == 0x0D && !ends.empty()) ends.pop_back();
    if (element != 0x00) continue;
    std::uint32_t length = 0;
    for (std::size_t b = 0; b < 4; ++b) length |= byte(n + 4 + (little ? b : 3 - b)) << (8 * b);
    ends.push_back(length == kUndefined ? ~std::uint64_t(0) : std::uint64_t(n) + 8 + length);
    if (ends.size() > std::size_t(kMaxDepth)) {
      fail(path, "DICOM sequences", "more than " + std::to_string(kMaxDepth) + " in one another",
           "an image");
    }
  }
}

/// The meta information in `head`, which begins at byte `offset` of the file: transfer syntax and
/// where the dataset starts.
void read_meta(DicomFile& result, const std::string& head, std::size_t offset) {
  const std::string& path = result.file->path();
  BoundedStream stream(head.data() + offset, head.size() - offset);
  DcmMetaInfo meta;
  meta.transferInit();
  const OFCondition condition = meta.read(stream, EXS_Unknown, EGL_noChange, stream.limit());
  if (condition.bad()) fail(path, "DICOM meta information", condition.text(), "an intact file");
  result.data_offset = std::int64_t(offset) + stream.tell();
  result.syntax_uid = text_of(meta, DCM_TransferSyntaxUID);
  result.syntax = DcmXfer(result.syntax_uid.c_str()).getXfer();
}

/// Reads the start. Files that begin with their data set have the syntax of its first elements.
void read_start(DicomFile& result, const std::string& head) {
  constexpr std::size_t kPrefixBytes = 4;
  switch (dicom_start(head)) {
    case DicomStart::none:
      fail(result.file->path(), "format", "no \"DICM\" at byte 128", "a DICOM file");
    case DicomStart::implicit_little:
      result.syntax = EXS_LittleEndianImplicit;
      break;
    case DicomStart::explicit_little:
      result.syntax = EXS_LittleEndianExplicit;
      break;
    case DicomStart::explicit_big:
      result.syntax = EXS_BigEndianExplicit;
      break;
    case DicomStart::prefix:
      return read_meta(result, head, kPrefixBytes);
    default:
      return read_meta(result, head, 0);
  }
  result.syntax_uid = DcmXfer(result.syntax).getXferID();
}

/// Parses as much of the dataset as `bytes` hold; true when the parser came to the pixels or the
/// bytes are all there is.
bool parse(DicomFile& result, const std::string& bytes, bool complete) {
  const std::string& path = result.file->path();
  check_depth(path, bytes);
  BoundedStream stream(bytes.data(), bytes.size());
  result.dataset = std::make_unique<DcmDataset>();
  const bool deflated = result.syntax == EXS_DeflatedLittleEndianExplicit;
  result.dataset->transferInit();
  const OFCondition condition =
      result.dataset->readUntilTag(stream, deflated ? EXS_LittleEndianExplicit : result.syntax,
                                   EGL_noChange, stream.limit(), DCM_PixelData);
  result.dataset->transferEnd();
  result.pixel_offset = stream.tell();
  const bool stopped = condition.good() && result.pixel_offset < stream.limit();
  if (stopped || (condition.good() && complete)) return true;
  if (!complete) return false;
  fail(path, "DICOM attributes", condition.text(), "an intact file");
}

void read_dataset(DicomFile& result) {
  const bool deflated = result.syntax == EXS_DeflatedLittleEndianExplicit;
  std::size_t limit = kFirstHeaderBytes;
  for (;; limit *= 8) {
    limit = std::min(limit, kMaxHeaderBytes);
    std::string bytes(limit, '\0');
    if (deflated) {
      bytes = inflate_range(*result.file, result.data_offset, 0, limit);
    } else {
      bytes.resize(result.file->read_at(result.data_offset, bytes.data(), limit));
    }
    if (parse(result, bytes, bytes.size() < limit)) break;
    if (limit == kMaxHeaderBytes) {
      fail(result.file->path(), "DICOM attributes",
           "more than " + std::to_string(kMaxHeaderBytes) + " bytes in front of the pixels",
           "an image");
    }
  }
  if (!deflated) result.pixel_offset += result.data_offset;
}

}  // namespace

void prepare_dcmtk() {
  static const Library library;
  if (!library.has_dictionary) {
    throw SystemError("DCMTK's data dictionary (dicom.dic) cannot be read");
  }
}

DicomFile read_attributes(const std::string& path) {
  prepare_dcmtk();
  DicomFile result;
  result.file = std::make_shared<InputFile>(path);
  const std::string head = result.file->head(kFirstHeaderBytes);
  check_depth(path, head);
  read_start(result, head);
  read_dataset(result);
  return result;
}

void require_syntax(const DicomFile& file) {
  if (is_read(file.syntax)) return;
  std::string found = file.syntax_uid.empty() ? "nothing" : file.syntax_uid;
  if (!file.syntax_uid.empty() && file.syntax != EXS_Unknown) {
    found += std::string(" ") + DcmXfer(file.syntax).getXferName();
  }
  fail(file.file->path(), "TransferSyntaxUID", printable(found),
       "uncompressed, deflated, RLE, JPEG, JPEG-LS or JPEG 2000");
}

std::string text_of(DcmItem& item, const DcmTagKey& tag) {
  OFString text;
  if (item.findAndGetOFStringArray(tag, text).bad()) return "";
  return trimmed(std::string(text.c_str(), text.size()));
}

HeaderField field_of(const std::string& path, DcmItem& item, const DcmTagKey& tag) {
  return {path, name_of(tag), text_of(item, tag)};
}

std::vector<double> numbers_of(const HeaderField& field, std::size_t count) {
  HeaderField parts = field;
  std::replace(parts.text.begin(), parts.text.end(), '\\', ' ');
  const std::string expected =
      count == 1 ? "a number" : std::to_string(count) + " numbers separated by \\";
  if (parts.text.empty()) field.fail(expected);
  const std::vector<double> numbers = parts.numbers();
  const bool finite = std::all_of(numbers.begin(), numbers.end(),
                                  [](double number) { return std::isfinite(number); });
  if (numbers.size() != count || !finite) field.fail(expected);
  return numbers;
}

std::string name_of(const DcmTagKey& tag) {
  DcmTag named(tag);
  return named.getTagName();
}

}  // namespace supple
