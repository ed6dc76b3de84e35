#include "volumes/io/nifti/nifti_extension.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "volumes/io/bytes/text_header.h"

namespace supple {

namespace {

constexpr std::size_t kExtenderBytes = 4;
constexpr std::size_t kHeadBytes = 8;  // esize and ecode, int32 each
constexpr std::size_t kUnit = 16;
constexpr std::int32_t kComment = NIFTI_ECODE_COMMENT;
const std::string kDirection = "supple direction: ", kCertificate = "supple certificate: ";

std::int32_t int32_at(const std::string& bytes, std::size_t at, bool big_endian) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return std::int32_t(big_endian ? __builtin_bswap32(value) : value);
}

void read_comment(std::string text, VolumeHeader& volume) {
  text.erase(text.find_last_not_of('\0') + 1);
  LineReader lines(text);
  std::string line;
  while (lines.next(line)) {
    if (line.compare(0, kDirection.size(), kDirection) == 0) {
      volume.warp_direction = trimmed(line.substr(kDirection.size()));
    } else if (line.compare(0, kCertificate.size(), kCertificate) == 0) {
      volume.certificate = trimmed(line.substr(kCertificate.size()));
    }
  }
}

}  // namespace

void read_nifti_extensions(const InputFile& file, const NiftiHeader& header, VolumeHeader& volume) {
  const std::size_t extender = std::size_t(header.size());
  std::int64_t end = std::numeric_limits<std::int64_t>::max();  // of a header in its own file
  if (header.in_one_file) end = std::max<std::int64_t>(header.values.vox_offset, 0);
  const std::size_t limit = std::size_t(std::min<std::int64_t>(end, kMaxTextHeader));
  const std::string head = nifti_head(file, limit);
  std::size_t at = extender + kExtenderBytes;
  if (head.size() < at || head[extender] == 0) return;

  while (at + kUnit <= head.size()) {
    const std::int64_t size = int32_at(head, at, header.big_endian);
    const std::int64_t next = std::int64_t(at) + size;
    if (next > std::int64_t(head.size()) && next <= end && head.size() == kMaxTextHeader) return;
    if (size < std::int64_t(kHeadBytes) || next > std::int64_t(head.size())) {
      volume.warnings.push_back("damaged header extension at byte " + std::to_string(at) +
                                "; it and those behind it are left out");
      return;
    }
    if (int32_at(head, at + sizeof(std::int32_t), header.big_endian) == kComment) {
      read_comment(head.substr(at + kHeadBytes, std::size_t(size) - kHeadBytes), volume);
    }
    at += std::size_t(size);
  }
}

std::string nifti_extension(const std::string& direction, const std::string& certificate) {
  std::string text;
  if (!direction.empty()) text += kDirection + direction + "\n";
  if (!certificate.empty()) text += kCertificate + certificate + "\n";
  std::string bytes(kExtenderBytes, '\0');
  if (text.empty()) return bytes;

  bytes[0] = 1;
  const std::size_t size = (kHeadBytes + text.size() + kUnit - 1) / kUnit * kUnit;
  const std::int32_t head[2] = {std::int32_t(size), kComment};
  bytes.append(reinterpret_cast<const char*>(head), sizeof head);
  text.resize(size - kHeadBytes, '\0');
  return bytes + text;
}

}  // namespace supple
