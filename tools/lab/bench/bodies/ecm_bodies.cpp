#include "tools/lab/bench/bodies/ecm_bodies.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>

#include "lib/body/slot_set.h"
#include "lib/material/material.h"
#include "tools/lab/bench/bodies/block_topology.h"
#include "tools/lab/bench/bodies/half_sampled_head.h"
#include "tools/scene/plan/calibrate.h"
#include "volumes/base/parallel.h"
#include "volumes/grid/density_grid.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/load/load.h"

namespace supple::tools {

namespace {

using ClassAt = std::function<std::uint8_t(const Vec3i&)>;

/// The example table of design.md section 2.
MaterialTable example_material() {
  return parse_material(
      "domain = [0, 255]\nactive = [0, 255]\nmax_length = [[0, 1.0], [255, 1.5]]\n"
      "min_length = [[0, 1.0], [255, 0.6]]\nshear = [[0, 0.0], [255, 0.7]]\n",
      "bench material");
}

/// 32 well mixed bits of a voxel (the finaliser of MurmurHash3).
std::uint32_t hash_of(const Vec3i& voxel) {
  std::uint32_t h = std::uint32_t(voxel.x) * 0x9e3779b1u ^ std::uint32_t(voxel.y) * 0x85ebca77u ^
                    std::uint32_t(voxel.z) * 0xc2b2ae3du;
  h = (h ^ (h >> 16)) * 0x85ebca6bu;
  h = (h ^ (h >> 13)) * 0xc2b2ae35u;
  return h ^ (h >> 16);
}

std::uint8_t noise_class(const Vec3i& voxel) {
  return std::uint8_t(1 + hash_of(voxel) % 255);
}

/// Shells around the middle of the block, in the block's proportions.
ClassAt shells(const Vec3i& size) {
  const double shortest = std::min({size.x, size.y, size.z});
  const Vec3d middle = (Vec3d(size) - Vec3d(1)) / 2.0;
  const Vec3d scale(shortest / size.x, shortest / size.y, shortest / size.z);
  return [=](const Vec3i& voxel) {
    const double radius = ((Vec3d(voxel) - middle) * scale).length();
    const bool rigid = std::fmod(radius + 8, 16) < 3;
    return std::uint8_t(rigid ? 0 : 200 + hash_of(voxel) % 56);
  };
}

ClassAt waves(const Vec3i& size) {
  constexpr double kRate[3] = {0.05, 0.07, 0.1};
  std::array<std::vector<double>, 3> sines;
  for (int a = 0; a < 3; ++a) {
    for (int n = 0; n < size[a]; ++n) sines[a].push_back(std::sin(kRate[a] * n));
  }
  return [sines](const Vec3i& v) {
    return std::uint8_t(
        std::lround(128 + 100 * (sines[0][v.x] + sines[1][v.y] + sines[2][v.z]) / 3));
  };
}

ClassAt class_of_field(const std::string& field, const Vec3i& size) {
  if (field == "ct") return shells(size);
  if (field == "smooth") return waves(size);
  return noise_class;
}

constexpr Grain kBricks{64};

Body body_at_rest(const Geometry& geometry, BrickTopology elements, const MaterialTable& material,
                  const ClassAt& class_at) {
  Body body;
  body.geometry = geometry;
  body.elements = std::move(elements);
  body.material = material;
  body.slacks = SlackTable(material, geometry.spacing_mm());
  body.links_known_valid = true;
  body.classes.assign(slot_count(body.elements), 0);
  parallel_for(body.elements.brick_count(), kBricks, [&](std::size_t b) {
    for_each_active(body.elements.mask(b), [&](int offset) {
      body.classes[b * kBrickVoxels + std::size_t(offset)] =
          class_at(body.elements.origin(b) + brick_local(offset));
    });
  });
  return body;
}

/// One kind of soft tissue, whose limits exclude folds.
MaterialTable tissue_material() {
  return parse_material(
      "domain = [0, 255]\nmax_length = [[0, 1.5]]\nmin_length = [[0, 0.6]]\nshear = [[0, 0.25]]\n",
      "bench tissue material");
}

/// Voxels of 1 mm.
Geometry geometry_of(const Vec3i& size) {
  return Geometry(size, {0, 0, 0}, {Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 1)});
}

Body ball_of(int diameter, const MaterialTable& material) {
  const Vec3i size(diameter);
  const BrickTopology ball = block_topology(size, [&](const Vec3i& voxel) {
    const Vec3d from_middle = Vec3d(voxel) - (Vec3d(size) - Vec3d(1)) / 2.0;
    return from_middle.length2() <= diameter * diameter / 4.0;
  });
  return body_at_rest(geometry_of(size), ball, material,
                      [](const Vec3i&) { return std::uint8_t(255); });
}

}  // namespace

Body block_body(const std::string& field, const Vec3i& size) {
  return body_at_rest(geometry_of(size), block_topology(size, [](const Vec3i&) { return true; }),
                      example_material(), class_of_field(field, size));
}

Body ball_body(int diameter) {
  return ball_of(diameter, parse_material("domain = [0, 255]\nmax_length = [[0, 3]]\n"
                                          "min_length = [[0, 0.2]]\nshear = [[0, 2]]\n",
                                          "bench ball material"));
}

Body tissue_ball_body(int diameter) {
  return ball_of(diameter, tissue_material());
}

Body even_block_body(const Vec3i& size, const MaterialTable& material) {
  return body_at_rest(geometry_of(size), block_topology(size, [](const Vec3i&) { return true; }),
                      material, [](const Vec3i&) { return std::uint8_t(255); });
}

Body tissue_bar_body(int length) {
  return even_block_body(Vec3i(length, length / 3, length / 3), tissue_material());
}

Body head_phantom_body(const Vec3i& size) {
  const MaterialTable material = parse_material(kHeadMaterial, "bench head material");
  const HalfSampledHead density(size);
  const BrickTopology tissue = block_topology(
      size, [&](const Vec3i& voxel) { return density(voxel) >= material.active_lo; });
  return body_at_rest(head_phantom(size).geometry, largest_components(tissue, 1), material,
                      [&](const Vec3i& voxel) { return material.class_of(density(voxel)); });
}

Body ct_head_body(const std::string& path) {
  const MaterialTable material = parse_material(kHeadMaterial, "bench head material");
  const ElementVolume loaded =
      load_elements(path, {}, material.active_lo, material.active_hi, material.components, 0);
  return make_body(loaded.volume.geometry, loaded.volume.density, loaded.elements, material);
}

Vec3i volume_dims(const std::string& path) {
  return open_volume(path)->header().geometry.dims();
}

std::string head_file(const std::string& given, bool notes_absence, Console& console) {
  constexpr const char* kDefaultHead = "build/data/ct_head.nhdr";
  if (!given.empty()) return given;
  if (std::filesystem::exists(kDefaultHead)) return kDefaultHead;
  if (notes_absence) {
    console.note(std::string("no ") + kDefaultHead + ": rows of ct_head are left out");
  }
  return "";
}

}  // namespace supple::tools
