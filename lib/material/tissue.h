// Tissue of a volume by its densities: the elements that a preset alone chooses, and whether a
// table has the tissue in its domain.
#pragma once

#include <string>
#include <vector>

#include "lib/material/material.h"
#include "volumes/io/load/load.h"

namespace supple {

/// Least density of tissue where densities are Hounsfield units. Skin, fat and lung walls lie
/// above, air and most of the lung below.
constexpr double kTissueHu = -300;

/// A preset without a domain, for a volume of these densities: from kTissueHu to the largest where
/// they are Hounsfield units; where they are not and leave the table's domain, the densities above
/// the least. All other tables as they are.
MaterialTable fitted_to(MaterialTable material, const VolumeStatistics& statistics);

/// Last bin of a picture's background in its histogram, by Otsu's threshold between dark and
/// bright, and within the dark part once more, between air and what is dark in tissue, such as bone
/// and liquor in MRI.
///
/// Source: N. Otsu, A threshold selection method from gray-level histograms, IEEE Trans. Systems,
/// Man and Cybernetics 9, 62-66, 1979. Cost: two passes over the bins.
int last_bin_of_background(const std::vector<std::int64_t>& counts);

/// Elements of a table with `finds_foreground`, whose volume is not in HU, by that histogram, whose
/// bins are as wide as each other from the least density to the largest.
MaterialTable with_foreground(MaterialTable material, const VolumeStatistics& statistics,
                              const std::vector<std::int64_t>& counts);

/// Ranges of densities that warning_of_domain() needs to have counted.
std::vector<CountedRange> tissue_ranges(const MaterialTable& material);

/// Returns a line with numbers where the table's domain misses most of the tissue: in Hounsfield
/// units the voxels above kTissueHu, else those above the minimum. Empty where it does not, and for
/// a constant table that gives `active` densities.
std::string warning_of_domain(const MaterialTable& material, const Volume& volume,
                              const std::vector<CountedRange>& counted);

}  // namespace supple
