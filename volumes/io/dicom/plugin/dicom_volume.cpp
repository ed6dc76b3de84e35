#include "volumes/io/dicom/plugin/dicom_volume.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "volumes/base/error.h"
#include "volumes/io/bytes/value_type.h"
#include "volumes/io/dicom/plugin/frame_reader.h"
#include "volumes/io/dicom/plugin/slice_stack.h"

namespace supple {

namespace {

class DicomVolume : public VolumeFile {
 public:
  DicomVolume(const std::string& path, const ReadOptions& options)
      : m_series(find_series(path, options)) {
    check_alike(m_series);
    m_stack = stack_slices(m_series, options);
    m_header.path = path;
    for (const DicomImage& image : m_series.images) m_header.data_files.push_back(image.path);
    m_header.format = "dicom";
    m_header.modality = printable(m_series.images.front().modality);
    m_header.type = m_series.images.front().format.type();
    m_header.warnings = m_series.warnings;
    m_header.warnings.insert(m_header.warnings.end(), m_stack.warnings.begin(),
                             m_stack.warnings.end());
    m_header.frame_names = m_stack.frame_names;
    set_geometry();
    set_rescale();
    warn_of_values();
  }

  void read_slice(void* out) override {
    if (m_slices_read >= m_stack.slices.size()) {
      throw Error(m_header.path + ": more slices were asked for than the volume has");
    }
    const ImagePlane& plane = m_stack.slices[m_slices_read++];
    const DicomImage& image = m_series.images[plane.image];
    if (!m_rescale_each) {
      m_frames.read(image, plane.frame, out);
      return;
    }
    m_stored.resize(std::size_t(image.format.frame_bytes()));
    m_frames.read(image, plane.frame, m_stored.data());
    rescale(image, plane, static_cast<char*>(out));
  }

  void skip_slices(int count) override { m_slices_read += std::size_t(count); }

 private:
  void set_geometry() {
    const ImagePlane& first = m_stack.slices.front();
    const PixelFormat& format = m_series.images.front().format;
    // No more slices than twice the planes, whose number fits 32 bits on any machine.
    const HeaderField sizes = {m_header.path, "image size", ""};
    const Vec3i dims =
        dims_from(sizes, {format.columns, format.rows, std::int64_t(m_stack.slices.size())});
    m_header.geometry =
        make_geometry(m_header.path, dims, m_stack.origin,
                      {first.row * first.column_mm, first.column * first.row_mm, m_stack.step});
  }

  void set_rescale() {
    const ImagePlane& first = m_stack.slices.front();
    m_rescale_each =
        std::any_of(m_stack.slices.begin(), m_stack.slices.end(), [&](const ImagePlane& slice) {
          return slice.slope != first.slope || slice.intercept != first.intercept;
        });
    if (m_rescale_each) {
      m_scale = scale_values_of(m_header.type);
      m_header.type = ValueType::float32;
      m_header.warnings.push_back(
          "slices differ in RescaleSlope and RescaleIntercept; values are float32 after them");
      return;
    }
    m_header.slope = first.slope;
    m_header.intercept = first.intercept;
  }

  void warn_of_values() {
    const std::vector<DicomImage>& images = m_series.images;
    if (images.front().format.inverted) {
      m_header.warnings.push_back("MONOCHROME1: values are inverted, so that bright is high");
    }
    const auto is_flat = [](const ImagePlane& slice) { return slice.slope == 0; };
    if (const auto flat = std::count_if(m_stack.slices.begin(), m_stack.slices.end(), is_flat)) {
      m_header.warnings.push_back("RescaleSlope: slope 0 makes all values equal in " +
                                  std::to_string(flat) + " of " +
                                  std::to_string(m_stack.slices.size()) + " slices");
    }
    if (std::any_of(images.begin(), images.end(), [](const auto& image) { return image.lossy; })) {
      m_header.warnings.push_back("the values were compressed with loss");
    }
  }

  /// slope * stored + intercept of one row after the other.
  void rescale(const DicomImage& image, const ImagePlane& plane, char* out) const {
    const std::size_t columns = std::size_t(image.format.columns);
    const std::size_t row_bytes = columns * (image.format.bits_allocated / 8);
    std::vector<double> values(columns);
    std::vector<float> row(columns);
    for (int j = 0; j < image.format.rows; ++j) {
      m_scale(m_stored.data() + j * row_bytes, columns, plane.slope, plane.intercept,
              values.data());
      std::transform(values.begin(), values.end(), row.begin(),
                     [](double value) { return float(value); });
      std::memcpy(out + j * columns * sizeof(float), row.data(), columns * sizeof(float));
    }
  }

  DicomSeries m_series;
  SliceStack m_stack;
  FrameReader m_frames;
  bool m_rescale_each = false;
  ScaleValues m_scale = nullptr;
  std::vector<char> m_stored;
  std::size_t m_slices_read = 0;
};

}  // namespace

std::unique_ptr<VolumeFile> open_series(const std::string& path, const ReadOptions& options) {
  return std::make_unique<DicomVolume>(path, options);
}

}  // namespace supple
