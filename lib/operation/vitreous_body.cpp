#include "lib/operation/vitreous_body.h"

#include <algorithm>
#include <cmath>

#include "lib/operation/vitreous_density.h"
#include "volumes/base/error.h"

namespace supple {

namespace {

constexpr double kMostVoxels = 400;  // across

/// True where a place keeps its distance from all surfaces.
bool is_free(const Vec3d& place_mm, double clears_mm, const std::vector<Obstacle>& outside) {
  const RoundCone point{place_mm, place_mm, 0, 0};
  return std::all_of(outside.begin(), outside.end(), [&](const Obstacle& obstacle) {
    return approach(point, obstacle.surface).distance_mm >= clears_mm;
  });
}

BrickTopology ball_of(const Geometry& geometry, double radius_voxels, double clears_mm,
                      const std::vector<Obstacle>& outside) {
  const Vec3i& dims = geometry.dims();
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  const Vec3d centre = Vec3d(dims - Vec3i(1)) / 2.0;
  for (int x = 0; x < dims.x; x += kBrickDim) {
    for (int y = 0; y < dims.y; y += kBrickDim) {
      for (int z = 0; z < dims.z; z += kBrickDim) {
        BrickMask mask{};
        for (int n = 0; n < kBrickVoxels; ++n) {
          const Vec3d from = Vec3d(Vec3i(x, y, z) + brick_local(n)) - centre;
          if (from.dot(from) > radius_voxels * radius_voxels) continue;
          const Vec3d place = geometry.world_from_index(Vec3d(Vec3i(x, y, z) + brick_local(n)));
          if (is_free(place, clears_mm, outside)) mask_set(mask, n);
        }
        origins.emplace_back(x, y, z);
        masks.push_back(mask);
      }
    }
  }
  return {std::move(origins), std::move(masks)};
}

/// Elements that lack a neighbour.
SlotSet shell_of(const BrickTopology& elements) {
  std::vector<Slot> slots;
  for_each_element(elements, [&](Slot slot) {
    Slot next;
    int links = 0;
    for (int side = 0; side < 6; ++side) {
      links += neighbour_slot(elements, {}, slot, side / 2, side % 2 == 1, next);
    }
    if (links < 6) slots.push_back(slot);
  });
  return SlotSet(std::move(slots));
}

MaterialTable material_of(const VitreousSetup& setup) {
  MaterialTable material = homogeneous_material(0, 255);
  material.max_length.keys = {{0, setup.stretch}};
  material.min_length.keys = {{0, setup.compression}};
  material.shear1.keys = material.shear2.keys = {{0, setup.shear}};
  material.validate("");
  return material;
}

double radius_in_voxels(const VitreousSetup& setup) {
  require(setup.radius_mm > 0, "radius", setup.radius_mm, "a positive number of mm");
  require(setup.spacing_mm > 0, "spacing", setup.spacing_mm, "a positive number of mm");
  require(setup.clears_mm >= 0, "clears", setup.clears_mm, "0 mm or more");
  const double radius = (setup.radius_mm - setup.clears_mm) / setup.spacing_mm;
  require(radius >= 1.5 && radius <= kMostVoxels / 2, "radius less what it clears, in voxels",
          radius, "1.5 to 200");
  return radius;
}

Geometry geometry_of(const VitreousSetup& setup, const Vec3d& centre_mm) {
  const int across = 2 * int(std::ceil(radius_in_voxels(setup))) + 3;
  const double h = setup.spacing_mm;
  const Vec3d origin = centre_mm - Vec3d(h * (across - 1) / 2);
  return Geometry(Vec3i(across), origin, {Vec3d(h, 0, 0), Vec3d(0, h, 0), Vec3d(0, 0, h)});
}

}  // namespace

Fields fields(VitreousSetup& setup) {
  return {
      Field("radius", setup.radius_mm, "Radius of the ball that it fills").unit("mm").positive(),
      Field("spacing", setup.spacing_mm, "Size of voxels").unit("mm").positive(),
      Field("stretch", setup.stretch, "Longest links, in lengths at rest").range(1, 10),
      Field("compression", setup.compression, "Shortest links, in lengths at rest").range(0.01, 1),
      Field("shear", setup.shear, "Shear of links, in lengths at rest").range(0, 10),
      Field("clears", setup.clears_mm, "Distance to the wall").unit("mm").at_least(0),
  };
}

VitreousAtRest make_vitreous(const VitreousSetup& setup, const Vec3d& centre_mm, std::uint64_t seed,
                             const std::vector<Obstacle>& outside) {
  const double radius = radius_in_voxels(setup);
  const Geometry geometry = geometry_of(setup, centre_mm);
  const BrickTopology elements = ball_of(geometry, radius, setup.clears_mm, outside);
  const Vec3d middle = Vec3d(geometry.dims() - Vec3i(1)) / 2.0;
  VitreousAtRest rest;
  rest.density = make_vitreous_density(elements, middle, radius, seed);
  rest.body = make_body(geometry, rest.density, elements, material_of(setup));
  rest.shell = shell_of(elements);
  return rest;
}

}  // namespace supple
