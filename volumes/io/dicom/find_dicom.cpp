// Tells DICOM files by their content: "DICM" behind a preamble of 128 bytes (PS3.10, 7.1), or the
// first elements of a data set where a file lacks the preamble, as dcmdump and GDCM read it.
#include <algorithm>
#include <cctype>
#include <filesystem>

#include "volumes/base/error.h"
#include "volumes/io/bytes/byte_source.h"
#include "volumes/io/dicom/dicom.h"

namespace supple {

namespace {

constexpr std::size_t kPreamble = 128;
constexpr const char* kPrefix = "DICM";
/// Elements at the start of an image's data set are short.
constexpr std::uint32_t kLongestFirst = 1024;

/// Tags and lengths of the first elements, one after the other.
class ElementHeads {
 public:
  ElementHeads(const std::string& head, bool is_big) : m_head(head), m_is_big(is_big) {}

  bool is_data_set() {
    const std::uint32_t group = number(0, 2), element = number(2, 2);
    if (!(group == 2 && element == 0) && !(group == 8 && element <= 0x18)) return false;
    m_is_explicit = std::isupper(byte(4)) != 0 && std::isupper(byte(5)) != 0;
    return take() && take();
  }
  bool is_explicit() const { return m_is_explicit; }

 private:
  unsigned char byte(std::size_t at) const { return static_cast<unsigned char>(m_head[at]); }
  std::uint32_t number(std::size_t at, std::size_t width) const {
    std::uint32_t value = 0;
    for (std::size_t b = 0; b < width; ++b) {
      value = value << 8 | byte(at + (m_is_big ? b : width - 1 - b));
    }
    return value;
  }

  /// The next element, with a higher tag than the one before it.
  bool take() {
    if (m_at + 8 > m_head.size()) return false;
    const std::uint32_t tag = number(m_at, 2) << 16 | number(m_at + 2, 2);
    if (tag <= m_last || tag >> 16 > 0x10) return false;
    m_last = tag;
    const std::uint32_t length = m_is_explicit ? number(m_at + 6, 2) : number(m_at + 4, 4);
    if (m_is_explicit && (std::isupper(byte(m_at + 4)) == 0 || std::isupper(byte(m_at + 5)) == 0)) {
      return false;
    }
    m_at += 8 + length;
    return length % 2 == 0 && length <= kLongestFirst;
  }

  const std::string& m_head;
  bool m_is_big, m_is_explicit = false;
  std::size_t m_at = 0;
  std::uint32_t m_last = 0;
};

}  // namespace

DicomStart dicom_start(const std::string& head) {
  if (head.size() < kPreamble + 4) return DicomStart::none;
  if (head.compare(kPreamble, 4, kPrefix) == 0) return DicomStart::preamble;
  if (head.compare(0, 4, kPrefix) == 0) return DicomStart::prefix;
  for (const bool is_big : {false, true}) {
    ElementHeads elements(head, is_big);
    if (!elements.is_data_set()) continue;
    if (head[is_big ? 1 : 0] == 2) return DicomStart::meta;
    if (!elements.is_explicit()) return is_big ? DicomStart::none : DicomStart::implicit_little;
    return is_big ? DicomStart::explicit_big : DicomStart::explicit_little;
  }
  return DicomStart::none;
}

bool is_dicom(const std::string& head) {
  return dicom_start(head) != DicomStart::none;
}

bool is_gzipped_dicom(const InputFile& file) {
  return is_gzip(file.head(kDicomHead)) && is_dicom(gzip_head(file, kDicomHead));
}

bool holds_dicom(const std::string& folder) {
  std::error_code error;
  std::filesystem::directory_iterator entry(folder, error);
  for (; !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
    std::error_code unknown;
    // Pipes and devices are not even opened: that alone can block or have effects.
    if (!entry->is_regular_file(unknown)) continue;
    try {
      const InputFile file(entry->path().string());
      if (is_dicom(file.head(kDicomHead)) || is_gzipped_dicom(file)) return true;
    } catch (const Error&) {
      continue;
    }
  }
  return false;
}

}  // namespace supple
