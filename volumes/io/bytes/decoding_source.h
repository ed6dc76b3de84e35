// Common part of the encodings of byte_source.h: a buffer of the file, bytes dropped at the front,
// and errors that name the number of bytes found and the number that the header claims.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "volumes/io/bytes/byte_source.h"

namespace supple {

class DecodingSource : public ByteSource {
 public:
  /// `field` names the data in errors.
  DecodingSource(std::shared_ptr<const InputFile> file, const ByteRange& range, std::string field);

  void read(void* out, std::size_t size) final;
  void skip(std::int64_t size) final;
  void finish() final;

  /// Decodes up to `size` bytes; fewer only at the regular end of the data.
  virtual std::size_t decode(void* out, std::size_t size) = 0;

 protected:
  /// An amount of decoded bytes as errors put it.
  virtual std::string amount(std::int64_t bytes) const;
  [[noreturn]] void fail(const std::string& found, const std::string& expected) const;

  /// Bytes of the file that wait to be decoded; refill() gets more when there are none left, and is
  /// false at the end of the file.
  const unsigned char* next() const { return m_buffer.data() + m_used; }
  std::size_t available() const { return m_filled - m_used; }
  void use(std::size_t count) { m_used += count; }
  bool refill();

 private:
  /// Decodes and forgets up to `count` bytes; fewer only at the end of the data.
  std::int64_t drop(std::int64_t count);
  void drop_stream_offset();

  std::shared_ptr<const InputFile> m_file;
  ByteRange m_range;
  std::string m_field;
  std::int64_t m_offset;         // in the file, behind the buffer
  std::int64_t m_delivered = 0;  // decoded bytes behind stream_offset
  bool m_at_values = false;      // stream_offset is behind
  std::vector<unsigned char> m_buffer;
  std::size_t m_used = 0, m_filled = 0;
};

std::unique_ptr<DecodingSource> open_inflate(std::shared_ptr<const InputFile> file,
                                             const ByteRange& range);
std::unique_ptr<DecodingSource> open_bzip2(std::shared_ptr<const InputFile> file,
                                           const ByteRange& range);
std::unique_ptr<DecodingSource> open_text(std::shared_ptr<const InputFile> file,
                                          const ByteRange& range);
std::unique_ptr<DecodingSource> open_hex(std::shared_ptr<const InputFile> file,
                                         const ByteRange& range);

}  // namespace supple
