// A solid mesh from voxels, in one call: distance, lattice, stuffing, regions and faces.
// Cost: that of these, at most four times that of stuffing where the volume is kept.
#pragma once

#include <optional>
#include <string>

#include "lib/mesh/tets/mask_distance.h"
#include "lib/mesh/tets/stuffing.h"

namespace supple {

struct SolidParams {
  std::optional<double> spacing_mm;  // of the lattice; most edges are about as long
  double elements = 100'000;         // about so many where no spacing is given
  double smooth_voxels = 1;          // standard deviation of the Gaussian; 0: steps of voxels stay
  /// The surface is moved as a whole, by half a voxel at most, until the mesh has the volume of the
  /// voxels: flat faces between nodes on a round surface have less.
  bool keeps_volume = true;

  /// Throws InputError.
  void validate() const;
};

/// The lattice's spacing: as given, or so that a body of this volume has about so many elements.
double spacing_for(const SolidParams& params, double volume_mm3);

struct SolidReport {
  StuffReport stuffing;
  int passes = 0;          // until the volume was that of the voxels
  double outwards_mm = 0;  // way of the surface to that end
};

/// Tetrahedra of one set of voxels; `region` is their region, `name` that of the face set. Throws
/// InputError where the set is empty, or where the spacing is so wide that nothing is inside.
SolidMesh make_tets(const VoxelMask& mask, const SolidParams& params, std::int32_t region = 1,
                    const std::string& name = "surface", SolidReport* report = nullptr,
                    Progress* progress = nullptr);

}  // namespace supple
