#include "tests/support/dicom_fixtures.h"

#include <cstdio>
#include <stdexcept>

#include <dcmtk/dcmdata/dcrleerg.h>
#include <dcmtk/dcmjpeg/djencode.h>
#include <dcmtk/dcmjpls/djencode.h>
#include <gtest/gtest.h>

#include "tests/support/dicom_jpeg2000.h"
#include "volumes/io/bytes/value_type.h"

namespace supple::test {

namespace {

void require(const OFCondition& condition) {
  if (condition.bad()) throw std::runtime_error(condition.text());
}

struct Encoders {
  Encoders() {
    OFLog::configure(OFLogger::OFF_LOG_LEVEL);
    DcmRLEEncoderRegistration::registerCodecs();
    DJEncoderRegistration::registerCodecs();
    // Raw: the "cooked" JPEG-LS encoder of DCMTK 3.6.7 uses a pointer that it did not set.
    constexpr bool kCooked = false;
    DJLSEncoderRegistration::registerCodecs(0, 0, 0, 0, kCooked);
  }
  ~Encoders() {
    DJLSEncoderRegistration::cleanup();
    DJEncoderRegistration::cleanup();
    DcmRLEEncoderRegistration::cleanup();
  }
};

void put_number(DcmItem& item, const DcmTagKey& tag, int value) {
  require(item.putAndInsertUint16(tag, Uint16(value)));
}

/// The pixels of slices or frames, one after the other.
void put_pixels(DcmDataset& data, const SeriesFixture& series, const std::vector<int>& slices) {
  const int high_bit = series.high_bit < 0 ? series.bits_stored - 1 : series.high_bit;
  std::string bytes;
  for (const int k : slices) {
    for (int j = 0; j < series.dims.y; ++j) {
      for (int i = 0; i < series.dims.x; ++i) {
        const auto value = std::uint32_t(series.value(i, j, k))
                           << (high_bit + 1 - series.bits_stored);
        bytes.append(reinterpret_cast<const char*>(&value), series.bits_allocated / 8);
      }
    }
  }
  if (bytes.size() % 2 != 0) bytes += '\0';
  if (series.bits_allocated == 8 && !series.bytes_in_words) {
    require(data.putAndInsertUint8Array(DCM_PixelData, reinterpret_cast<const Uint8*>(bytes.data()),
                                        bytes.size()));
  } else {
    require(data.putAndInsertUint16Array(
        DCM_PixelData, reinterpret_cast<const Uint16*>(bytes.data()), bytes.size() / 2));
  }
  put_number(data, DCM_SamplesPerPixel, 1);
  put(data, DCM_PhotometricInterpretation, "MONOCHROME2");
  put_number(data, DCM_Rows, series.dims.y);
  put_number(data, DCM_Columns, series.dims.x);
  put_number(data, DCM_BitsAllocated, series.bits_allocated);
  put_number(data, DCM_BitsStored, series.bits_stored);
  put_number(data, DCM_HighBit, high_bit);
  put_number(data, DCM_PixelRepresentation, series.is_signed ? 1 : 0);
}

std::string position(const SeriesFixture& series, int k) {
  const Vec3d at = series.origin + series.step * k;
  return ds({at.x, at.y, at.z});
}

std::string orientation(const SeriesFixture& series) {
  const Vec3d &r = series.row, &c = series.column;
  return ds({r.x, r.y, r.z, c.x, c.y, c.z});
}

DcmItem& add_item(DcmItem& item, const DcmTagKey& sequence) {
  DcmItem* added = nullptr;
  require(item.findOrCreateSequenceItem(sequence, added, -2));
  return *added;
}

void put_identity(DcmDataset& data, const SeriesFixture& series, const char* sop_class,
                  const std::string& instance) {
  put(data, DCM_SOPClassUID, sop_class);
  put(data, DCM_SOPInstanceUID, series.series + "." + instance);
  put(data, DCM_SeriesInstanceUID, series.series);
  put(data, DCM_StudyInstanceUID, "1.2.826.0.1.3680043.8.498");
  put(data, DCM_FrameOfReferenceUID, "1.2.826.0.1.3680043.8.498.9");
  put(data, DCM_PatientName, "Phantom");
  put(data, DCM_PatientID, "1");
  put(data, DCM_Modality, "CT");
  put(data, DCM_StudyDate, "20200101");
}

}  // namespace

Geometry SeriesFixture::geometry() const {
  return {dims, origin, {row * column_mm, column * row_mm, step}};
}

std::string SeriesFixture::file_name(int k) const {
  return "im" + std::to_string((7 * k + 3) % 97);
}

void SeriesFixture::fill(DcmDataset& data, int k) const {
  put_identity(data, *this, UID_CTImageStorage, std::to_string(k + 1));
  put(data, DCM_SeriesDescription, "Synthetic " + series.substr(series.size() - 1));
  put(data, DCM_InstanceNumber, std::to_string(dims.z - k));
  put(data, DCM_ImagePositionPatient, position(*this, k));
  put(data, DCM_ImageOrientationPatient, orientation(*this));
  put(data, DCM_PixelSpacing, ds({row_mm, column_mm}));
  put(data, DCM_SliceThickness, "9");  // of no meaning where there are several slices
  put_pixels(data, *this, {k});
  if (edit) edit(data, k);
}

std::string SeriesFixture::write(const TemporaryFolder& folder, int k,
                                 const std::string& name) const {
  DcmFileFormat file;
  fill(*file.getDataset(), k);
  const std::string path = folder / (name.empty() ? file_name(k) : name);
  save(file, path, syntax);
  return path;
}

void SeriesFixture::write_all(const TemporaryFolder& folder) const {
  for (int k = 0; k < dims.z; ++k) write(folder, k);
}

void write_enhanced(const std::string& path, const SeriesFixture& series,
                    const std::vector<int>& frames, bool shared_orientation) {
  DcmFileFormat file;
  DcmDataset& data = *file.getDataset();
  put_identity(data, series, UID_EnhancedCTImageStorage, "1");
  put(data, DCM_NumberOfFrames, std::to_string(frames.size()));
  put_pixels(data, series, frames);
  DcmItem& shared = add_item(data, DCM_SharedFunctionalGroupsSequence);
  put(add_item(shared, DCM_PixelMeasuresSequence), DCM_PixelSpacing,
      ds({series.row_mm, series.column_mm}));
  if (shared_orientation) {
    put(add_item(shared, DCM_PlaneOrientationSequence), DCM_ImageOrientationPatient,
        orientation(series));
  }
  for (const int k : frames) {
    DcmItem& own = add_item(data, DCM_PerFrameFunctionalGroupsSequence);
    put(add_item(own, DCM_PlanePositionSequence), DCM_ImagePositionPatient, position(series, k));
    if (!shared_orientation) {
      put(add_item(own, DCM_PlaneOrientationSequence), DCM_ImageOrientationPatient,
          orientation(series));
    }
  }
  if (series.edit) series.edit(data, 0);
  save(file, path, series.syntax);
}

void save(DcmFileFormat& file, const std::string& path, E_TransferSyntax syntax) {
  static const Encoders encoders;
  const bool is_jpeg2000 = syntax == EXS_JPEG2000LosslessOnly || syntax == EXS_JPEG2000;
  if (is_jpeg2000 && !file.getDataset()->canWriteXfer(syntax, EXS_Unknown)) {
    compress_jpeg2000(*file.getDataset(), syntax);
  }
  require(file.getDataset()->chooseRepresentation(syntax, nullptr));
  require(file.saveFile(path.c_str(), syntax));
}

void put(DcmItem& item, const DcmTagKey& tag, const std::string& value) {
  require(item.putAndInsertString(tag, value.c_str()));
}

std::string ds(const std::vector<double>& numbers) {
  std::string text;
  for (const double number : numbers) {
    char part[32];
    std::snprintf(part, sizeof part, "%.10g", number);
    text += (text.empty() ? "" : "\\") + std::string(part);
  }
  return text;
}

std::vector<double> values_of(VolumeFile& file) {
  const VolumeHeader& header = file.header();
  const std::string bytes = read_all(file);
  std::vector<double> values(std::size_t(header.geometry.voxel_count()));
  scale_values_of(header.type)(bytes.data(), values.size(), header.slope, header.intercept,
                               values.data());
  return values;
}

std::vector<double> expected_values(const SeriesFixture& series, double slope, double intercept) {
  std::vector<double> values;
  for (int k = 0; k < series.dims.z; ++k) {
    for (int j = 0; j < series.dims.y; ++j) {
      for (int i = 0; i < series.dims.x; ++i) {
        values.push_back(slope * series.value(i, j, k) + intercept);
      }
    }
  }
  return values;
}

void expect_geometry(const Geometry& found, const Geometry& expected, double tolerance) {
  EXPECT_EQ(found.dims(), expected.dims());
  EXPECT_LE((found.origin_lps_mm() - expected.origin_lps_mm()).length(), tolerance);
  for (int a = 0; a < 3; ++a) {
    EXPECT_LE((found.axes_mm()[a] - expected.axes_mm()[a]).length(), tolerance) << "axis " << a;
  }
}

}  // namespace supple::test
