// Bytes of a file, front to back, plain or deflated, behind one face. Every claim that can be
// checked against the file's length is checked when the source is opened.
// Cost: a 256 kB buffer for deflated data, none for plain data.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace supple {

/// An open regular file. Throws InputError for a missing or empty file, a folder or a device.
class InputFile {
 public:
  explicit InputFile(std::string path);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  const std::string& path() const { return m_path; }
  std::int64_t size() const { return m_size; }
  /// Up to `size` bytes from `offset` on; fewer only at the end of the file.
  std::size_t read_at(std::int64_t offset, void* out, std::size_t size) const;
  /// The first bytes of the file, at most `limit`.
  std::string head(std::size_t limit) const;

 private:
  std::string m_path;
  int m_descriptor;
  std::int64_t m_size;
};

enum class Compression { none, deflate };  // deflate: gzip and zlib streams, told apart by content

/// What a source may hold behind the bytes that its header claims.
enum class Surplus { error, ignore };

/// Where the values of a volume lie.
struct ByteRange {
  std::int64_t file_offset = 0;    // first byte in the file
  std::int64_t stream_offset = 0;  // bytes to drop after decompression
  std::int64_t size = 0;           // bytes that the header claims (decompressed)
  Compression compression = Compression::none;
  Surplus surplus = Surplus::error;
};

class ByteSource {
 public:
  virtual ~ByteSource() = default;
  /// Fills `out`. Throws InputError when the data end early or cannot be decoded.
  virtual void read(void* out, std::size_t size) = 0;
  /// To be called after the last byte was read: checksum, and nothing left over unless allowed.
  virtual void finish() = 0;
};

/// Checks `range` against the file's length (deflate cannot shrink by more than 1032:1) and opens
/// it. Throws InputError with both numbers.
std::unique_ptr<ByteSource> open_source(std::shared_ptr<const InputFile> file,
                                        const ByteRange& range);

/// True when the bytes start like a gzip stream.
bool is_gzip(const std::string& head);

/// The first `limit` bytes of a gzip file's content, fewer when it ends early or is damaged.
std::string gzip_head(const InputFile& file, std::size_t limit);

}  // namespace supple
