// A solid mesh from voxels, in one call: distances, lattice, cleaving, regions and faces.
// Cost: that of these, and of cleaving as often as the volume is not yet that of the voxels.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "lib/mesh/tets/cleaving.h"
#include "volumes/base/fields.h"

namespace supple {

/// Parts that are thinner than the lattice are told, or kept by smaller cubes.
enum class ThinWalls { report, keep };

struct SolidParams {
  std::optional<double> spacing_mm;  // of the lattice; most edges are about as long
  double elements = 100'000;         // about so many where no spacing is given
  double smooth_voxels = 1;          // standard deviation of the Gaussian; 0: steps of voxels stay
  /// Surfaces of labels are moved as wholes, by half a voxel or an eighth of the spacing at most,
  /// until the mesh has the volumes of the voxels: flat faces between nodes on a round surface have
  /// less.
  bool keeps_volume = true;
  int coarser_levels = 0;              // inside, edges become up to 2^this times as long
  ThinWalls thin = ThinWalls::report;  // keep: smaller cubes where they would be lost

  /// Throws InputError.
  void validate() const;
};

/// Settings as people name them.
Fields fields(SolidParams& params);

/// The lattice's spacing: as given, or so that a body of this volume has about so many elements.
double spacing_for(const SolidParams& params, double volume_mm3);

struct SolidReport {
  CleaveReport cleaving;
  int passes = 0;          // until the volume was that of the voxels
  double outwards_mm = 0;  // way of the surface to that end; of several labels the longest
  /// Voxels of parts that are thinner than the lattice, and those of them in no element of their
  /// label.
  std::int64_t thin = 0, thin_lost = 0;
};

/// Tetrahedra of the labels of voxels, which become regions that share faces; `names` are those of
/// the face sets. Throws InputError where the mask is empty, or where the spacing is so wide that
/// nothing is inside.
SolidMesh make_tets(const VoxelMask& mask, const VoxelLabel& label_of, const SolidParams& params,
                    const std::map<std::int32_t, std::string>& names = {},
                    SolidReport* report = nullptr, Progress* progress = nullptr);

/// Makes one region under one name; throws as above.
SolidMesh make_tets(const VoxelMask& mask, const SolidParams& params, std::int32_t region = 1,
                    const std::string& name = "surface", SolidReport* report = nullptr,
                    Progress* progress = nullptr);

}  // namespace supple
