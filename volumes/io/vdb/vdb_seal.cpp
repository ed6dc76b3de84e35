#include "volumes/io/vdb/vdb_seal.h"

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
using Trailer = std::array<char, kTrailerBytes>;

/// Marks and names of the two kinds of our files.
struct Mark {
  const char* metadata_prefix;
  const char* trailer_magic;  // of equal lengths
  const char* name;
};
constexpr Mark kState = {kStateMetadataPrefix, "\nsupple-state-trailer 1 ", "state"};
constexpr Mark kVolume = {kVolumeMetadataPrefix, "\nsupple-dense-trailer 1 ", "volume"};

const Mark& mark_of(VdbKind kind) {
  return kind == VdbKind::state ? kState : kVolume;
}

Trailer make_trailer(const Mark& mark, std::uint64_t payload_bytes, const std::string& digest) {
  std::array<char, kTrailerBytes + 1> text{};
  std::snprintf(text.data(), text.size(), "%spayload %020" PRIu64 " sha256 %-67s\n",
                mark.trailer_magic, payload_bytes, digest.c_str());
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

/// The first and last bytes of a file, taken apart.
struct Ends {
  bool is_vdb = false;
  std::string first_name;  // of the metadata: its first seven characters
  std::string uuid;
  Trailer trailer{};

  bool has_metadata(const Mark& mark) const { return first_name == mark.metadata_prefix; }
  bool has_trailer(const Mark& mark) const {
    return std::memcmp(trailer.data(), mark.trailer_magic, std::strlen(mark.trailer_magic)) == 0;
  }
};

Ends read_ends(std::ifstream& in, std::uint64_t length) {
  Ends ends;
  std::array<char, kHeadBytes> head{};
  in.read(head.data(), std::streamsize(std::min<std::uint64_t>(kHeadBytes, length)));
  ends.is_vdb = std::memcmp(head.data(), kMagic, sizeof kMagic) == 0;
  ends.first_name.assign(head.data() + kFirstNameAt, kHeadBytes - kFirstNameAt);
  ends.uuid.assign(head.data() + kUuidAt, kUuidBytes);
  if (length >= kHeadBytes + kTrailerBytes) {
    in.clear();
    in.seekg(std::streamoff(length - kTrailerBytes));
    in.read(ends.trailer.data(), kTrailerBytes);
  }
  return ends;
}

/// Digest of the first `bytes` bytes, the UUID taken as zeros.
std::string payload_digest(std::ifstream& in, std::uint64_t bytes, const std::string& path,
                           const Progress* progress) {
  Sha256 hash;
  std::vector<char> block(std::size_t(1) << 20);
  in.clear();
  in.seekg(0);
  for (std::uint64_t at = 0; at < bytes; at += block.size()) {
    poll(progress);
    const std::uint64_t size = std::min<std::uint64_t>(block.size(), bytes - at);
    in.read(block.data(), std::streamsize(size));
    if (!in) throw SystemError(path + ": cannot read");
    if (at == 0) std::fill_n(block.begin() + kUuidAt, kUuidBytes, '0');
    hash.update(block.data(), std::size_t(size));
  }
  return hash.hex();
}

}  // namespace

void seal_vdb(const std::string& path, VdbKind kind, const Progress* progress) {
  const std::uint64_t length = file_length(path);
  std::ifstream in(path, std::ios::binary);
  if (!in || length < kHeadBytes) throw SystemError(path + ": cannot read back");
  const std::string digest = payload_digest(in, length, path, progress);

  errno = 0;
  std::fstream out(path, std::ios::binary | std::ios::in | std::ios::out);
  out.seekp(std::streamoff(kUuidAt));
  out.write(uuid_of(digest).data(), std::streamsize(kUuidBytes));
  out.seekp(0, std::ios::end);
  out.write(make_trailer(mark_of(kind), length, digest).data(), kTrailerBytes);
  out.close();
  if (!out) throw SystemError(path + ": cannot write: " + std::strerror(errno));
}

void verify_vdb_seal(const std::string& path, VdbKind kind) {
  const Mark& mark = mark_of(kind);
  const std::string name = mark.name;
  const std::uint64_t length = file_length(path);
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  if (!in) throw_open_error(path, errno);
  if (length == 0) throw InputError({path, "", "an empty file", "a " + name + " file"});

  const Ends ends = read_ends(in, length);
  const std::string expected = "a " + name + " written by supple";
  if (!ends.is_vdb) throw InputError({path, "", "a file that is not OpenVDB", expected});
  if (!ends.has_trailer(mark)) {
    if (!ends.has_metadata(mark)) {
      throw InputError({path, "", "an OpenVDB file of another program", expected});
    }
    throw InputError({path, "checksum", "no trailer (the file is cut off)", "a complete " + name});
  }

  // The trailer that these bytes should have: any other byte in it is damage, too.
  const std::uint64_t payload_bytes = length - kTrailerBytes;
  const std::string digest = payload_digest(in, payload_bytes, path, nullptr);
  if (ends.trailer != make_trailer(mark, payload_bytes, digest) || ends.uuid != uuid_of(digest)) {
    throw InputError(
        {path, "checksum", "damaged content", "the length and SHA-256 that its trailer states"});
  }
}

VdbKind vdb_kind(const std::string& path) {
  struct stat status;
  if (::stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return VdbKind::none;
  std::ifstream in(path, std::ios::binary);
  if (!in) return VdbKind::none;
  const Ends ends = read_ends(in, std::uint64_t(status.st_size));
  if (!ends.is_vdb) return VdbKind::none;
  for (const VdbKind kind : {VdbKind::state, VdbKind::volume}) {
    const Mark& mark = mark_of(kind);
    if (ends.has_metadata(mark) || ends.has_trailer(mark)) return kind;
  }
  return VdbKind::foreign;
}

}  // namespace supple
