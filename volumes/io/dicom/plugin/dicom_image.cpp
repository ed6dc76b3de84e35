#include "volumes/io/dicom/plugin/dicom_image.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "volumes/base/error.h"
#include "volumes/io/dicom/plugin/frame_reader.h"
#include "volumes/io/dicom/plugin/phase_order.h"

namespace supple {

namespace {

int integer_of(const std::string& path, DcmItem& dataset, const DcmTagKey& tag, std::int64_t lowest,
               std::int64_t highest) {
  const HeaderField field = field_of(path, dataset, tag);
  const std::int64_t value = field.integer();
  if (value >= lowest && value <= highest) return int(value);
  field.fail(std::to_string(lowest) + " to " + std::to_string(highest));
}

int integer_or(const std::string& path, DcmItem& dataset, const DcmTagKey& tag, int fallback,
               int lowest, int highest) {
  if (text_of(dataset, tag).empty()) return fallback;
  return integer_of(path, dataset, tag, lowest, highest);
}

template <class T>
void unpack(const PixelFormat& format, char* values) {
  const std::size_t count = std::size_t(format.rows) * format.columns;
  const int shift = format.high_bit + 1 - format.bits_stored;
  const std::uint32_t mask = ~std::uint32_t(0) >> (32 - format.bits_stored);
  const std::uint32_t sign = format.is_signed ? std::uint32_t(1) << (format.bits_stored - 1) : 0;
  for (std::size_t n = 0; n < count; ++n) {
    T bits;
    std::memcpy(&bits, values + n * sizeof(T), sizeof(T));
    // (x ^ sign) - sign extends the sign bit.
    bits = T((((std::uint32_t(bits) >> shift) & mask) ^ sign) - sign);
    std::memcpy(values + n * sizeof(T), &bits, sizeof(T));
  }
}

}  // namespace

ValueType PixelFormat::type() const {
  if (bits_allocated == 8) return is_signed ? ValueType::int8 : ValueType::uint8;
  if (bits_allocated == 16) return is_signed ? ValueType::int16 : ValueType::uint16;
  return is_signed ? ValueType::int32 : ValueType::uint32;
}

PixelFormat pixel_format(const std::string& path, DcmItem& dataset) {
  const HeaderField photometric = field_of(path, dataset, DCM_PhotometricInterpretation);
  if (photometric.text != "MONOCHROME1" && photometric.text != "MONOCHROME2") {
    photometric.fail("MONOCHROME1 or MONOCHROME2 (grey)");
  }
  if (integer_or(path, dataset, DCM_SamplesPerPixel, 1, 0, 65535) != 1) {
    field_of(path, dataset, DCM_SamplesPerPixel).fail("1 (grey)");
  }
  const HeaderField lut = {path, name_of(DCM_ModalityLUTSequence), "a table of values"};
  if (dataset.tagExists(DCM_ModalityLUTSequence)) lut.fail("RescaleSlope and RescaleIntercept");

  PixelFormat format;
  format.rows = integer_of(path, dataset, DCM_Rows, 1, 65535);
  format.columns = integer_of(path, dataset, DCM_Columns, 1, 65535);
  format.bits_allocated = integer_of(path, dataset, DCM_BitsAllocated, 1, 65535);
  if (format.bits_allocated != 8 && format.bits_allocated != 16 && format.bits_allocated != 32) {
    field_of(path, dataset, DCM_BitsAllocated).fail("8, 16 or 32");
  }
  const int allocated = format.bits_allocated;
  format.bits_stored = integer_or(path, dataset, DCM_BitsStored, allocated, 1, allocated);
  format.high_bit = integer_or(path, dataset, DCM_HighBit, format.bits_stored - 1,
                               format.bits_stored - 1, allocated - 1);
  format.is_signed = integer_or(path, dataset, DCM_PixelRepresentation, 0, 0, 1) == 1;
  format.inverted = photometric.text == "MONOCHROME1";
  return format;
}

void unpack_stored_bits(const PixelFormat& format, void* values) {
  if (format.bits_stored == format.bits_allocated) return;
  char* bytes = static_cast<char*>(values);
  if (format.bits_allocated == 8) unpack<std::uint8_t>(format, bytes);
  if (format.bits_allocated == 16) unpack<std::uint16_t>(format, bytes);
  if (format.bits_allocated == 32) unpack<std::uint32_t>(format, bytes);
}

void invert_rescale(const PixelFormat& format, double& slope, double& intercept) {
  if (!format.inverted) return;
  // Mirrored in the stored range: lowest + highest - stored.
  const double sum = format.is_signed ? -1 : double(~std::uint32_t(0) >> (32 - format.bits_stored));
  intercept += slope * sum;
  slope = -slope;
}

namespace {

/// An attribute of one frame: in its own functional group, in the shared one, or at the top.
class FrameAttributes {
 public:
  FrameAttributes(std::string path, DcmItem& dataset, DcmItem* own)
      : m_path(std::move(path)), m_dataset(dataset), m_own(own) {
    dataset.findAndGetSequenceItem(DCM_SharedFunctionalGroupsSequence, m_shared);
  }

  HeaderField field(const DcmTagKey& group, const DcmTagKey& tag) const {
    for (DcmItem* groups : {m_own, m_shared}) {
      DcmItem* item = nullptr;
      if (groups == nullptr || groups->findAndGetSequenceItem(group, item).bad()) continue;
      const HeaderField found = field_of(m_path, *item, tag);
      if (!found.text.empty()) return found;
    }
    return field_of(m_path, m_dataset, tag);
  }
  double number_or(const DcmTagKey& group, const DcmTagKey& tag, double fallback) const {
    const HeaderField found = field(group, tag);
    return found.text.empty() ? fallback : numbers_of(found, 1)[0];
  }
  /// For attributes that only order planes: what is no number does not count.
  double order_of(const DcmTagKey& group, const DcmTagKey& tag) const {
    try {
      return number_or(group, tag, 0);
    } catch (const InputError&) {
      return 0;
    }
  }

 private:
  std::string m_path;
  DcmItem& m_dataset;
  DcmItem* m_own;
  DcmItem* m_shared = nullptr;
};

Vec3d vector_of(const std::vector<double>& numbers, std::size_t first = 0) {
  return {numbers[first], numbers[first + 1], numbers[first + 2]};
}

void read_place(const FrameAttributes& frame, const ReadOptions& options, ImagePlane& plane) {
  const HeaderField position = frame.field(DCM_PlanePositionSequence, DCM_ImagePositionPatient);
  plane.position = vector_of(numbers_of(position, 3));
  const HeaderField orientation =
      frame.field(DCM_PlaneOrientationSequence, DCM_ImageOrientationPatient);
  const std::vector<double> cosines = numbers_of(orientation, 6);
  plane.row = vector_of(cosines);
  plane.column = vector_of(cosines, 3);
  constexpr double kTolerance = 1e-2;
  if (std::abs(plane.row.length() - 1) > kTolerance ||
      std::abs(plane.column.length() - 1) > kTolerance ||
      std::abs(plane.row.dot(plane.column)) > kTolerance) {
    orientation.fail("two perpendicular unit vectors");
  }
  plane.row = plane.row.normalized();
  plane.column = plane.column.normalized();

  const HeaderField spacing = frame.field(DCM_PixelMeasuresSequence, DCM_PixelSpacing);
  const bool is_replaced = spacing.text.empty() && options.spacing_mm;
  const std::vector<double> lengths =
      is_replaced ? std::vector<double>{1, 1} : numbers_of(spacing, 2);
  if (!(lengths[0] > 0) || !(lengths[1] > 0)) spacing.fail("two positive lengths in mm");
  plane.row_mm = lengths[0];
  plane.column_mm = lengths[1];
  plane.thickness_mm =
      std::abs(frame.number_or(DCM_PixelMeasuresSequence, DCM_SpacingBetweenSlices,
                               frame.number_or(DCM_PixelMeasuresSequence, DCM_SliceThickness, 0)));
}

void read_rescale(const FrameAttributes& frame, const PixelFormat& format, ImagePlane& plane) {
  const DcmTagKey group = DCM_PixelValueTransformationSequence;
  plane.slope =
      frame.number_or(group, DCM_RescaleSlope, 1) * frame.number_or(group, DCM_DoseGridScaling, 1);
  plane.intercept = frame.number_or(group, DCM_RescaleIntercept, 0);
  invert_rescale(format, plane.slope, plane.intercept);
}

void read_phase(const FrameAttributes& frame, ImagePlane& plane) {
  const DcmTagKey content = DCM_FrameContentSequence;
  for (const PhaseAttribute& attribute : phase_attributes()) {
    const auto text = [&](const DcmTagKey& tag) { return frame.field(attribute.group, tag).text; };
    double number = 0;
    if (attribute.form == PhaseForm::number) {
      number = frame.order_of(attribute.group, attribute.tag);
    } else if (attribute.form == PhaseForm::date_time) {
      number = seconds_of_date_time(text(attribute.tag));
    } else if (const std::string time = text(attribute.tag); !time.empty()) {
      number = seconds_of(text(attribute.date), time);
    }
    plane.phase.push_back(number);
  }
  plane.phase.back() = double(plane.frame);
  HeaderField index = frame.field(content, DCM_DimensionIndexValues);
  std::replace(index.text.begin(), index.text.end(), '\\', ' ');
  if (index.text.empty()) return;
  const std::vector<double> dimensions = index.numbers();
  plane.phase.insert(plane.phase.end(), dimensions.begin(), dimensions.end());
}

/// A dose grid or another stack whose frames are offsets along the normal from the first.
void place_by_offsets(const std::string& path, DcmItem& dataset, std::vector<ImagePlane>& planes) {
  const HeaderField field = field_of(path, dataset, DCM_GridFrameOffsetVector);
  if (field.text.empty()) {
    const HeaderField groups = {path, name_of(DCM_PerFrameFunctionalGroupsSequence), ""};
    groups.fail("the position of each of " + std::to_string(planes.size()) + " frames");
  }
  const std::vector<double> offsets = numbers_of(field, planes.size());
  for (std::size_t n = 0; n < planes.size(); ++n) {
    const Vec3d normal = planes[n].row.cross(planes[n].column);
    planes[n].position += normal * (offsets[n] - offsets[0]);
  }
}

void read_planes(DcmItem& dataset, int frames, const ReadOptions& options, DicomImage& image) {
  DcmSequenceOfItems* groups = nullptr;
  dataset.findAndGetSequence(DCM_PerFrameFunctionalGroupsSequence, groups);
  if (groups != nullptr && groups->card() != unsigned(frames)) {
    const HeaderField field = {image.path, name_of(DCM_PerFrameFunctionalGroupsSequence),
                               std::to_string(groups->card()) + " items"};
    field.fail(std::to_string(frames) + ", the NumberOfFrames");
  }
  DcmObject* own = nullptr;
  image.planes.resize(std::size_t(frames));
  for (int f = 0; f < frames; ++f) {
    if (groups != nullptr) own = groups->nextInContainer(own);
    ImagePlane& plane = image.planes[std::size_t(f)];
    plane.frame = f;
    const FrameAttributes frame(image.path, dataset, dynamic_cast<DcmItem*>(own));
    read_place(frame, options, plane);
    read_rescale(frame, image.format, plane);
    read_phase(frame, plane);
  }
  if (groups == nullptr && frames > 1) place_by_offsets(image.path, dataset, image.planes);
}

/// True if a value of ImageType says that the image is a localizer.
bool is_scout(DcmItem& dataset) {
  const std::string types = "\\" + text_of(dataset, DCM_ImageType) + "\\";
  return types.find("\\LOCALIZER\\") != std::string::npos;
}

int frames_of(const std::string& path, DcmItem& dataset) {
  const HeaderField field = field_of(path, dataset, DCM_NumberOfFrames);
  if (field.text.empty()) return 1;
  const std::int64_t frames = field.integer();
  if (frames < 1 || frames > INT32_MAX) field.fail("1 or more");
  return int(frames);
}

}  // namespace

std::optional<SeriesMember> series_member(DicomFile& file) {
  DcmItem& dataset = *file.dataset;
  if (!dataset.tagExists(DCM_Rows) || !dataset.tagExists(DCM_Columns)) return {};
  return SeriesMember{text_of(dataset, DCM_SeriesInstanceUID),
                      text_of(dataset, DCM_SeriesDescription),
                      frames_of(file.file->path(), dataset) > 1};
}

DicomImage read_image(DicomFile& file, const ReadOptions& options) {
  require_syntax(file);
  DcmItem& dataset = *file.dataset;
  DicomImage image;
  image.path = file.file->path();
  image.series_uid = text_of(dataset, DCM_SeriesInstanceUID);
  image.description = text_of(dataset, DCM_SeriesDescription);
  image.instance_uid = text_of(dataset, DCM_SOPInstanceUID);
  image.modality = text_of(dataset, DCM_Modality);
  image.syntax = file.syntax;
  image.data_offset = file.data_offset;
  image.lossy = text_of(dataset, DCM_LossyImageCompression) == "01" ||
                file.syntax == EXS_JPEGProcess1 || file.syntax == EXS_JPEGProcess2_4;
  image.is_scout = is_scout(dataset);
  image.format = pixel_format(image.path, dataset);
  const int frames = frames_of(image.path, dataset);
  image.pixels = check_pixels(file, image.format, frames);
  read_planes(dataset, frames, options, image);
  return image;
}

}  // namespace supple
