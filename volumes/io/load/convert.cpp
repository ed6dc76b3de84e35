#include "volumes/io/load/convert.h"

#include <cmath>

#include "volumes/io/bytes/value_type.h"

namespace supple {

namespace {

struct IntegerRange {
  ValueType type;
  double lo, hi;
};

constexpr IntegerRange kIntegers[] = {
    {ValueType::uint8, 0, 255},           {ValueType::int8, -128, 127},
    {ValueType::uint16, 0, 65535},        {ValueType::int16, -32768, 32767},
    {ValueType::uint32, 0, 4294967295.0}, {ValueType::int32, -2147483648.0, 2147483647.0}};

bool is_integer(ValueType type) {
  return type != ValueType::float32 && type != ValueType::float64;
}

bool is_whole(double value) {
  return value == std::floor(value) && std::abs(value) < 4294967296.0;
}

/// Types whose every value a float holds.
bool fits_float(ValueType type) {
  return bytes_of(type) < 4 || type == ValueType::float32;
}

ValueType scaled_type(const VolumeHeader& input, double minimum, double maximum) {
  if (is_integer(input.type) && is_whole(input.slope) && is_whole(input.intercept)) {
    for (const IntegerRange& integer : kIntegers) {
      const bool wide = bytes_of(integer.type) >= bytes_of(input.type);
      if (wide && minimum >= integer.lo && maximum <= integer.hi) return integer.type;
    }
  }
  return fits_float(input.type) ? ValueType::float32 : ValueType::float64;
}

/// Vectors of a file become those of ours: float32 in LPS.
void flip_to_lps(float* vectors, std::size_t count) {
  for (std::size_t n = 0; n < count; ++n) {
    vectors[3 * n] = -vectors[3 * n];
    vectors[3 * n + 1] = -vectors[3 * n + 1];
  }
}

DenseImage image_of(const VolumeHeader& input, const ConvertPlan& plan) {
  DenseImage image;
  image.geometry = input.geometry;
  image.type = plan.type;
  image.slope = plan.slope;
  image.intercept = plan.intercept;
  image.components = input.components;
  image.label_names = input.label_names;
  if (input.components > 1) {
    image.direction = input.warp_direction.empty() ? "resample" : input.warp_direction;
    image.certificate = input.certificate;
  }
  return image;
}

}  // namespace

ConvertPlan plan_conversion(const VolumeHeader& input, const std::string& output, double minimum,
                            double maximum) {
  ConvertPlan plan;
  if (input.components > 1) {
    plan.applies_scaling = true;
    return plan;
  }
  const bool is_scaled = input.slope != 1 || input.intercept != 0;
  plan.type = input.type;
  if (!is_scaled) return plan;
  if (keeps_scaling(output)) {
    plan.slope = input.slope;
    plan.intercept = input.intercept;
    return plan;
  }
  plan.type = scaled_type(input, minimum, maximum);
  plan.applies_scaling = true;
  return plan;
}

std::vector<std::string> convert(VolumeFile& input, const ConvertPlan& plan,
                                 const std::string& output, const WriteOptions& options,
                                 Progress* progress) {
  const VolumeHeader& header = input.header();
  const Vec3i& dims = header.geometry.dims();
  const std::size_t values = std::size_t(dims.x) * dims.y * header.components;
  const std::unique_ptr<DenseWriter> writer = create_dense(output, image_of(header, plan), options);
  if (progress != nullptr) progress->stage("converting");

  std::vector<char> stored(values * bytes_of(header.type));
  std::vector<double> numbers(plan.applies_scaling ? values : 0);
  std::vector<char> written(plan.applies_scaling ? values * bytes_of(plan.type) : 0);
  for (int k = 0; k < dims.z; ++k) {
    input.read_slice(stored.data());
    if (plan.applies_scaling) {
      scale_values_of(header.type)(stored.data(), values, header.slope, header.intercept,
                                   numbers.data());
      store_values(plan.type, numbers.data(), values, written.data());
      if (header.vectors_in_ras) {
        flip_to_lps(reinterpret_cast<float*>(written.data()), values / 3);
      }
    }
    writer->write_slice(plan.applies_scaling ? written.data() : stored.data());
    report(progress, double(k + 1) / dims.z);
  }
  writer->complete(progress);
  writer->commit();
  return writer->warnings();
}

}  // namespace supple
