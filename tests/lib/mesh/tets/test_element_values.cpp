// Hexahedra of blocks, and regions and materials of elements by the voxels in them.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "lib/mesh/tets/element_materials.h"
#include "lib/mesh/tets/element_voxels.h"
#include "lib/mesh/tets/make_solid.h"
#include "lib/mesh/tets/solid_faces.h"
#include "lib/mesh/tets/solid_quality.h"
#include "lib/mesh/tets/voxel_hexes.h"
#include "tests/support/errors.h"
#include "volumes/grid/voxel_sets.h"

namespace supple::test {
namespace {

const Vec3i kBlockDims(24, 16, 16);

Geometry block_geometry(bool is_mirrored) {
  return {kBlockDims, {-3, 8, 20}, {Vec3d(0.5, 0, 0), {0, is_mirrored ? -1.0 : 1.0, 0}, {0, 0, 2}}};
}

/// Densities of the block: 100 at i < 12, 200 beyond.
DensityGrid two_halves() {
  const BrickTopology bricks = box_topology(kBlockDims);
  return fill_density_grid(
      bricks,
      [&](std::size_t b, float* out) {
        for (int n = 0; n < kBrickVoxels; ++n) {
          out[n] = (bricks.origin(b) + brick_local(n)).x < 12 ? 100 : 200;
        }
      },
      0);
}

ElasticOfLabels linear_curves() {
  return {{Curve{{{100, 10}, {200, 90}}}, Curve{{{100, 0.45}, {200, 0.3}}}}, {}};
}

}  // namespace

TEST(UnitVoxelHexes, BlocksHalfFullAreElementsOfPositiveVolumeThatShareNodes) {
  for (const bool is_mirrored : {false, true}) {
    const VoxelMask mask = mask_of(block_geometry(is_mirrored), box_topology(kBlockDims));
    for (const int block : {1, 2, 4, 8}) {
      const SolidMesh mesh = make_hexes(mask, block, 3, "block");
      const Vec3i blocks = kBlockDims / block;
      EXPECT_EQ(mesh.hexes.size(), std::size_t(blocks.x * blocks.y * blocks.z));
      EXPECT_EQ(mesh.nodes_lps_mm.size(),
                std::size_t((blocks.x + 1) * (blocks.y + 1) * (blocks.z + 1)));
      for (const double volume : volumes_mm3(mesh)) {
        EXPECT_NEAR(volume, double(block) * block * block, 1e-9);
      }
      ASSERT_EQ(mesh.faces.size(), 1u);
      EXPECT_EQ(mesh.faces[0].name, "block");
      EXPECT_EQ(topology_of(mesh.faces[0].triangles).open_edges, 0);
    }
  }
  const Geometry geometry({8, 8, 8}, Vec3d(0), {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}});
  const VoxelMask corners = mask_of(geometry, topology_of({Vec3i(0), Vec3i(7)}));
  EXPECT_EQ(make_hexes(corners, 1).hexes.size(), 2u);
  EXPECT_NE(input_error([&] { make_hexes(corners, 2); }).find("smaller blocks"), std::string::npos);
  EXPECT_NE(input_error([&] { make_hexes(corners, 3); }).find("hex: found 3"), std::string::npos);
}

TEST(PropertyElementMaterials, ElementsHaveTheMeanOfTheirVoxelsInStepsOfEqualRatio) {
  const VoxelMask mask = mask_of(block_geometry(false), box_topology(kBlockDims));
  SolidParams params;
  params.spacing_mm = 2;
  for (SolidMesh mesh : {make_tets(mask, params), make_hexes(mask, 8)}) {
    give_materials(mesh, mask, two_halves(), linear_curves(), {}, 16);
    ASSERT_EQ(mesh.material_of.size(), mesh.element_count());
    EXPECT_LE(mesh.materials.size(), 16u);
    EXPECT_NEAR(mesh.materials.front().young_kpa, 10, 1);
    EXPECT_NEAR(mesh.materials.front().poisson, 0.45, 0.01);
    EXPECT_NEAR(mesh.materials.back().young_kpa, 90, 5);
    for (std::size_t e = 0; e < mesh.element_count(); ++e) {
      double low = 1e9, high = -1e9;
      const auto take = [&](const auto& nodes) {
        for (const std::int32_t node : nodes) {
          const double i = mask.geometry.index_from_world(mesh.nodes_lps_mm[std::size_t(node)]).x;
          low = std::min(low, i);
          high = std::max(high, i);
        }
      };
      e < mesh.tets.size() ? take(mesh.tets[e]) : take(mesh.hexes[e - mesh.tets.size()]);
      const double young = mesh.materials[std::size_t(mesh.material_of[e])].young_kpa;
      if (high < 11.4) {
        EXPECT_NEAR(young, 10, 1.5);
      } else if (low > 11.6) {
        EXPECT_NEAR(young, 90, 13);
      }
    }
  }
  // A block across the border: half of each, so 50 kPa.
  SolidMesh mesh = make_hexes(mask, 8);
  give_materials(mesh, mask, two_halves(), linear_curves(), {}, 1000);
  ASSERT_EQ(mesh.materials.size(), 3u);
  EXPECT_NEAR(mesh.materials[1].young_kpa, 50, 1e-6);
  EXPECT_NEAR(mesh.materials[1].poisson, 0.375, 1e-6);
}

TEST(UnitElementVoxels, ABlockCountsEachOfItsVoxelsOnce) {
  const Vec3i dims(2, 2, 2);
  const BrickTopology bricks = box_topology(dims);
  const auto value = [](const Vec3i& v) {
    const int n = 1 + v.x + 2 * v.y + 4 * v.z;
    return float(n * n);
  };
  const DensityGrid density = fill_density_grid(
      bricks,
      [&](std::size_t b, float* out) {
        for (int n = 0; n < kBrickVoxels; ++n) out[n] = value(bricks.origin(b) + brick_local(n));
      },
      0);
  const Geometry geometry(dims, Vec3d(0), {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}});
  const VoxelMask mask = mask_of(geometry, bricks);
  SolidMesh mesh = make_hexes(mask, 2);
  ASSERT_EQ(mesh.hexes.size(), 1u);
  give_materials(mesh, mask, density, {{Curve{{{0, 0}, {100, 100}}}, Curve{{{0, 0.3}}}}, {}}, {},
                 1);
  EXPECT_NEAR(mesh.materials.at(0).young_kpa, 204.0 / 8, 1e-9);  // of the squares of 1 to 8
}

TEST(UnitElementVoxels, CentresOnAFaceAlmostParallelToRowsAreWithin) {
  const IndexTet tet({Vec3d(0, 0, 1), {4, 0, 1 + 4e-16}, {0, 4, 1}, {0, 0, 3}});
  int on_face = 0;
  tet.for_each_voxel([&](const Vec3i& voxel) { on_face += voxel.z == 1 ? 1 : 0; });
  EXPECT_EQ(on_face, 15);  // 5 + 4 + 3 + 2 + 1
}

TEST(UnitElementMaterials, LabelsHaveTablesOfTheirOwnAndATableNeedsStiffness) {
  MaterialTable table;
  EXPECT_NE(input_error([&] { elastic_curves(table); }).find("without stiffness"),
            std::string::npos);
  table.stiffness = Curve{{{0, 4}}};
  table.labels[7].stiffness = Curve{{{0, 70}}};
  const ElasticOfLabels elastic = elastic_curves(table);
  EXPECT_EQ(elastic.common.young_kpa(100), 4);
  EXPECT_EQ(elastic.common.poisson(100), kDefaultPoisson);
  EXPECT_EQ(elastic.of_labels.at(7).young_kpa(100), 70);
  const VoxelMask mask = mask_of(block_geometry(false), box_topology(kBlockDims));
  SolidMesh mesh = make_hexes(mask, 4);
  give_materials(
      mesh, mask, two_halves(), elastic, [](const Vec3i& voxel) { return voxel.y < 8 ? 7 : 1; }, 8);
  ASSERT_EQ(mesh.materials.size(), 2u);
  EXPECT_EQ(mesh.materials[1].young_kpa, 70);
}

TEST(UnitSolidFaces, NamesOfRegionsThatFilesWouldWriteAlikeEndInTheirNumber) {
  SolidMesh mesh = make_hexes(mask_of(block_geometry(false), box_topology(kBlockDims)), 8);
  for (std::size_t e = 0; e < mesh.hexes.size(); ++e) mesh.region_of[e] = 1 + std::int32_t(e % 2);
  std::vector<std::string> names;
  for (const FaceSet& faces : faces_of_regions(mesh, {{1, "a b"}, {2, "A-b"}})) {
    names.push_back(faces.name);
  }
  EXPECT_EQ(names, (std::vector<std::string>{"a b", "a b to A-b_2", "A-b_2"}));
}

TEST(PropertyElementRegions, RegionsShareFacesCloseAndHaveTheirVoxelsVolumes) {
  std::vector<Vec3i> voxels;
  const Vec3i dims(40, 40, 40);
  for (int n = 0; n < 64000; ++n) {
    const Vec3i at(n % 40, n / 40 % 40, n / 1600);
    if ((Vec3d(at) - Vec3d(19.5)).length() < 18) voxels.push_back(at);
  }
  const Geometry geometry(dims, Vec3d(0), {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}});
  const VoxelMask mask = mask_of(geometry, topology_of(voxels));
  // A core, and a shell in three parts around it: four labels meet.
  const VoxelLabel label_of = [](const Vec3i& v) {
    const Vec3d from = Vec3d(v) - Vec3d(19.5);
    if (from.length() < 9) return 2;
    return from.x < 1.2 ? 5 : from.y < -0.7 ? 6 : 9;
  };
  SolidParams params;
  params.spacing_mm = 2.5;
  SolidMesh mesh = make_tets(mask, params);
  give_regions(mesh, mask, label_of);
  mesh.faces = faces_of_regions(mesh, {{2, "core"}, {5, "left"}});
  const SolidQuality quality = quality_of(mesh);
  EXPECT_GE(quality.least_dihedral_deg, kLeastDihedralDeg);
  for (const auto& [label, count] : voxels_of_labels(mask, label_of)) {
    EXPECT_NEAR(quality.volume_mm3.at(label) / double(count), 1, 0.03) << label;
  }
  std::map<std::string, std::size_t> sizes;
  for (const FaceSet& faces : mesh.faces) sizes[faces.name] = faces.triangles.size();
  EXPECT_EQ(sizes.size(), 9u);  // three on the outside, three around the core, three between
  EXPECT_GT(sizes["core to left"], 50u);
  EXPECT_GT(sizes["left to region_6"], 50u);
  EXPECT_EQ(sizes.count("core"), 0u);
  for (const std::int32_t region : {2, 5, 6, 9}) {
    SolidMesh part = mesh;
    part.tets.clear();
    part.region_of.clear();
    for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
      if (mesh.region_of[e] == region) part.tets.push_back(mesh.tets[e]);
    }
    EXPECT_EQ(topology_of(faces_of_regions(part).at(0).triangles).open_edges, 0);
  }
}

}  // namespace supple::test
