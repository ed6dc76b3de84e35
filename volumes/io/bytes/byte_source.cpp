#include "volumes/io/bytes/byte_source.h"

#include "volumes/base/error.h"
#include "volumes/io/bytes/decoding_source.h"
#include "volumes/io/bytes/value_type.h"

namespace supple {

namespace {

// Deflate's densest code is 258 bytes per 2 bits.
constexpr double kMaxDeflateRatio = 1032;
// A bzip2 block holds at most 900 000 bytes after run-length coding, which makes 259 bytes out of
// 5, and takes at least 24 bytes itself (48 bits of mark, 32 of checksum, 25 of flags and origin,
// 32 of symbols in use, 19 of table counts, two tables of 3 symbols and 20 symbols of runs).
constexpr double kMaxBzip2Ratio = 900000.0 * 259 / 5 / 24;
// Claims beyond this ratio are proved by decoding.
constexpr double kUnprovedBzip2Ratio = 1000;

/// The part of an open file from an offset on, as it is.
class PlainSource : public ByteSource {
 public:
  PlainSource(std::shared_ptr<const InputFile> file, std::int64_t offset)
      : m_file(std::move(file)), m_offset(offset) {}

  void read(void* out, std::size_t size) override {
    const std::size_t got = m_file->read_at(m_offset, out, size);
    m_offset += std::int64_t(got);
    if (got == size) return;
    throw InputError({m_file->path(), "data", "the end of the file after " + bytes_text(m_offset),
                      bytes_text(m_offset + std::int64_t(size - got))});
  }
  void skip(std::int64_t size) override { m_offset += size; }
  void finish() override {}

 private:
  std::shared_ptr<const InputFile> m_file;
  std::int64_t m_offset;
};

/// Number of decoded bytes that `available` bytes can give at most.
double most_decoded(double available, const ByteRange& range) {
  switch (range.compression) {
    case Compression::none:
      return available;
    case Compression::deflate:
      return available * kMaxDeflateRatio;
    case Compression::bzip2:
      return available * kMaxBzip2Ratio;
    case Compression::text:  // a digit and a separator, which the last number does without
      return (available + 1) / 2 * bytes_of(range.text_type);
    case Compression::hex:
      return available / 2;
  }
  return available;
}

/// Words for encoded data in errors.
std::string content_of(Compression compression) {
  if (compression == Compression::text) return " of text";
  return compression == Compression::hex ? " of hex digits" : " of compressed data";
}

}  // namespace

std::string bytes_text(std::int64_t count) {
  return std::to_string(count) + " bytes";
}

void check_range(const std::shared_ptr<const InputFile>& file, const ByteRange& range) {
  if (range.file_offset < 0 || range.stream_offset < 0 || range.file_offset >= file->size()) {
    throw InputError({file->path(), "data offset",
                      std::to_string(range.file_offset + range.stream_offset),
                      "0 to " + std::to_string(file->size() - 1)});
  }
  const std::int64_t available = file->size() - range.file_offset;
  const std::string where =
      range.file_offset > 0 ? " from byte " + std::to_string(range.file_offset) + " on" : "";
  if (range.compression == Compression::none) {
    const bool wrong =
        range.surplus == Surplus::error ? available != range.size : available < range.size;
    if (!wrong) return;
    throw InputError({file->path(), "file length", bytes_text(available) + where,
                      bytes_text(range.size) + " as the header claims"});
  }
  // Addition in double: a wild stream_offset must not overflow.
  const double claimed = double(range.size) + double(range.stream_offset);
  if (claimed > most_decoded(double(available), range)) {
    throw InputError({file->path(), "file length",
                      bytes_text(available) + content_of(range.compression) + where,
                      "enough for " + bytes_text(range.size)});
  }
  if (range.compression == Compression::bzip2 &&
      claimed > double(available) * kUnprovedBzip2Ratio) {
    open_bzip2(file, range)->skip(range.size);
  }
}

std::unique_ptr<ByteSource> open_checked(std::shared_ptr<const InputFile> file,
                                         const ByteRange& range) {
  switch (range.compression) {
    case Compression::none:
      break;
    case Compression::deflate:
      return open_inflate(std::move(file), range);
    case Compression::bzip2:
      return open_bzip2(std::move(file), range);
    case Compression::text:
      return open_text(std::move(file), range);
    case Compression::hex:
      return open_hex(std::move(file), range);
  }
  return std::make_unique<PlainSource>(std::move(file), range.file_offset);
}

std::unique_ptr<ByteSource> open_source(std::shared_ptr<const InputFile> file,
                                        const ByteRange& range) {
  check_range(file, range);
  return open_checked(std::move(file), range);
}

}  // namespace supple
