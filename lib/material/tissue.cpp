#include "lib/material/tissue.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "volumes/base/error.h"
#include "volumes/base/text.h"

namespace supple {

namespace {

/// Places of counted ranges in tissue_ranges().
enum Counted { in_domain, tissue_hu, tissue_hu_in_domain };

/// Threshold of the first `bins` that parts them best: the largest variance between both parts; -1
/// where all values lie in one bin.
int otsu_threshold(const std::vector<std::int64_t>& counts, int bins) {
  double all = 0, all_sum = 0;
  for (int n = 0; n < bins; ++n) {
    all += double(counts[std::size_t(n)]);
    all_sum += n * double(counts[std::size_t(n)]);
  }
  int best = -1;
  double most = 0, below = 0, below_sum = 0;
  for (int n = 0; n + 1 < bins; ++n) {
    below += double(counts[std::size_t(n)]);
    below_sum += n * double(counts[std::size_t(n)]);
    if (below == 0 || below == all) continue;
    const double between = all_sum / all * below - below_sum;
    const double variance = between * between / (below * (all - below));
    if (variance <= most * (1 + 1e-12)) continue;
    most = variance;
    best = n;
  }
  return best;
}

}  // namespace

int last_bin_of_background(const std::vector<std::int64_t>& counts) {
  const int dark = otsu_threshold(counts, int(counts.size()));
  const int air = otsu_threshold(counts, dark + 1);
  return air >= 0 ? air : dark;
}

MaterialTable with_foreground(MaterialTable material, const VolumeStatistics& statistics,
                              const std::vector<std::int64_t>& counts) {
  const double width = (statistics.max - statistics.min) / double(counts.size());
  const double threshold = statistics.min + width * (last_bin_of_background(counts) + 1);
  material.active_lo = threshold;
  material.active_hi = std::max(material.domain_hi, statistics.max);
  material.fits_active = material.finds_foreground = false;
  return material;
}

MaterialTable fitted_to(MaterialTable material, const VolumeStatistics& statistics) {
  const bool is_hu = are_hounsfield_units(statistics.min);
  const bool is_inside =
      statistics.min >= material.domain_lo && statistics.max <= material.domain_hi;
  if (!material.fits_domain || (!is_hu && is_inside)) return material;
  material.domain_lo = std::min(material.domain_lo, is_hu ? kTissueHu : statistics.min);
  material.domain_hi = std::max(material.domain_hi, statistics.max);
  if (material.fits_active) {
    material.active_lo =
        is_hu ? material.domain_lo : std::nextafter(float(statistics.min), float(statistics.max));
    material.active_hi = material.domain_hi;
  }
  material.fits_domain = material.fits_active = false;
  return material;
}

std::vector<CountedRange> tissue_ranges(const MaterialTable& material) {
  const double lo = material.domain_lo, hi = material.domain_hi;
  return {{lo, hi}, {kTissueHu, std::numeric_limits<float>::max()}, {std::max(lo, kTissueHu), hi}};
}

std::string warning_of_domain(const MaterialTable& material, const Volume& volume,
                              const std::vector<CountedRange>& counted) {
  const double lo = material.domain_lo, hi = material.domain_hi;
  const bool is_chosen = material.active_lo != lo || material.active_hi != hi;
  if (material.is_constant() && is_chosen) return "";
  const VolumeStatistics& found = volume.statistics;
  const bool is_hu = are_hounsfield_units(found.min);
  std::int64_t tissue = counted[tissue_hu].voxels, inside = counted[tissue_hu_in_domain].voxels;
  if (!is_hu) {
    tissue = found.above_min_count;
    const std::int64_t at_min = volume.geometry.voxel_count() - found.nan_count -
                                found.infinite_count - found.above_min_count;
    inside = counted[in_domain].voxels - (found.min >= lo && found.min <= hi ? at_min : 0);
  }
  if (2 * inside >= tissue) return "";
  return "the domain, " + number_text(lo) + " to " + number_text(hi) + ", misses " +
         std::to_string(tissue - inside) + " of " + with_count(tissue, "voxel") + " of tissue (" +
         (is_hu ? "at least " + number_text(kTissueHu) + " HU"
                : "above " + number_text(found.min)) +
         "); densities reach from " + number_text(found.min) + " to " + number_text(found.max);
}

}  // namespace supple
