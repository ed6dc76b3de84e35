#include "volumes/io/format/header_writer.h"

#include <optional>

#include "volumes/io/bytes/gzip_stream.h"

namespace supple {

namespace {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__,
              "values are written as they lie in memory");

class HeaderWriter : public DenseWriter {
 public:
  HeaderWriter(const std::string& path, const std::string& raw_path, const std::string& header,
               const DenseImage& image, StreamCoding coding, const std::string& footer)
      : m_header_file(path), m_size_place(header.find(kStreamSize)), m_footer(footer) {
    if (!raw_path.empty()) m_raw_file.emplace(raw_path);
    m_header_file.write(header);
    m_stream_start = values().position();
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
    if (m_gzip) finish_stream();
    values().write(m_footer);
    if (m_raw_file) m_raw_file->close();
    m_header_file.close();
    const CommonCommit both;
    if (m_raw_file) m_raw_file->commit();
    m_header_file.commit();
  }

 private:
  OutputFile& values() { return m_raw_file ? *m_raw_file : m_header_file; }

  void finish_stream() {
    m_gzip->finish();
    if (m_size_place == std::string::npos) return;
    std::string size = std::to_string(values().position() - m_stream_start);
    size.resize(std::string(kStreamSize).size(), ' ');
    m_header_file.seek(std::int64_t(m_size_place));
    m_header_file.write(size);
  }

  OutputFile m_header_file;
  std::optional<OutputFile> m_raw_file;
  std::optional<GzipStream> m_gzip;
  std::size_t m_size_place;  // of kStreamSize in the header
  std::string m_footer;
  std::int64_t m_stream_start = 0;
  std::size_t m_slice_bytes = 0;
};

}  // namespace

std::unique_ptr<DenseWriter> write_after_header(const std::string& path,
                                                const std::string& raw_path,
                                                const std::string& header, const DenseImage& image,
                                                StreamCoding coding, const std::string& footer) {
  return std::make_unique<HeaderWriter>(path, raw_path, header, image, coding, footer);
}

}  // namespace supple
