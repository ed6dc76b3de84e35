#include "volumes/io/volume_writer.h"

#include <cmath>
#include <cstring>
#include <limits>

namespace supple {

namespace {

/// Slices one by one; `fill(k, out)` writes the bytes of slice k. Returns the writer's warnings.
template <class Fill>
std::vector<std::string> write_image(const std::string& path, const DenseImage& image,
                                     const WriteOptions& options, const Fill& fill,
                                     Progress* progress) {
  if (progress != nullptr) progress->stage("writing");
  const std::unique_ptr<DenseWriter> writer = create_dense(path, image, options);
  const Vec3i& dims = image.geometry.dims();
  std::vector<char> slice(std::size_t(dims.x) * dims.y * image.components * bytes_of(image.type));
  for (int k = 0; k < dims.z; ++k) {
    fill(k, slice.data());
    writer->write_slice(slice.data());
    report(progress, double(k + 1) / dims.z);
  }
  writer->complete(progress);
  writer->commit();
  return writer->warnings();
}

template <class Value>
Value rounded(float value) {
  using Limits = std::numeric_limits<Value>;
  if (std::isnan(value)) return Value(0);
  if (double(value) >= double(Limits::max())) return Limits::max();
  if (double(value) <= double(Limits::lowest())) return Limits::lowest();
  return Value(std::llround(std::min(double(value), 9.2e18)));
}

template <>
std::uint64_t rounded<std::uint64_t>(float value) {
  if (!(value > 0)) return 0;
  return value >= 18446744073709551616.0f ? ~std::uint64_t(0) : std::uint64_t(value + 0.5);
}
template <>
float rounded<float>(float value) {
  return value;
}
template <>
double rounded<double>(float value) {
  return value;
}

template <class Value>
void convert_to(const std::vector<float>& values, char* out) {
  for (std::size_t n = 0; n < values.size(); ++n) {
    const Value value = rounded<Value>(values[n]);
    std::memcpy(out + n * sizeof value, &value, sizeof value);
  }
}

void convert(ValueType type, const std::vector<float>& values, char* out) {
  switch (type) {
    case ValueType::int8:
      return convert_to<std::int8_t>(values, out);
    case ValueType::uint8:
      return convert_to<std::uint8_t>(values, out);
    case ValueType::int16:
      return convert_to<std::int16_t>(values, out);
    case ValueType::uint16:
      return convert_to<std::uint16_t>(values, out);
    case ValueType::int32:
      return convert_to<std::int32_t>(values, out);
    case ValueType::uint32:
      return convert_to<std::uint32_t>(values, out);
    case ValueType::int64:
      return convert_to<std::int64_t>(values, out);
    case ValueType::uint64:
      return convert_to<std::uint64_t>(values, out);
    case ValueType::float32:
      return convert_to<float>(values, out);
    case ValueType::float64:
      return convert_to<double>(values, out);
  }
}

}  // namespace

std::vector<std::string> write_volume(const std::string& path, const Geometry& geometry,
                                      ValueType type, const ScalarSliceSource& slices,
                                      Progress* progress, const WriteOptions& options) {
  std::vector<float> values(std::size_t(geometry.dims().x) * geometry.dims().y);
  const auto fill = [&](int k, char* out) {
    slices(k, values.data());
    convert(type, values, out);
  };
  DenseImage image;
  image.geometry = geometry;
  image.type = type;
  return write_image(path, image, options, fill, progress);
}

std::vector<std::string> write_warp(const std::string& path, const WarpFacts& facts,
                                    const VectorSliceSource& slices, Progress* progress,
                                    const WriteOptions& options) {
  std::vector<Vec3f> vectors(std::size_t(facts.geometry.dims().x) * facts.geometry.dims().y);
  const auto fill = [&](int k, char* out) {
    slices(k, vectors.data());
    std::memcpy(out, vectors.data(), vectors.size() * sizeof(Vec3f));
  };
  DenseImage image;
  image.geometry = facts.geometry;
  image.components = 3;
  image.direction = facts.direction == WarpDirection::resample ? "resample" : "material";
  image.certificate = facts.certificate;
  return write_image(path, image, options, fill, progress);
}

}  // namespace supple
