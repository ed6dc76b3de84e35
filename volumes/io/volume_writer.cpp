#include "volumes/io/volume_writer.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>

#include "volumes/base/atomic_file.h"
#include "volumes/io/dense_header.h"

namespace supple {

namespace {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__,
              "values are written as they lie in memory");

enum class Format { nrrd, metaimage };

struct Layout {
  Format format;
  bool detached;  // values in a .raw file beside the header
};

Layout layout_of(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return char(std::tolower(c)); });
  if (extension == ".nrrd") return {Format::nrrd, false};
  if (extension == ".nhdr") return {Format::nrrd, true};
  if (extension == ".mha") return {Format::metaimage, false};
  if (extension == ".mhd") return {Format::metaimage, true};
  throw InputError(
      {path, "extension", extension.empty() ? "none" : extension, ".nrrd, .nhdr, .mha or .mhd"});
}

std::string raw_path(const std::string& path) {
  return std::filesystem::path(path).replace_extension(".raw").string();
}

/// A file written front to back whose errors name the final path.
class Output {
 public:
  explicit Output(const std::string& path)
      : m_file(path), m_stream(m_file.path(), std::ios::binary | std::ios::trunc) {
    check();
  }
  void write(const void* data, std::size_t size) {
    errno = 0;
    m_stream.write(static_cast<const char*>(data), std::streamsize(size));
    check();
  }
  void close() {
    errno = 0;
    m_stream.close();
    check();
  }
  void commit() { m_file.commit(); }

 private:
  void check() const {
    if (m_stream) return;
    throw SystemError(m_file.final_path() +
                      ": cannot write: " + std::strerror(errno != 0 ? errno : EIO));
  }

  AtomicFile m_file;
  std::ofstream m_stream;
};

/// Header and values; `fill(k, out)` writes the bytes of slice k. Both files of a pair are complete
/// before the first of them takes its name.
template <class Fill>
void write_image(const std::string& path, DenseImage image, const Fill& fill, Progress* progress) {
  if (progress != nullptr) progress->stage("writing");
  const Layout layout = layout_of(path);
  if (layout.detached) {
    image.data_file = std::filesystem::path(raw_path(path)).filename().string();
  }
  const std::string header =
      layout.format == Format::nrrd ? nrrd_header(image) : metaimage_header(image, path);

  Output header_file(path);
  std::optional<Output> raw_file;
  if (layout.detached) raw_file.emplace(raw_path(path));
  header_file.write(header.data(), header.size());

  Output& values = raw_file ? *raw_file : header_file;
  const Vec3i& dims = image.geometry.dims();
  std::vector<char> slice(std::size_t(dims.x) * dims.y * image.components * bytes_of(image.type));
  for (int k = 0; k < dims.z; ++k) {
    fill(k, slice.data());
    values.write(slice.data(), slice.size());
    report(progress, double(k + 1) / dims.z);
  }

  if (raw_file) raw_file->close();
  header_file.close();
  if (raw_file) raw_file->commit();
  header_file.commit();
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

void write_volume(const std::string& path, const Geometry& geometry, ValueType type,
                  const ScalarSliceSource& slices, Progress* progress) {
  std::vector<float> values(std::size_t(geometry.dims().x) * geometry.dims().y);
  const auto fill = [&](int k, char* out) {
    slices(k, values.data());
    convert(type, values, out);
  };
  write_image(path, {geometry, type, 1, "", ""}, fill, progress);
}

void write_warp(const std::string& path, const Geometry& geometry, WarpDirection direction,
                const VectorSliceSource& slices, Progress* progress) {
  std::vector<Vec3f> vectors(std::size_t(geometry.dims().x) * geometry.dims().y);
  const auto fill = [&](int k, char* out) {
    slices(k, vectors.data());
    std::memcpy(out, vectors.data(), vectors.size() * sizeof(Vec3f));
  };
  const char* name = direction == WarpDirection::resample ? "resample" : "material";
  write_image(path, {geometry, ValueType::float32, 3, name, ""}, fill, progress);
}

std::vector<std::string> output_files(const std::string& path) {
  if (layout_of(path).detached) return {path, raw_path(path)};
  return {path};
}

}  // namespace supple
