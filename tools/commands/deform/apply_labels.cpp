#include "tools/commands/deform/apply_labels.h"

#include <atomic>
#include <cmath>

#include "tools/commands/deform/moved_places.h"
#include "volumes/base/json.h"
#include "volumes/base/parallel.h"
#include "volumes/field/dense/grid_positions.h"
#include "volumes/io/format/dense_writer.h"

namespace supple::tools {

namespace {

/// `find(i, j, k, place)`: LPS mm of the place whose label a voxel takes; false for none.
template <class Find>
LabelReport write(const std::string& path, const StoredLabels& labels, const Geometry& grid,
                  const Find& find, Console& console) {
  DenseImage image;
  image.geometry = grid;
  image.type = labels.type();
  image.label_names = labels.names();
  const auto writer = create_dense(path, image);
  LabelReport result{grid, labels.counts(), {}};
  const Vec3i& dims = grid.dims();
  const std::size_t bytes = std::size_t(labels.bytes_per_voxel());
  const std::size_t voxels = std::size_t(dims.x) * dims.y;
  console.stage("writing");
  for (int k = 0; k < dims.z; ++k) {
    std::vector<char> slice(voxels * bytes, 0);
    parallel_for(dims.y, [&](int j) {
      for (int i = 0; i < dims.x; ++i) {
        Vec3d place;
        if (find(i, j, k, place)) {
          labels.nearest(place, &slice[(std::size_t(j) * dims.x + i) * bytes]);
        }
      }
    });
    count_labels(labels.type(), slice.data(), voxels, result.after);
    writer->write_slice(slice.data());
    report(&console, double(k + 1) / dims.z);
  }
  writer->commit();
  warn_of_all(path, writer->warnings(), &console);
  return result;
}

Value number(double label) {
  if (std::abs(label) < 9e18) return std::int64_t(label);
  return label;
}

}  // namespace

LabelReport write_labels(const std::string& path, const StoredLabels& labels,
                         const OffsetField& offsets, const Geometry& grid, Console& console) {
  const GridPositions positions(grid, offsets.geometry);
  const auto find = [&](int i, int j, int k, Vec3d& place) {
    Vec3d source;
    if (!offsets.source_of(positions.at(i, j, k), source)) return false;
    place = offsets.geometry.world_from_index(source);
    return true;
  };
  return write(path, labels, grid, find, console);
}

LabelReport write_labels(const std::string& path, const StoredLabels& labels,
                         const PointMotion& motion, const Geometry& grid, Console& console) {
  std::atomic<std::int64_t> unresolved{0};
  const auto find = [&](int i, int j, int k, Vec3d& place) {
    const MovedPoint moved = motion.move(grid.world_from_index(Vec3d(i, j, k)));
    place = moved.to_lps_mm;
    if (moved.kind == PlaceKind::unresolved) ++unresolved;
    return moved.kind != PlaceKind::unresolved && moved.kind != PlaceKind::outside;
  };
  LabelReport result = write(path, labels, grid, find, console);
  result.unresolved = unresolved;
  return result;
}

void warn_of(const LabelReport& report, const std::string& path, Console& console) {
  std::string gone;
  std::int64_t count = 0;
  for (const auto& [label, voxels] : report.before) {
    if (report.after.count(label) != 0) continue;
    if (++count <= 5) gone += (gone.empty() ? "" : ", ") + json_text(number(label));
  }
  if (count > 5) gone += ", …";
  if (count > 0) console.warn(path + ": " + with_count(count, "label") + " gone: " + gone);
  if (report.unresolved > 0) {
    console.warn(path + ": " + with_count(report.unresolved, "voxel") +
                 " could not be found and are 0");
  }
}

Value to_value(const LabelReport& report) {
  const Vec3i& dims = report.grid.dims();
  Value json = {{"dims", {dims.x, dims.y, dims.z}},
                {"unresolved", report.unresolved},
                {"labels", Value::List()}};
  for (const auto& [label, voxels] : report.before) {
    if (json["labels"].size() == kListed) break;
    const auto after = report.after.find(label);
    json["labels"].push_back({{"label", number(label)},
                              {"voxels_before", voxels},
                              {"voxels_after", after == report.after.end() ? 0 : after->second}});
  }
  return json;
}

}  // namespace supple::tools
