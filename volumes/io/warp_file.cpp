#include "volumes/io/warp_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>

#include "volumes/base/parallel.h"
#include "volumes/io/bytes/input_file.h"
#include "volumes/io/bytes/text_header.h"
#include "volumes/io/bytes/value_type.h"
#include "volumes/io/format/formats.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/transform/transform_volume.h"

namespace supple {

namespace {

/// Bytes in which a transform file says that it is one.
constexpr int kTransformHead = 1024;

std::optional<WarpDirection> parse_direction(const VolumeHeader& header) {
  const std::string& name = header.warp_direction;
  if (name.empty()) return {};
  if (name == "resample") return WarpDirection::resample;
  if (name == "material") return WarpDirection::material;
  HeaderField{header.path, "supple direction", name}.fail("resample or material");
}

/// True if three values per voxel may be a displacement; plain bytes are colours in every format.
bool may_be_displacement(const VolumeHeader& header) {
  const bool are_bytes = header.type == ValueType::uint8 && header.slope == 1;
  return header.components == 3 && header.are_vectors && !are_bytes;
}

/// Converts one slice to floats in LPS; returns how many vectors are not finite.
std::int64_t convert_slice(const VolumeHeader& header, const std::vector<char>& stored,
                           std::vector<double>& values, Vec3f* out) {
  constexpr Grain kGrain{4096};
  const auto scale_values = scale_values_of(header.type);
  const std::size_t bytes = 3 * std::size_t(bytes_of(header.type));
  const Vec3d to_lps = header.vectors_in_ras ? Vec3d(-1, -1, 1) : Vec3d(1);
  const auto convert = [&](std::size_t begin, std::size_t end, std::int64_t bad) {
    scale_values(stored.data() + begin * bytes, 3 * (end - begin), header.slope, header.intercept,
                 &values[3 * begin]);
    for (std::size_t n = begin; n < end; ++n) {
      out[n] = Vec3f(Vec3d(values[3 * n], values[3 * n + 1], values[3 * n + 2]) * to_lps);
      bad += !(std::isfinite(out[n].x) && std::isfinite(out[n].y) && std::isfinite(out[n].z));
    }
    return bad;
  };
  return reduce_ranges(values.size() / 3, kGrain, std::int64_t(0), convert,
                       std::plus<std::int64_t>());
}

}  // namespace

Warp read_warp(const std::string& path, Progress* progress, const Geometry* grid) {
  ReadOptions options;
  options.grid = grid;
  const auto file = open_scalars_or_vectors(path, options);
  const VolumeHeader& header = file->header();
  if (!may_be_displacement(header)) {
    const std::string found = header.components == 1 ? "one component per voxel"
                              : header.components == 3
                                  ? "colours or other triples that are no displacement"
                                  : std::to_string(header.components) + " components per voxel";
    throw InputError({path, "values", found, "a warp: three components per voxel"});
  }
  warn_of_all(path, header.warnings, progress);
  Warp warp{path, header.geometry, parse_direction(header), {}};
  if (progress != nullptr) progress->stage("reading");

  const Vec3i& dims = header.geometry.dims();
  const std::size_t slice = std::size_t(dims.x) * dims.y;
  warp.vectors = WarpVectors(slice * dims.z);
  std::vector<Vec3f> vectors(slice);
  std::vector<double> values(3 * slice);
  std::vector<char> stored(values.size() * bytes_of(header.type));
  std::int64_t bad = 0;
  for (int k = 0; k < dims.z; ++k) {
    file->read_slice(stored.data());
    bad += convert_slice(header, stored, values, vectors.data());
    warp.vectors.put(slice * k, vectors.data(), slice);
    report(progress, double(k + 1) / dims.z);
  }
  if (bad > 0) {
    throw InputError({path, "vectors", std::to_string(bad) + " that are not finite",
                      "finite numbers in every component"});
  }
  return warp;
}

TransformChain read_transform(const std::string& path, Progress* progress, const Geometry* grid) {
  if (std::filesystem::is_regular_file(path)) {
    const TransformKind kind = transform_kind(InputFile(path).head(kTransformHead));
    if (kind != TransformKind::none) return read_chain(path, kind);
  }
  const Warp warp = read_warp(path, progress, grid);
  if (warp.direction == WarpDirection::material) {
    throw InputError({path, "direction", "material", "resample: supple invert gives it"});
  }
  TransformChain chain;
  chain.grid = warp.geometry;
  std::vector<Vec3d> vectors(warp.vectors.size());
  for (std::size_t n = 0; n < vectors.size(); ++n) vectors[n] = Vec3d(warp.vectors[n]);
  chain.links.push_back({field_map(warp.geometry, std::move(vectors)), false});
  return chain;
}

}  // namespace supple
