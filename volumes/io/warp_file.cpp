#include "volumes/io/warp_file.h"

#include <algorithm>
#include <cmath>

#include "volumes/io/bytes/text_header.h"
#include "volumes/io/bytes/value_type.h"
#include "volumes/io/format/formats.h"
#include "volumes/io/open_volume.h"

namespace supple {

namespace {

std::optional<WarpDirection> parse_direction(const VolumeHeader& header) {
  const std::string& name = header.warp_direction;
  if (name.empty()) return {};
  if (name == "resample") return WarpDirection::resample;
  if (name == "material") return WarpDirection::material;
  HeaderField{header.path, "supple direction", name}.fail("resample or material");
}

/// One slice as floats in LPS; returns how many vectors are not finite.
std::int64_t convert_slice(const VolumeHeader& header, const std::vector<char>& stored,
                           std::vector<double>& values, Vec3f* out) {
  scale_values_of(header.type)(stored.data(), values.size(), header.slope, header.intercept,
                               values.data());
  const Vec3d to_lps = header.vectors_in_ras ? Vec3d(-1, -1, 1) : Vec3d(1);
  std::int64_t bad = 0;
  for (std::size_t n = 0; n < values.size() / 3; ++n) {
    out[n] = Vec3f(Vec3d(values[3 * n], values[3 * n + 1], values[3 * n + 2]) * to_lps);
    bad += !(std::isfinite(out[n].x) && std::isfinite(out[n].y) && std::isfinite(out[n].z));
  }
  return bad;
}

}  // namespace

Warp read_warp(const std::string& path, Progress* progress, const Geometry* grid) {
  ReadOptions options;
  options.grid = grid;
  const auto file = open_scalars_or_vectors(path, options);
  const VolumeHeader& header = file->header();
  if (header.components != 3 || !header.are_vectors) {
    const std::string count = header.components == 1 ? "one component"
                              : header.components == 3
                                  ? "colours or other triples"
                                  : std::to_string(header.components) + " components";
    throw InputError({path, "values", count + " per voxel", "a warp: three components per voxel"});
  }
  Warp warp{path, header.geometry, parse_direction(header), {}};
  if (progress != nullptr) progress->stage("reading");

  const Vec3i& dims = header.geometry.dims();
  const std::size_t slice = std::size_t(dims.x) * dims.y;
  warp.vectors.resize(slice * dims.z);
  std::vector<double> values(3 * slice);
  std::vector<char> stored(values.size() * bytes_of(header.type));
  std::int64_t bad = 0;
  for (int k = 0; k < dims.z; ++k) {
    file->read_slice(stored.data());
    bad += convert_slice(header, stored, values, &warp.vectors[slice * k]);
    report(progress, double(k + 1) / dims.z);
  }
  if (bad > 0) {
    throw InputError({path, "vectors", std::to_string(bad) + " that are not finite",
                      "finite numbers in every component"});
  }
  return warp;
}

}  // namespace supple
