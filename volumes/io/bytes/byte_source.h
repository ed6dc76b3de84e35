// Bytes of a file, front to back, plain or encoded, behind one face. Every claim that can be
// checked against the file's length is checked when the source is opened. Cost: a 256 kB buffer for
// encoded data (bzip2: another 4 MB), none for plain data.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "volumes/io/bytes/input_file.h"

namespace supple {

enum class ValueType;  // of volume_file.h

/// How bytes are stored. deflate: gzip and zlib streams, told apart by content. text: decimal
/// numbers between blanks, line ends and commas. hex: two hexadecimal digits per byte.
enum class Compression { none, deflate, bzip2, text, hex };

/// Answer to bytes behind those that a header claims: an error, or they are ignored.
enum class Surplus { error, ignore };

/// The bytes that hold the values of a volume.
struct ByteRange {
  std::int64_t file_offset = 0;    // first byte in the file
  std::int64_t stream_offset = 0;  // bytes to drop after decoding
  std::int64_t size = 0;           // bytes that the header claims (decoded)
  Compression compression = Compression::none;
  Surplus surplus = Surplus::error;
  ValueType text_type{};  // type that numbers of a text become, in native byte order
};

class ByteSource {
 public:
  virtual ~ByteSource() = default;
  /// Fills `out`. Throws InputError when the data end early or cannot be decoded.
  virtual void read(void* out, std::size_t size) = 0;
  /// Leaves out bytes; by arithmetic where they are plain, by decoding otherwise.
  virtual void skip(std::int64_t size) = 0;
  /// To be called after the last byte that is wanted: decodes what remains of the claimed bytes,
  /// compares checksums, and finds nothing left over unless allowed.
  virtual void finish() = 0;
};

/// Checks `range` against the file's length: deflate cannot shrink by more than 1032:1, a number of
/// a text takes two characters, a byte in hex too. bzip2 has no useful bound (about 2 000 000:1),
/// so that a claim beyond 1000:1 is proved by decoding the stream once, without keeping it. Hence
/// no slice that a caller allocates is larger than 1032 times the file, or than its contents.
/// Throws InputError with both numbers.
void check_range(const std::shared_ptr<const InputFile>& file, const ByteRange& range);

/// Opens a range that check_range() has passed.
std::unique_ptr<ByteSource> open_checked(std::shared_ptr<const InputFile> file,
                                         const ByteRange& range);

/// Calls check_range() and open_checked().
std::unique_ptr<ByteSource> open_source(std::shared_ptr<const InputFile> file,
                                        const ByteRange& range);

/// True when the bytes start like a gzip stream.
bool is_gzip(const std::string& head);

/// The first `limit` bytes of a gzip file's content, fewer when it ends early or is damaged.
std::string gzip_head(const InputFile& file, std::size_t limit);

/// "24 bytes".
std::string bytes_text(std::int64_t count);

}  // namespace supple
