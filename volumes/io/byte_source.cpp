#include "volumes/io/byte_source.h"

#include <algorithm>
#include <cerrno>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include "volumes/base/error.h"

namespace supple {

namespace {

constexpr std::size_t kBufferBytes = 256 * 1024;
// Deflate's densest code is 258 bytes per 2 bits.
constexpr std::int64_t kMaxDeflateRatio = 1032;

std::string bytes_text(std::int64_t count) {
  return std::to_string(count) + " bytes";
}

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
  void finish() override {}

 private:
  std::shared_ptr<const InputFile> m_file;
  std::int64_t m_offset;
};

/// zlib's state for one file: gzip (several members in a row too) or zlib streams.
class InflateSource : public ByteSource {
 public:
  InflateSource(std::shared_ptr<const InputFile> file, const ByteRange& range)
      : m_file(std::move(file)),
        m_range(range),
        m_offset(range.file_offset),
        m_buffer(kBufferBytes) {
    constexpr int kGzipOrZlib = 15 + 32;
    if (inflateInit2(&m_zlib, kGzipOrZlib) != Z_OK) {
      throw SystemError(m_file->path() + ": zlib cannot allocate its window");
    }
  }
  ~InflateSource() override { inflateEnd(&m_zlib); }
  InflateSource(const InflateSource&) = delete;
  InflateSource& operator=(const InflateSource&) = delete;

  void read(void* out, std::size_t size) override {
    skip_stream_offset();
    const std::size_t got = inflate_some(out, size);
    m_delivered += std::int64_t(got);
    if (got < size) {
      throw InputError({m_file->path(), "compressed data",
                        bytes_text(m_delivered) + " after decompression",
                        bytes_text(m_range.size)});
    }
  }

  /// Runs to the end of the stream, where zlib compares the checksum.
  void finish() override {
    std::vector<char> rest(kBufferBytes);
    std::size_t surplus = 0;
    do {
      surplus = inflate_some(rest.data(), rest.size());
      if (surplus > 0 && m_range.surplus == Surplus::error) {
        throw InputError({m_file->path(), "compressed data",
                          "more than " + bytes_text(m_range.size) + " after decompression",
                          bytes_text(m_range.size)});
      }
    } while (surplus > 0);
  }

  /// Decompresses up to `size` bytes; fewer only at the regular end of the stream.
  std::size_t inflate_some(void* out, std::size_t size) {
    std::size_t done = 0;
    while (done < size && !m_at_end) {
      if (m_zlib.avail_in == 0 && !refill()) fail("the end of the file inside the stream");
      const std::size_t chunk = std::min<std::size_t>(size - done, 1u << 30);
      m_zlib.next_out = static_cast<Bytef*>(out) + done;
      m_zlib.avail_out = uInt(chunk);
      const int result = inflate(&m_zlib, Z_NO_FLUSH);
      done += chunk - m_zlib.avail_out;
      if (result == Z_STREAM_END) {
        start_next_member();
      } else if (result != Z_OK && result != Z_BUF_ERROR) {
        fail(m_zlib.msg != nullptr ? m_zlib.msg : "a damaged stream");
      }
    }
    return done;
  }

 private:
  [[noreturn]] void fail(const std::string& found) const {
    throw InputError({m_file->path(), "compressed data", found, "an intact gzip or zlib stream"});
  }

  bool refill() {
    const std::size_t got = m_file->read_at(m_offset, m_buffer.data(), m_buffer.size());
    m_offset += std::int64_t(got);
    m_zlib.next_in = m_buffer.data();
    m_zlib.avail_in = uInt(got);
    return got > 0;
  }

  /// A gzip file may hold several members in a row; anything else after the end is padding.
  void start_next_member() {
    if (m_zlib.avail_in == 0 && !refill()) {
      m_at_end = true;
      return;
    }
    if (m_zlib.next_in[0] != 0x1f) {
      m_at_end = true;
      return;
    }
    inflateReset(&m_zlib);
  }

  void skip_stream_offset() {
    std::vector<char> dropped(std::size_t(std::min<std::int64_t>(m_range.stream_offset, 65536)));
    while (m_range.stream_offset > 0) {
      const auto chunk =
          std::min<std::int64_t>(m_range.stream_offset, std::int64_t(dropped.size()));
      if (inflate_some(dropped.data(), std::size_t(chunk)) < std::size_t(chunk)) {
        fail("its end before the first value");
      }
      m_range.stream_offset -= chunk;
    }
  }

  std::shared_ptr<const InputFile> m_file;
  ByteRange m_range;
  std::int64_t m_offset;
  std::int64_t m_delivered = 0;
  bool m_at_end = false;
  std::vector<Bytef> m_buffer;
  z_stream m_zlib{};
};

void check_length(const InputFile& file, const ByteRange& range) {
  if (range.file_offset < 0 || range.stream_offset < 0 || range.file_offset >= file.size()) {
    throw InputError({file.path(), "data offset",
                      std::to_string(range.file_offset + range.stream_offset),
                      "0 to " + std::to_string(file.size() - 1)});
  }
  const std::int64_t available = file.size() - range.file_offset;
  const std::string where =
      range.file_offset > 0 ? " from byte " + std::to_string(range.file_offset) + " on" : "";
  if (range.compression == Compression::deflate) {
    // Addition in double: a wild stream_offset must not overflow.
    if (double(range.size) + double(range.stream_offset) >
        double(available) * double(kMaxDeflateRatio)) {
      throw InputError({file.path(), "file length",
                        bytes_text(available) + " of compressed data" + where,
                        "enough for " + bytes_text(range.size)});
    }
    return;
  }
  const bool wrong =
      range.surplus == Surplus::error ? available != range.size : available < range.size;
  if (wrong) {
    throw InputError({file.path(), "file length", bytes_text(available) + where,
                      bytes_text(range.size) + " as the header claims"});
  }
}

}  // namespace

InputFile::InputFile(std::string path)
    : m_path(std::move(path)),
      m_descriptor(::open(m_path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {
  if (m_descriptor < 0) throw_open_error(m_path, errno);
  struct stat status {};
  const bool known = ::fstat(m_descriptor, &status) == 0;
  const int stat_errno = errno;
  m_size = status.st_size;
  if (known && S_ISREG(status.st_mode) && m_size > 0) return;
  ::close(m_descriptor);
  if (!known) throw_open_error(m_path, stat_errno);
  if (S_ISDIR(status.st_mode)) throw_open_error(m_path, EISDIR);
  if (!S_ISREG(status.st_mode)) throw InputError({m_path, "", "a device", "a regular file"});
  throw InputError({m_path, "file length", "0 bytes", "a file with content"});
}

InputFile::~InputFile() {
  ::close(m_descriptor);
}

std::size_t InputFile::read_at(std::int64_t offset, void* out, std::size_t size) const {
  std::size_t done = 0;
  while (done < size) {
    const ssize_t got = ::pread(m_descriptor, static_cast<char*>(out) + done, size - done,
                                off_t(offset + std::int64_t(done)));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw_open_error(m_path, errno);
    if (got == 0) break;
    done += std::size_t(got);
  }
  return done;
}

std::string InputFile::head(std::size_t limit) const {
  std::string bytes(std::size_t(std::min<std::int64_t>(m_size, std::int64_t(limit))), '\0');
  bytes.resize(read_at(0, bytes.data(), bytes.size()));
  return bytes;
}

std::unique_ptr<ByteSource> open_source(std::shared_ptr<const InputFile> file,
                                        const ByteRange& range) {
  check_length(*file, range);
  if (range.compression == Compression::deflate) {
    return std::make_unique<InflateSource>(std::move(file), range);
  }
  return std::make_unique<PlainSource>(std::move(file), range.file_offset);
}

bool is_gzip(const std::string& head) {
  return head.size() >= 2 && head[0] == '\x1f' && head[1] == '\x8b';
}

std::string gzip_head(const InputFile& file, std::size_t limit) {
  std::string bytes(limit, '\0');
  // The caller keeps the file alive longer than the source.
  const std::shared_ptr<const InputFile> borrowed(&file, [](const InputFile*) {});
  InflateSource source(borrowed, ByteRange{});
  try {
    bytes.resize(source.inflate_some(bytes.data(), limit));
  } catch (const InputError&) {
    bytes.clear();
  }
  return bytes;
}

}  // namespace supple
