// Scalar volumes as TIFF, one page per slice, with ImageJ's description: spacing in mm, ZYX stack.
// BigTIFF where the plain format's 4 GB might not do. Deflate uses the horizontal predictor for
// integers; floats go without one, since ImageJ knows none for them. Values are MinIsBlack.
// The index-to-LPS affine stands in a line of the description that supple alone reads; other
// programs see axes along L, P, S from the origin 0, and are told so by a warning.
// Source: TIFF 6.0; ImageJ's ij.io.TiffEncoder. Cost: one strip of 256 kB or one row.
#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>

#include "volumes/base/error.h"
#include "volumes/io/dense_writer.h"
#include "volumes/io/output_file.h"
#include "volumes/io/tiff_library.h"
#include "volumes/io/tiff_metadata.h"

namespace supple {

namespace {

constexpr std::int64_t kStripBytes = 256 * 1024;
/// Directories of a page: some 200 bytes and 8 for each strip.
constexpr double kPageBytes = 400;
constexpr double kLargestPlainTiff = 4.2e9;  // of 2^32, for codecs that grow their input a little

bool is_float(ValueType type) {
  return type == ValueType::float32 || type == ValueType::float64;
}
bool is_signed(ValueType type) {
  return numpy_name(type)[0] == 'i';
}

/// The first page's ImageDescription.
std::string description_of(const Geometry& geometry) {
  const std::string slices = std::to_string(geometry.dims().z);
  std::string text = "ImageJ=1.53t\nimages=" + slices + "\nslices=" + slices + "\nunit=mm\n";
  text += "spacing=" + exact_decimal(geometry.spacing_mm().z) + "\nloop=false\n";
  text += std::string(kTiffAffineKey) + "=";
  for (const Vec3d& axis : geometry.axes_mm()) {
    for (int a = 0; a < 3; ++a) text += exact_decimal(axis[a]) + " ";
  }
  const Vec3d& origin = geometry.origin_lps_mm();
  return text + exact_decimal(origin.x) + " " + exact_decimal(origin.y) + " " +
         exact_decimal(origin.z) + "\n";
}

/// What programs other than supple will not find in the file.
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
    m_rows = int(std::clamp<std::int64_t>(kStripBytes / m_row_bytes, 1, dims.y));
    m_strip.resize(std::size_t(m_row_bytes * m_rows));
    const double strips = std::ceil(double(dims.y) / m_rows);
    const double total = double(dims.z) * (double(m_row_bytes) * dims.y + kPageBytes + 16 * strips);
    m_file.close();  // libtiff writes by itself
    errno = 0;
    m_tiff.reset(open_tiff_quietly(m_file.temporary_path(), total > kLargestPlainTiff ? "w8" : "w",
                                   m_message));
    if (!m_tiff) fail();
  }

  void write_slice(const void* values) override {
    set_tags();
    const auto* bytes = static_cast<const char*>(values);
    const int height = m_geometry.dims().y;
    std::uint32_t strip = 0;
    for (int j = 0; j < height; j += m_rows, ++strip) {
      const auto size = std::size_t(m_row_bytes * std::min(m_rows, height - j));
      std::memcpy(m_strip.data(), bytes, size);  // predictors work in place
      bytes += size;
      require(TIFFWriteEncodedStrip(m_tiff.get(), strip, m_strip.data(), tmsize_t(size)) >= 0);
    }
    require(TIFFWriteDirectory(m_tiff.get()) != 0);
    ++m_slices;
  }

  void commit() override {
    if (m_slices != m_geometry.dims().z) {
      throw Error(m_file.final_path() + ": fewer slices were written than the volume has");
    }
    errno = 0;
    m_tiff.reset();
    require(m_message.empty());
    m_file.commit();
  }

  std::vector<std::string> warnings() const override {
    const std::string lost = lost_geometry(m_geometry);
    if (lost.empty()) return {};
    return {lost};
  }

 private:
  struct Closer {
    void operator()(TIFF* tiff) const { TIFFClose(tiff); }
  };

  [[noreturn]] void fail() const {
    const std::string reason = errno != 0 ? std::strerror(errno) : m_message;
    throw SystemError(m_file.final_path() + ": cannot write: " + reason);
  }
  void require(bool done) const {
    if (!done || !m_message.empty()) fail();
  }

  void set_tags() {
    errno = 0;
    TIFF* tiff = m_tiff.get();
    const Vec3i& dims = m_geometry.dims();
    const Vec3d spacing = m_geometry.spacing_mm();
    const int format = is_float(m_type)    ? SAMPLEFORMAT_IEEEFP
                       : is_signed(m_type) ? SAMPLEFORMAT_INT
                                           : SAMPLEFORMAT_UINT;
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, std::uint32_t(dims.x));
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, std::uint32_t(dims.y));
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 8 * bytes_of(m_type));
    TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, format);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
    TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, std::uint32_t(m_rows));
    TIFFSetField(tiff, TIFFTAG_XRESOLUTION, 1 / spacing.x);
    TIFFSetField(tiff, TIFFTAG_YRESOLUTION, 1 / spacing.y);
    TIFFSetField(tiff, TIFFTAG_RESOLUTIONUNIT, RESUNIT_NONE);
    TIFFSetField(tiff, TIFFTAG_COMPRESSION,
                 m_compress ? COMPRESSION_ADOBE_DEFLATE : COMPRESSION_NONE);
    if (m_compress && !is_float(m_type)) {
      TIFFSetField(tiff, TIFFTAG_PREDICTOR, PREDICTOR_HORIZONTAL);
    }
    if (m_slices == 0) {
      TIFFSetField(tiff, TIFFTAG_IMAGEDESCRIPTION, description_of(m_geometry).c_str());
    }
    require(true);
  }

  OutputFile m_file;
  Geometry m_geometry;
  ValueType m_type;
  bool m_compress;
  std::int64_t m_row_bytes = 0;
  int m_rows = 1;  // of a strip
  int m_slices = 0;
  std::vector<char> m_strip;
  std::string m_message;
  std::unique_ptr<TIFF, Closer> m_tiff;
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
