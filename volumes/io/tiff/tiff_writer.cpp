// Scalar volumes as TIFF, one page per slice, with ImageJ's description: spacing in mm, slices
// along z. As in ImageJ's own files the values of all pages come first, in one run, and the
// directories behind them: tifffile takes such a run for granted where a description names several
// images, and can map it. BigTIFF where the plain format's 4 GB might not do. With deflate,
// integers are replaced by their differences along rows (predictor 2); floats are not, since ImageJ
// knows no predictor for them. Values are MinIsBlack and little-endian. The index-to-LPS affine
// stands in a line of the description that supple alone reads; other programs see axes along L, P,
// S from the origin 0, and a warning says so. Source: TIFF 6.0; BigTIFF
// (libtiff.gitlab.io/libtiff/specification/bigtiff.html); ImageJ's ij.io.TiffEncoder. Cost: 16
// bytes per strip of a page; with deflate 0.6 MB or a row of the image.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include <zlib.h>

#include "volumes/base/error.h"
#include "volumes/base/text.h"
#include "volumes/io/bytes/output_file.h"
#include "volumes/io/format/dense_writer.h"
#include "volumes/io/tiff/tiff_metadata.h"
#include "volumes/io/tiff/tiff_tags.h"

namespace supple {

namespace {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__,
              "values are written as they lie in memory");

constexpr std::int64_t kStripBytes = 256 * 1024;  // of deflated pages, before compression
/// Below 2^32 by what deflate may add to data that it cannot shrink.
constexpr double kLargestPlainTiff = 4.2e9;
constexpr double kDirectoryBytes = 400;

struct Strip {
  std::uint64_t offset, bytes;
};

bool is_float(ValueType type) {
  return type == ValueType::float32 || type == ValueType::float64;
}

template <class Value>
void difference(char* row, std::int64_t count) {
  Value left = 0;
  for (std::int64_t n = 0; n < count; ++n) {
    Value value;
    std::memcpy(&value, row + n * std::int64_t(sizeof value), sizeof value);
    const auto change = Value(value - left);
    std::memcpy(row + n * std::int64_t(sizeof value), &change, sizeof value);
    left = value;
  }
}

void difference(char* row, std::int64_t count, int width) {
  if (width == 1) return difference<std::uint8_t>(row, count);
  if (width == 2) return difference<std::uint16_t>(row, count);
  if (width == 4) return difference<std::uint32_t>(row, count);
  difference<std::uint64_t>(row, count);
}

/// The first page's ImageDescription.
std::string description_of(const Geometry& geometry) {
  const std::string slices = std::to_string(geometry.dims().z);
  std::string text = "ImageJ=1.53t\nimages=" + slices + "\nslices=" + slices + "\nunit=mm\n";
  text += "spacing=" + exact_text(geometry.spacing_mm().z) + "\nloop=false\n";
  text += std::string(kTiffAffineKey) + "=";
  for (const Vec3d& axis : geometry.axes_mm()) {
    for (int a = 0; a < 3; ++a) text += exact_text(axis[a]) + " ";
  }
  const Vec3d& origin = geometry.origin_lps_mm();
  return text + exact_text(origin.x) + " " + exact_text(origin.y) + " " + exact_text(origin.z) +
         "\n";
}

/// A warning of geometry that programs other than supple will not find in the file.
std::string lost_geometry(const Geometry& geometry) {
  const bool is_moved = geometry.origin_lps_mm() != Vec3d(0, 0, 0);
  const std::array<Vec3d, 3> identity = {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}};
  const bool is_turned = geometry.direction() != identity;
  if (!is_moved && !is_turned) return "";
  const std::string what = !is_turned ? "origin" : !is_moved ? "direction" : "origin and direction";
  return "TIFF keeps the " + what +
         " for supple alone; other programs read axes along L, P and S from 0";
}

class TiffWriter : public DenseWriter {
 public:
  TiffWriter(const std::string& path, const DenseImage& image, const WriteOptions& options)
      : m_file(path), m_geometry(image.geometry), m_type(image.type), m_compress(options.compress) {
    const Vec3i& dims = m_geometry.dims();
    m_row_bytes = std::int64_t(dims.x) * bytes_of(m_type);
    m_rows = dims.y;
    if (m_compress) m_rows = int(std::clamp<std::int64_t>(kStripBytes / m_row_bytes, 1, dims.y));
    const double strips = std::ceil(double(dims.y) / m_rows);
    m_is_big = double(dims.z) * (double(m_row_bytes) * dims.y + kDirectoryBytes + 16 * strips) >
               kLargestPlainTiff;
    std::string head = m_is_big ? std::string("II+\0\x08\0\0\0", 8) : std::string("II*\0", 4);
    head.resize(16, '\0');  // the first directory's place is filled in at the end
    write(head);
  }

  void write_slice(const void* values) override {
    ++m_slices;
    const int height = m_geometry.dims().y;
    const auto* bytes = static_cast<const char*>(values);
    for (int j = 0; j < height; j += m_rows) {
      const auto size = std::size_t(m_row_bytes * std::min(m_rows, height - j));
      const std::uint64_t offset = m_end;
      m_compress ? write_deflated(bytes, size) : write(bytes, size);
      m_strips.push_back({offset, m_end - offset});
      bytes += size;
    }
  }

  void commit() override {
    if (m_slices != m_geometry.dims().z) {
      throw Error(m_file.final_path() + ": fewer slices were written than the volume has");
    }
    write(std::string((8 - m_end % 8) % 8, '\0'));
    const std::uint64_t first = m_end;
    for (int k = 0; k < m_slices; ++k) {
      write(directory_of(k).bytes_at(m_end, k + 1 == m_slices));
    }
    m_file.seek(m_is_big ? 8 : 4);
    m_file.write(&first, m_is_big ? 8 : 4);
    m_file.close();
    m_file.commit();
  }

  std::vector<std::string> warnings() const override {
    const std::string lost = lost_geometry(m_geometry);
    if (lost.empty()) return {};
    return {lost};
  }

 private:
  void write(const void* data, std::size_t size) {
    m_file.write(data, size);
    m_end += size;
  }
  void write(const std::string& text) { write(text.data(), text.size()); }

  void write_deflated(const char* bytes, std::size_t size) {
    m_strip.assign(bytes, bytes + size);
    const int width = bytes_of(m_type);
    for (std::size_t at = 0; at < size && !is_float(m_type); at += std::size_t(m_row_bytes)) {
      difference(&m_strip[at], m_row_bytes / width, width);
    }
    uLongf deflated = compressBound(uLong(size));
    m_deflated.resize(deflated);
    if (compress2(m_deflated.data(), &deflated, reinterpret_cast<const Bytef*>(m_strip.data()),
                  uLong(size), Z_DEFAULT_COMPRESSION) != Z_OK) {
      throw SystemError(m_file.final_path() + ": zlib cannot allocate its window");
    }
    write(m_deflated.data(), deflated);
  }

  TiffDirectory directory_of(int slice) const {
    const Vec3i& dims = m_geometry.dims();
    const Vec3d spacing = m_geometry.spacing_mm();
    const bool is_signed = numpy_name(m_type)[0] == 'i';
    const TiffType place = m_is_big ? tiff_long8 : tiff_long;
    const std::size_t strips = m_strips.size() / std::size_t(dims.z);
    std::vector<std::uint64_t> offsets, counts;
    for (std::size_t n = strips * slice; n < strips * (slice + 1); ++n) {
      offsets.push_back(m_strips[n].offset);
      counts.push_back(m_strips[n].bytes);
    }
    TiffDirectory directory(m_is_big);
    directory.add(image_width, tiff_long, {std::uint64_t(dims.x)});
    directory.add(image_length, tiff_long, {std::uint64_t(dims.y)});
    directory.add(bits_per_sample, tiff_short, {std::uint64_t(8 * bytes_of(m_type))});
    directory.add(compression, tiff_short, {m_compress ? 8u : 1u});
    directory.add(photometric, tiff_short, {1});
    if (slice == 0) directory.add(image_description, description_of(m_geometry));
    directory.add(strip_offsets, place, offsets);
    directory.add(samples_per_pixel, tiff_short, {1});
    directory.add(rows_per_strip, tiff_long, {std::uint64_t(m_rows)});
    directory.add(strip_byte_counts, place, counts);
    directory.add(x_resolution, tiff_rational, tiff_resolution(spacing.x));
    directory.add(y_resolution, tiff_rational, tiff_resolution(spacing.y));
    directory.add(resolution_unit, tiff_short, {1});
    if (m_compress && !is_float(m_type)) directory.add(predictor, tiff_short, {2});
    directory.add(sample_format, tiff_short, {is_float(m_type) ? 3u : is_signed ? 2u : 1u});
    return directory;
  }

  OutputFile m_file;
  Geometry m_geometry;
  ValueType m_type;
  bool m_compress;
  bool m_is_big = false;
  std::int64_t m_row_bytes = 0;
  int m_rows = 1;  // of a strip
  int m_slices = 0;
  std::uint64_t m_end = 0;  // of what was written
  std::vector<Strip> m_strips;
  std::vector<char> m_strip;
  std::vector<Bytef> m_deflated;
};

}  // namespace

std::unique_ptr<DenseWriter> create_tiff(const std::string& path, const std::string&,
                                         const DenseImage& image, const WriteOptions& options) {
  if (image.components > 1) {
    throw InputError(
        {path, "values", "vectors", "scalars in TIFF (NRRD and MetaImage keep warps)"});
  }
  return std::make_unique<TiffWriter>(path, image, options);
}

}  // namespace supple
