#include "volumes/io/load/label_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "volumes/base/error.h"
#include "volumes/base/text.h"
#include "volumes/grid/cell.h"
#include "volumes/io/bytes/input_file.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/load/slab_reader.h"

namespace supple {

namespace {

constexpr double kGridTolerance = 1e-3;  // voxels

void check_values(const Slab& slab, const std::string& path) {
  for (std::size_t n = 0; n < slab.values.size(); ++n) {
    const float value = slab.values[n];
    if (value >= 0 && value <= float(kMaxLabel) && value == std::floor(value)) continue;
    const std::size_t row = n / std::size_t(slab.dims.x);
    const Vec3i voxel(int(n % std::size_t(slab.dims.x)), int(row % std::size_t(slab.dims.y)),
                      slab.k0 + int(row / std::size_t(slab.dims.y)));
    throw InputError({path, "label at " + to_text(voxel),
                      std::isnan(value) ? "not a finite number" : number_text(value),
                      "an integer from 0 to " + std::to_string(kMaxLabel)});
  }
}

void take_labels(const Slab& slab, const BrickTopology& elements, BrickValues& labels) {
  float values[kBrickVoxels];
  for (int bj = 0; bj < slab.bricks_y(); ++bj) {
    for (int bi = 0; bi < slab.bricks_x(); ++bi) {
      const std::int32_t b = elements.find(slab.brick_origin(bi, bj));
      if (b < 0) continue;
      slab.gather(bi, bj, values);
      for_each_active(elements.mask(std::size_t(b)), [&](int offset) {
        if (values[offset] == 0) return;
        labels.touch(std::size_t(b))[offset] = std::int32_t(values[offset]);
      });
    }
  }
}

}  // namespace

/// Two affines differ most at a corner of the box.
void require_grid(const VolumeHeader& header, const Geometry& geometry) {
  const Vec3i& dims = geometry.dims();
  if (!(header.geometry.dims() == dims)) {
    throw InputError({header.path, "dims", to_text(header.geometry.dims()),
                      to_text(dims) + ", the grid of the volume that it labels"});
  }
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3i voxel = cell_corner(corner) * (dims - Vec3i(1));
    const Vec3d apart =
        geometry.index_from_world(header.geometry.world_from_index(Vec3d(voxel))) - Vec3d(voxel);
    const double farthest = std::max({std::abs(apart.x), std::abs(apart.y), std::abs(apart.z)});
    if (farthest <= kGridTolerance) continue;
    throw InputError({header.path, "grid",
                      "voxel " + to_text(voxel) + " is " + number_text(farthest) +
                          " voxels from where it should be",
                      "the grid of the volume that it labels, within " +
                          number_text(kGridTolerance) + " voxel"});
  }
}

BrickValues read_labels(VolumeFile& file, const Geometry& geometry, const BrickTopology& elements,
                        Progress* progress) {
  require_grid(file.header(), geometry);
  BrickValues labels(elements.brick_count());
  SlabReader reader(file, progress);
  Slab slab;
  while (reader.next(slab)) {
    check_values(slab, file.header().path);
    take_labels(slab, elements, labels);
  }
  if (labels.empty()) labels.clear();
  return labels;
}

BrickValues read_labels(const std::string& path, const Geometry& geometry,
                        const BrickTopology& elements, Progress* progress) {
  return read_labels(*open_volume(path), geometry, elements, progress);
}

LabelNames label_names(const std::string& path) {
  const bool may_name = std::filesystem::is_regular_file(path) && InputFile(path).head(4) == "NRRD";
  return may_name ? open_volume(path)->header().label_names : LabelNames{};
}

}  // namespace supple
