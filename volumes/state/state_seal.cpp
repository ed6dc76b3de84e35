#include "volumes/state/state_seal.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <vector>

#include <sys/stat.h>

#include "volumes/base/error.h"
#include "volumes/base/sha256.h"
#include "volumes/state/state.h"

namespace supple {

namespace {

// An OpenVDB stream: magic (8 bytes), file version (4), library version (8), grid offsets (1),
// UUID (36), number of metadata (4), length of the first name (4), first name.
constexpr unsigned char kMagic[8] = {0x20, 0x42, 0x44, 0x56, 0, 0, 0, 0};
constexpr std::uint64_t kUuidAt = 21;
constexpr std::uint64_t kUuidBytes = 36;
constexpr std::uint64_t kFirstNameAt = kUuidAt + kUuidBytes + 8;
constexpr std::uint64_t kHeadBytes = kFirstNameAt + 7;

constexpr std::size_t kTrailerBytes = 128;
constexpr char kTrailerMagic[] = "\nsupple-state-trailer 1 ";
using Trailer = std::array<char, kTrailerBytes>;

Trailer make_trailer(std::uint64_t payload_bytes, const std::string& digest) {
  std::array<char, kTrailerBytes + 1> text{};
  std::snprintf(text.data(), text.size(), "%spayload %020" PRIu64 " sha256 %-67s\n", kTrailerMagic,
                payload_bytes, digest.c_str());
  Trailer trailer;
  std::copy_n(text.begin(), kTrailerBytes, trailer.begin());
  return trailer;
}

/// The digest as an OpenVDB UUID: 8-4-4-4-12 digits.
std::string uuid_of(const std::string& digest) {
  std::string uuid = digest.substr(0, 32);
  for (const std::size_t at : {8, 13, 18, 23}) uuid.insert(at, "-");
  return uuid;
}

/// Length of a regular file, by the rules of throw_open_error.
std::uint64_t file_length(const std::string& path) {
  struct stat status;
  if (::stat(path.c_str(), &status) != 0) throw_open_error(path, errno);
  if (S_ISDIR(status.st_mode)) throw_open_error(path, EISDIR);
  if (!S_ISREG(status.st_mode)) throw InputError({path, "", "a device or pipe", "a file"});
  return std::uint64_t(status.st_size);
}

/// What the first and last bytes of a file say.
struct Ends {
  bool is_vdb = false;
  bool has_metadata = false;  // ours
  bool has_trailer = false;
  std::string uuid;
  Trailer trailer;
};

Ends read_ends(std::ifstream& in, std::uint64_t length) {
  Ends ends;
  std::array<char, kHeadBytes> head{};
  in.read(head.data(), std::streamsize(std::min<std::uint64_t>(kHeadBytes, length)));
  ends.is_vdb = std::memcmp(head.data(), kMagic, sizeof kMagic) == 0;
  ends.has_metadata = std::memcmp(head.data() + kFirstNameAt, kStateMetadataPrefix,
                                  std::strlen(kStateMetadataPrefix)) == 0;
  ends.uuid.assign(head.data() + kUuidAt, kUuidBytes);
  if (length >= kHeadBytes + kTrailerBytes) {
    in.clear();
    in.seekg(std::streamoff(length - kTrailerBytes));
    in.read(ends.trailer.data(), kTrailerBytes);
    ends.has_trailer =
        std::memcmp(ends.trailer.data(), kTrailerMagic, std::strlen(kTrailerMagic)) == 0;
  }
  return ends;
}

/// Digest of the first `bytes` bytes, the UUID taken as zeros.
std::string payload_digest(std::ifstream& in, std::uint64_t bytes, const std::string& path) {
  Sha256 hash;
  std::vector<char> block(std::size_t(1) << 20);
  in.clear();
  in.seekg(0);
  for (std::uint64_t at = 0; at < bytes; at += block.size()) {
    const std::uint64_t size = std::min<std::uint64_t>(block.size(), bytes - at);
    in.read(block.data(), std::streamsize(size));
    if (!in) throw SystemError(path + ": cannot read");
    if (at == 0) std::fill_n(block.begin() + kUuidAt, kUuidBytes, '0');
    hash.update(block.data(), std::size_t(size));
  }
  return hash.hex();
}

}  // namespace

void seal_state_file(const std::string& path) {
  const std::uint64_t length = file_length(path);
  std::ifstream in(path, std::ios::binary);
  if (!in || length < kHeadBytes) throw SystemError(path + ": cannot read back");
  const std::string digest = payload_digest(in, length, path);

  errno = 0;
  std::fstream out(path, std::ios::binary | std::ios::in | std::ios::out);
  out.seekp(std::streamoff(kUuidAt));
  out.write(uuid_of(digest).data(), std::streamsize(kUuidBytes));
  out.seekp(0, std::ios::end);
  out.write(make_trailer(length, digest).data(), kTrailerBytes);
  out.close();
  if (!out) throw SystemError(path + ": cannot write: " + std::strerror(errno));
}

void verify_state_seal(const std::string& path) {
  const std::uint64_t length = file_length(path);
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  if (!in) throw_open_error(path, errno);
  if (length == 0) throw InputError({path, "", "an empty file", "a state file"});

  const Ends ends = read_ends(in, length);
  const std::string expected = "a state written by supple";
  if (!ends.is_vdb) throw InputError({path, "", "a file that is not OpenVDB", expected});
  if (!ends.has_trailer) {
    if (!ends.has_metadata) {
      throw InputError({path, "", "an OpenVDB file of another program", expected});
    }
    throw InputError({path, "checksum", "no trailer (the file is cut off)", "a complete state"});
  }

  // The trailer that these bytes should have: any other byte in it is damage, too.
  const std::uint64_t payload_bytes = length - kTrailerBytes;
  const std::string digest = payload_digest(in, payload_bytes, path);
  if (ends.trailer != make_trailer(payload_bytes, digest) || ends.uuid != uuid_of(digest)) {
    throw InputError(
        {path, "checksum", "damaged content", "the length and SHA-256 that its trailer states"});
  }
}

bool is_state_file(const std::string& path) {
  struct stat status;
  if (::stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return false;
  std::ifstream in(path, std::ios::binary);
  if (!in) return false;
  const Ends ends = read_ends(in, std::uint64_t(status.st_size));
  return ends.is_vdb && (ends.has_metadata || ends.has_trailer);
}

}  // namespace supple
