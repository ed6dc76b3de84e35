// What of a volume is tissue, as far as densities tell: what a preset alone makes a body of, and
// whether a table has the tissue in its domain.
#pragma once

#include <string>
#include <vector>

#include "lib/material/material.h"
#include "volumes/io/load/load.h"

namespace supple {

/// Skin, fat and lung walls lie above, air and most of the lung below: the least density of tissue
/// where densities are Hounsfield units.
constexpr double kTissueHu = -300;

/// A preset without a domain, for a volume of these densities: from kTissueHu to the largest where
/// they are Hounsfield units; where they are not and leave the table's domain, what lies above the
/// least. All other tables as they are.
MaterialTable fitted_to(MaterialTable material, const VolumeStatistics& statistics);

/// What warn_of_domain needs to have counted.
std::vector<CountedRange> tissue_ranges(const MaterialTable& material);

/// One line with numbers where the table's domain misses most of the tissue: in Hounsfield units
/// what lies above kTissueHu, else what lies above the minimum. Empty where it does not, and where
/// a constant table says by `active` what it is for.
std::string warning_of_domain(const MaterialTable& material, const Volume& volume,
                              const std::vector<CountedRange>& counted);

}  // namespace supple
