#include "volumes/io/dicom/plugin/pixel_format.h"

#include <cstring>

#include "volumes/base/error.h"

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

}  // namespace supple
