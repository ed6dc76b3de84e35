#include "tools/commands/deform/apply_labels.h"

#include <atomic>
#include <cmath>

#include "tools/commands/deform/moved_places.h"
#include "volumes/base/json.h"
#include "volumes/io/format/dense_writer.h"
#include "volumes/io/load/followed_labels.h"

namespace supple::tools {

namespace {

LabelReport write(const std::string& path, const StoredLabels& labels, const Geometry& grid,
                  const LabelSliceSource& slices, Console& console) {
  DenseImage image;
  image.geometry = grid;
  image.type = labels.type();
  image.label_names = labels.names();
  const auto writer = create_dense(path, image);
  LabelReport result{grid, labels.counts(), {}};
  const Vec3i& dims = grid.dims();
  const std::size_t voxels = std::size_t(dims.x) * dims.y;
  std::vector<char> slice(voxels * std::size_t(labels.bytes_per_voxel()));
  console.stage("writing");
  for (int k = 0; k < dims.z; ++k) {
    slices(k, slice.data());
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
  return write(path, labels, grid, followed_labels(labels, offsets, grid), console);
}

LabelReport write_labels(const std::string& path, const StoredLabels& labels,
                         const PointMotion& motion, const Geometry& grid, Console& console) {
  std::atomic<std::int64_t> unresolved{0};
  LabelReport result =
      write(path, labels, grid, followed_labels(labels, motion, grid, unresolved), console);
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
