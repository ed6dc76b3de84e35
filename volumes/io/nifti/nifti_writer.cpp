// NIfTI, one file, plain (.nii) or gzipped (.nii.gz). Version 1, or 2 where a dimension exceeds
// 32767 or the slope leaves the range of a 32-bit float. Source: nifti1.h and nifti2.h; how vectors
// are laid out: itk::NiftiImageIO, ANTs and elastix (dim = 5 nx ny nz 1 3, intent 1007, LPS mm).
// Geometry: nifti_header.h. Sheared axes stay in the sform; warps with such axes are refused, since
// ITK cannot hold them.
// Cost: one component of one slice of memory. The components of vectors lie one volume after the
// other: a plain file is written with seeks; of a gzipped one all but the first component wait in a
// temporary file without a name, in the folder of the result, until the last slice has come.
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>

#include "volumes/base/error.h"
#include "volumes/io/bytes/gzip_stream.h"
#include "volumes/io/bytes/spool_file.h"
#include "volumes/io/bytes/text_header.h"
#include "volumes/io/format/dense_writer.h"
#include "volumes/io/nifti/nifti_extension.h"
#include "volumes/io/nifti/nifti_header.h"

namespace supple {

namespace {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__,
              "values are written as they lie in memory");

// Codes in the order of ValueType.
constexpr std::int16_t kDatatypes[] = {DT_INT8,   DT_UINT8, DT_INT16,  DT_UINT16,  DT_INT32,
                                       DT_UINT32, DT_INT64, DT_UINT64, DT_FLOAT32, DT_FLOAT64};

bool fits_version_1(const DenseImage& image) {
  const Vec3i& dims = image.geometry.dims();
  constexpr int kMostDim = std::numeric_limits<std::int16_t>::max();
  if (dims.x > kMostDim || dims.y > kMostDim || dims.z > kMostDim) return false;
  const double slope = std::abs(image.slope), intercept = std::abs(image.intercept);
  using Floats = std::numeric_limits<float>;
  return slope >= double(Floats::min()) && slope <= double(Floats::max()) &&
         intercept <= double(Floats::max());
}

NiftiHeader header_of(const DenseImage& image, const WriteOptions& options,
                      std::size_t extension_bytes) {
  NiftiHeader header;
  header.version = fits_version_1(image) ? 1 : 2;
  nifti_2_header& values = header.values;
  const bool is_vector = image.components > 1;
  values.dim[0] = is_vector ? 5 : 3;
  for (int a = 1; a < 8; ++a) values.dim[a] = 1;
  for (int a = 0; a < 8; ++a) values.pixdim[a] = 1;
  if (is_vector) {
    values.dim[5] = image.components;
    values.intent_code = options.ras_vectors ? NIFTI_INTENT_DISPVECT : NIFTI_INTENT_VECTOR;
  }
  set_nifti_geometry(image.geometry, values);
  values.datatype = kDatatypes[std::size_t(image.type)];
  values.bitpix = std::int16_t(8 * bytes_of(image.type));
  values.scl_slope = image.slope;
  values.scl_inter = image.intercept;
  values.vox_offset = header.size() + std::int64_t(extension_bytes);
  std::strncpy(values.descrip, "supple", sizeof values.descrip);
  return header;
}

/// Lists what the header rounds or leaves out.
std::vector<std::string> losses_of(const DenseImage& image, const NiftiHeader& header) {
  std::vector<std::string> lines;
  const auto is_float = [](double value) { return double(float(value)) == value; };
  if (header.version == 1 && !(is_float(image.slope) && is_float(image.intercept))) {
    lines.push_back("slope and intercept are rounded to the 32-bit floats of NIfTI-1");
  }
  if (header.values.qform_code == 0) {
    lines.push_back("the axes are in the sform alone, since no qform holds them");
  }
  return lines;
}

class NiftiWriter : public DenseWriter {
 public:
  NiftiWriter(const std::string& path, const DenseImage& image, const WriteOptions& options,
              bool gzipped)
      : m_image(image), m_flips(options.ras_vectors), m_file(path) {
    const Vec3i& dims = image.geometry.dims();
    m_plane_bytes = std::size_t(dims.x) * dims.y * bytes_of(image.type);
    const std::string extension = nifti_extension(image.direction, image.certificate);
    const NiftiHeader header = header_of(image, options, extension.size());
    m_losses = losses_of(image, header);
    m_values_at = header.values.vox_offset;
    if (gzipped) m_gzip.emplace(m_file);
    if (gzipped && image.components > 1) m_spool.emplace(path);
    const std::string head = encode_nifti(header) + extension;
    append(head.data(), head.size());
  }

  void write_slice(const void* slice) override {
    if (m_image.components == 1) {
      append(slice, m_plane_bytes);
      return;
    }
    const auto* vectors = static_cast<const float*>(slice);
    m_plane.resize(m_plane_bytes / sizeof(float));
    for (int c = 0; c < m_image.components; ++c) {
      const bool flips = m_flips && c < 2;
      for (std::size_t n = 0; n < m_plane.size(); ++n) {
        const float value = vectors[n * std::size_t(m_image.components) + std::size_t(c)];
        m_plane[n] = flips ? 0 - value : value;
      }
      put_plane(c);
    }
    ++m_slices;
  }

  /// Deflates the components behind the first one.
  void complete(Progress* progress) override {
    if (!m_spool) return;
    if (progress != nullptr) progress->stage("compressing");
    const std::int64_t planes = std::int64_t(m_image.components - 1) * m_image.geometry.dims().z;
    for (std::int64_t plane = 0; plane < planes; ++plane) {
      m_spool->read_at(plane * std::int64_t(m_plane_bytes), m_plane.data(), m_plane_bytes);
      m_gzip->write(m_plane.data(), m_plane_bytes);
      report(progress, double(plane + 1) / double(planes));
    }
    m_spool.reset();
  }

  void commit() override {
    complete(nullptr);
    if (m_gzip) m_gzip->finish();
    m_file.close();
    m_file.commit();
  }

  std::vector<std::string> warnings() const override { return m_losses; }

 private:
  void append(const void* data, std::size_t size) {
    if (m_gzip) {
      m_gzip->write(data, size);
    } else {
      m_file.write(data, size);
    }
  }

  /// Component `c` of the current slice to its place among the values.
  void put_plane(int c) {
    const auto place_behind = [&](int first) {
      const std::int64_t planes = std::int64_t(c - first) * m_image.geometry.dims().z + m_slices;
      return planes * std::int64_t(m_plane_bytes);
    };
    if (!m_gzip) {
      m_file.seek(m_values_at + place_behind(0));
      m_file.write(m_plane.data(), m_plane_bytes);
    } else if (c == 0) {
      m_gzip->write(m_plane.data(), m_plane_bytes);
    } else {
      m_spool->write_at(place_behind(1), m_plane.data(), m_plane_bytes);
    }
  }

  DenseImage m_image;
  bool m_flips;  // x and y of the vectors, from LPS to RAS
  OutputFile m_file;
  std::optional<GzipStream> m_gzip;
  std::optional<SpoolFile> m_spool;
  std::int64_t m_values_at = 0;
  std::size_t m_plane_bytes = 0;
  std::vector<float> m_plane;
  int m_slices = 0;
  std::vector<std::string> m_losses;
};

}  // namespace

std::unique_ptr<DenseWriter> create_nifti(const std::string& path, const std::string&,
                                          const DenseImage& image, const WriteOptions& options) {
  const bool is_vector = image.components > 1;
  if (is_vector && image.type != ValueType::float32) {
    throw Error(path + ": vectors that are not 32-bit floats");
  }
  if (options.ras_vectors && !is_vector) {
    throw InputError({path, "intent", "a scalar volume", "a NIfTI warp"});
  }
  if (is_vector) require_perpendicular(image, path, "NIfTI warps");
  const std::string name = lower_case(path);
  const bool gzipped = name.size() > 3 && name.compare(name.size() - 3, 3, ".gz") == 0;
  return std::make_unique<NiftiWriter>(path, image, options, gzipped);
}

}  // namespace supple
