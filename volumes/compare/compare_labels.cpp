#include "volumes/compare/compare_labels.h"

#include <vector>

#include "volumes/base/parallel.h"

namespace supple {

namespace {

LabelOverlaps compare_rows(const Geometry& grid, int k, int j, const LabelLookup& a,
                           const LabelLookup& b, const LabelLookup& mask) {
  LabelOverlaps overlaps;
  for (int i = 0; i < grid.dims().x; ++i) {
    const Vec3d place = grid.world_from_index(Vec3d(i, j, k));
    if (mask && mask(place) == 0) continue;
    const double label_a = a(place), label_b = b(place);
    if (label_a != 0) ++overlaps[label_a].in_a;
    if (label_b != 0) ++overlaps[label_b].in_b;
    if (label_a != 0 && label_a == label_b) ++overlaps[label_a].in_both;
  }
  return overlaps;
}

}  // namespace

LabelOverlaps compare_labels(const Geometry& grid, const LabelLookup& a, const LabelLookup& b,
                             const LabelLookup& mask, Progress* progress) {
  if (progress != nullptr) progress->stage("labels");
  LabelOverlaps all;
  std::vector<LabelOverlaps> rows(std::size_t(grid.dims().y));
  for (int k = 0; k < grid.dims().z; ++k) {
    parallel_for(grid.dims().y,
                 [&](int j) { rows[std::size_t(j)] = compare_rows(grid, k, j, a, b, mask); });
    for (const LabelOverlaps& row : rows) {
      for (const auto& [label, overlap] : row) {
        LabelOverlap& sum = all[label];
        sum.in_a += overlap.in_a;
        sum.in_b += overlap.in_b;
        sum.in_both += overlap.in_both;
      }
    }
    report(progress, double(k + 1) / grid.dims().z);
  }
  return all;
}

std::optional<double> mean_dice(const LabelOverlaps& overlaps) {
  if (overlaps.empty()) return {};
  double sum = 0;
  for (const auto& [label, overlap] : overlaps) sum += overlap.dice();
  return sum / double(overlaps.size());
}

}  // namespace supple
