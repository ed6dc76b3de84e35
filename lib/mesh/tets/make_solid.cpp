#include "lib/mesh/tets/make_solid.h"

#include <cmath>
#include <numeric>

#include "lib/mesh/tets/solid_faces.h"
#include "lib/mesh/tets/solid_quality.h"

namespace supple {

namespace {

/// The lattice's tetrahedra per cube: four at each of six faces, which two cubes share: 24 / 2.
constexpr int kTetsPerCube = 12;
/// The part of the voxels' volume by which that of the mesh may differ.
constexpr double kVolumeTolerance = 5e-4;
/// The limit of meshes that are made on the way to that volume.
constexpr int kMostPasses = 4;

double total_volume_mm3(const SolidMesh& mesh) {
  const std::vector<double> volumes = volumes_mm3(mesh);
  return std::accumulate(volumes.begin(), volumes.end(), 0.0);
}

double area_mm2(const SolidMesh& mesh) {
  double area = 0;
  for (const FaceSet& faces : mesh.faces) {
    for (const auto& triangle : faces.triangles) {
      const Vec3d& a = mesh.nodes_lps_mm[std::size_t(triangle[0])];
      const Vec3d& b = mesh.nodes_lps_mm[std::size_t(triangle[1])];
      const Vec3d& c = mesh.nodes_lps_mm[std::size_t(triangle[2])];
      area += (b - a).cross(c - a).length() / 2;
    }
  }
  return area;
}

}  // namespace

void SolidParams::validate() const {
  if (spacing_mm) require(*spacing_mm > 0, "spacing", *spacing_mm, "a positive number of mm");
  require(elements >= 1, "elements", elements, "a number from 1 on");
  require(smooth_voxels >= 0 && smooth_voxels <= 10, "smooth", smooth_voxels, "0 to 10 voxels");
}

double spacing_for(const SolidParams& params, double volume_mm3) {
  return params.spacing_mm.value_or(std::cbrt(kTetsPerCube * volume_mm3 / params.elements));
}

SolidMesh make_tets(const VoxelMask& mask, const SolidParams& params, std::int32_t region,
                    const std::string& name, SolidReport* report, Progress* progress) {
  params.validate();
  if (mask.box.empty()) throw InputError({"", "voxels", "none", "one at least"});
  const double spacing_mm = spacing_for(params, mask.volume_mm3());
  const BccLattice lattice(mask.geometry, mask.box, spacing_mm);
  MaskDistance distance(mask, params.smooth_voxels, progress);
  SolidReport own;
  SolidMesh mesh;
  for (;;) {
    mesh = stuff_surface(distance, lattice, &own.stuffing, progress);
    ++own.passes;
    if (mesh.tets.empty()) {
      throw InputError({"", "spacing",
                        number_text(spacing_mm) + " mm, at which no vertex is inside",
                        "a smaller one"});
    }
    mesh.region_of.assign(mesh.tets.size(), region);
    mesh.faces = faces_of_regions(mesh, {{region, name}});
    const double missing = mask.volume_mm3() - total_volume_mm3(mesh);
    const bool is_near = std::abs(missing) <= kVolumeTolerance * mask.volume_mm3();
    if (!params.keeps_volume || is_near || own.passes == kMostPasses) break;
    const double before = distance.outwards_mm();
    distance.move_surface(missing / area_mm2(mesh));
    if (distance.outwards_mm() == before) break;  // no farther
  }
  own.outwards_mm = distance.outwards_mm();
  if (report != nullptr) *report = own;
  return mesh;
}

}  // namespace supple
