#include "volumes/io/header_writer.h"

#include <optional>

#include <zlib.h>

#include "volumes/base/error.h"
#include "volumes/io/output_file.h"

namespace supple {

namespace {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__,
              "values are written as they lie in memory");

/// A gzip stream into an open file.
class GzipStream {
 public:
  explicit GzipStream(OutputFile& file) : m_file(file), m_buffer(256 * 1024) {
    constexpr int kGzip = 15 + 16, kMemory = 8;
    if (deflateInit2(&m_zlib, Z_DEFAULT_COMPRESSION, Z_DEFLATED, kGzip, kMemory,
                     Z_DEFAULT_STRATEGY) != Z_OK) {
      throw SystemError(file.final_path() + ": zlib cannot allocate its window");
    }
  }
  ~GzipStream() { deflateEnd(&m_zlib); }
  GzipStream(const GzipStream&) = delete;
  GzipStream& operator=(const GzipStream&) = delete;

  void write(const void* data, std::size_t size) {
    const auto* bytes = static_cast<const Bytef*>(data);
    while (size > 0) {
      const std::size_t chunk = std::min<std::size_t>(size, 1u << 30);
      run(bytes, chunk, Z_NO_FLUSH);
      bytes += chunk;
      size -= chunk;
    }
  }
  void finish() { run(nullptr, 0, Z_FINISH); }

 private:
  void run(const Bytef* bytes, std::size_t size, int flush) {
    m_zlib.next_in = const_cast<Bytef*>(bytes);
    m_zlib.avail_in = uInt(size);
    do {
      m_zlib.next_out = m_buffer.data();
      m_zlib.avail_out = uInt(m_buffer.size());
      deflate(&m_zlib, flush);
      m_file.write(m_buffer.data(), m_buffer.size() - m_zlib.avail_out);
    } while (m_zlib.avail_out == 0);
  }

  OutputFile& m_file;
  std::vector<Bytef> m_buffer;
  z_stream m_zlib{};
};

class HeaderWriter : public DenseWriter {
 public:
  HeaderWriter(const std::string& path, const std::string& raw_path, const std::string& header,
               const DenseImage& image, StreamCoding coding)
      : m_header_file(path) {
    if (!raw_path.empty()) m_raw_file.emplace(raw_path);
    m_header_file.write(header);
    if (coding == StreamCoding::gzip) m_gzip.emplace(values());
    const Vec3i& dims = image.geometry.dims();
    m_slice_bytes = std::size_t(dims.x) * dims.y * image.components * bytes_of(image.type);
  }

  void write_slice(const void* slice) override {
    if (m_gzip) {
      m_gzip->write(slice, m_slice_bytes);
    } else {
      values().write(slice, m_slice_bytes);
    }
  }

  void commit() override {
    if (m_gzip) m_gzip->finish();
    if (m_raw_file) m_raw_file->close();
    m_header_file.close();
    if (m_raw_file) m_raw_file->commit();
    m_header_file.commit();
  }

 private:
  OutputFile& values() { return m_raw_file ? *m_raw_file : m_header_file; }

  OutputFile m_header_file;
  std::optional<OutputFile> m_raw_file;
  std::optional<GzipStream> m_gzip;
  std::size_t m_slice_bytes = 0;
};

}  // namespace

std::unique_ptr<DenseWriter> write_after_header(const std::string& path,
                                                const std::string& raw_path,
                                                const std::string& header, const DenseImage& image,
                                                StreamCoding coding) {
  return std::make_unique<HeaderWriter>(path, raw_path, header, image, coding);
}

}  // namespace supple
