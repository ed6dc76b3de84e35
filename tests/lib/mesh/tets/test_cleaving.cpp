// Cleaving of random masks of one label: angles, volumes, and independence of threads.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/lib/mesh/tets/mesh_cases.h"
#include "tests/support/errors.h"
#include "volumes/base/parallel.h"

namespace supple::test {
namespace {

std::string describe(const SolidMesh& mesh, const SolidQuality& quality) {
  return std::to_string(mesh.tets.size()) + " tetrahedra, angles " +
         std::to_string(quality.least_dihedral_deg) + " to " +
         std::to_string(quality.largest_dihedral_deg);
}

}  // namespace

TEST(PropertyCleaving, AThousandRandomMasksAreMeshedWithinTheProvenAngles) {
  std::mt19937 random(1);
  double least = 180, largest = 0;
  int meshed = 0;
  for (int n = 0; n < 1000; ++n) {
    const Vec3i dims(2 + int(random() % 10), 2 + int(random() % 10), 2 + int(random() % 10));
    const Geometry geometry = random_geometry(random, dims);
    const VoxelMask mask = mask_of(geometry, random_voxels(random, dims));
    SolidParams params;
    const Vec3d size = geometry.spacing_mm();
    const double voxel = std::min({size.x, size.y, size.z});
    params.spacing_mm = voxel * std::uniform_real_distribution<double>(0.4, 1.3)(random);
    params.smooth_voxels = random() % 3 == 0 ? 0 : 1;
    const BccLattice lattice(geometry, mask.box, *params.spacing_mm);
    const LabelField field(mask, {}, params.smooth_voxels, *params.spacing_mm);
    const SolidMesh mesh = cleave(field, lattice, lattice_tets(field, lattice));
    // A lattice of half the size of a voxel misses not even a single one.
    const bool is_fine = *params.spacing_mm < 0.5 * voxel;
    ASSERT_FALSE(is_fine && mesh.tets.empty()) << n;
    if (mesh.tets.empty()) continue;
    ++meshed;
    const SolidQuality quality = quality_of(mesh);
    ASSERT_EQ(quality.turned_inside_out, 0) << n;
    ASSERT_GE(quality.least_dihedral_deg, kLeastDihedralDeg) << n << describe(mesh, quality);
    ASSERT_LE(quality.largest_dihedral_deg, kLargestDihedralDeg) << n << describe(mesh, quality);
    const std::vector<FaceSet> faces = faces_of_regions(mesh);
    ASSERT_EQ(faces.size(), 1u);
    ASSERT_EQ(topology_of(faces[0].triangles).open_edges, 0) << n;
    least = std::min(least, quality.least_dihedral_deg);
    largest = std::max(largest, quality.largest_dihedral_deg);
  }
  EXPECT_GT(meshed, 850);
  EXPECT_LT(least, 15);
  EXPECT_GT(largest, 155);
}

TEST(PropertyCleaving, TheMeshIsTheSameWithAnyNumberOfThreads) {
  const VoxelMask mask = ball(14, {1, 1, 2});
  SolidParams params;
  params.spacing_mm = 1.7;
  const SolidMesh one = on_threads(1, [&] { return make_tets(mask, params); });
  const SolidMesh three = on_threads(3, [&] { return make_tets(mask, params); });
  EXPECT_GT(one.tets.size(), 10'000u);
  EXPECT_EQ(one.tets, three.tets);
  EXPECT_EQ(one.nodes_lps_mm, three.nodes_lps_mm);
  ASSERT_EQ(one.faces.size(), 1u);
  EXPECT_EQ(one.faces[0].triangles, three.faces[0].triangles);
  params.coarser_levels = 2;
  const VoxelLabel label_of = [](const Vec3i& v) { return 1 + (v.x < 41) + 2 * (v.y < v.z); };
  const SolidMesh alone = on_threads(1, [&] { return make_tets(mask, label_of, params); });
  const SolidMesh together = on_threads(3, [&] { return make_tets(mask, label_of, params); });
  EXPECT_EQ(alone.tets, together.tets);
  EXPECT_EQ(alone.nodes_lps_mm, together.nodes_lps_mm);
  EXPECT_EQ(alone.region_of, together.region_of);
}

TEST(PropertyCleaving, AMeshHasTheVolumeOfItsVoxelsAndABallsNodesLieOnItsSurface) {
  for (const Vec3d& spacing : {Vec3d(1), Vec3d(0.8, 0.8, 2)}) {
    const VoxelMask mask = ball(16, spacing);
    SolidParams params;
    params.spacing_mm = 4;
    SolidReport report;
    const SolidMesh mesh = make_tets(mask, params, 7, "ball", &report);
    EXPECT_NEAR(volume_of(mesh), mask.volume_mm3(), 1e-3 * mask.volume_mm3());
    EXPECT_EQ(mesh.region_of, std::vector<std::int32_t>(mesh.tets.size(), 7));
    ASSERT_EQ(mesh.faces.size(), 1u);
    EXPECT_EQ(mesh.faces[0].name, "ball");
    EXPECT_EQ(count_pieces(mesh), 1);
    for (const auto& triangle : mesh.faces[0].triangles) {
      for (const std::int32_t node : triangle) {
        EXPECT_NEAR(mesh.nodes_lps_mm[std::size_t(node)].length(), 16 + report.outwards_mm,
                    0.5 * spacing.z);
      }
    }
    params.keeps_volume = false;
    EXPECT_LT(volume_of(make_tets(mask, params)), 0.985 * mask.volume_mm3());
  }
}

TEST(PropertyCleaving, SmoothingTakesStepsAwayAndDoesNotDrawABallIn) {
  const VoxelMask mask = ball(12, Vec3d(1));
  double roughness[2];
  for (const int smooth : {0, 1}) {
    const LabelField field(mask, {}, smooth, 1);
    const BccLattice lattice(mask.geometry, mask.box, 1);
    const SolidMesh mesh = cleave(field, lattice, lattice_tets(field, lattice));
    double sum = 0, squares = 0;
    std::int64_t count = 0;
    for (const FaceSet& faces : faces_of_regions(mesh)) {
      for (const auto& triangle : faces.triangles) {
        const double radius = mesh.nodes_lps_mm[std::size_t(triangle[0])].length();
        sum += radius;
        squares += radius * radius;
        ++count;
      }
    }
    const double mean = sum / double(count);
    roughness[smooth] = std::sqrt(squares / double(count) - mean * mean);
    EXPECT_NEAR(mean, 12, 0.1) << smooth;
  }
  EXPECT_LT(roughness[1], 0.7 * roughness[0]);
}

TEST(PropertyCleaving, AShellOfThreeVoxelsStaysClosed) {
  const VoxelMask outer = ball(15, Vec3d(1)), inner = ball(12, Vec3d(1));
  VoxelMask shell = outer;
  const Vec3i dims = outer.dims();
  for (std::size_t n = 0; n < shell.inside.size(); ++n) {
    const std::size_t row = n / std::size_t(dims.x);
    const Vec3i at(int(n % std::size_t(dims.x)), int(row % std::size_t(dims.y)),
                   int(row / std::size_t(dims.y)));
    if (inner.holds(outer.box.lo + at)) shell.inside[n] = 0;
  }
  SolidParams params;
  for (const double spacing : {1.0, 1.5, 2.0}) {
    params.spacing_mm = spacing;
    const SolidMesh mesh = make_tets(shell, params);
    EXPECT_EQ(count_pieces(mesh), 1);
    // Nodes of the surface fall into those outside and inside of the wall, and no edge crosses it.
    std::int64_t sides[2] = {0, 0}, across = 0;
    for (const auto& triangle : mesh.faces.at(0).triangles) {
      int outside = 0;
      for (const std::int32_t node : triangle) {
        outside += mesh.nodes_lps_mm[std::size_t(node)].length() > 13.7 ? 1 : 0;
      }
      across += outside == 1 || outside == 2 ? 1 : 0;
      ++sides[outside >= 2 ? 1 : 0];
    }
    EXPECT_EQ(across, 0) << spacing;
    EXPECT_GT(sides[0], 300);
    EXPECT_GT(sides[1], sides[0]);
  }
}

TEST(UnitCleaving, ABlockUpToTheBorderKeepsItsFacesFlat) {
  const Geometry geometry(Vec3i(8, 6, 4), Vec3d(0.5), {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}});
  SolidParams params;
  params.spacing_mm = 1;
  params.smooth_voxels = 0;
  params.keeps_volume = false;
  const SolidMesh mesh = make_tets(mask_of(geometry, box_topology(geometry.dims())), params);
  Vec3d low(100), high(-100);
  for (const Vec3d& node : mesh.nodes_lps_mm) {
    for (int a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], node[a]);
      high[a] = std::max(high[a], node[a]);
    }
  }
  EXPECT_LT((low - Vec3d(0)).length(), 1e-4);
  EXPECT_LT((high - Vec3d(8, 6, 4)).length(), 1e-4);
  EXPECT_NEAR(volume_of(mesh), 8 * 6 * 4, 0.08 * 8 * 6 * 4);  // edges are bevelled
}

TEST(FaultCleaving, WhatCannotBeMeshedIsToldInOneLine) {
  const VoxelMask mask = ball(3, Vec3d(1));
  SolidParams params;
  params.spacing_mm = 30;
  EXPECT_NE(input_error([&] { make_tets(mask, params); }).find("spacing: found 30 mm"),
            std::string::npos);
  params.spacing_mm = 1e-4;
  EXPECT_NE(input_error([&] { make_tets(mask, params); }).find("expected a larger one"),
            std::string::npos);
  params.spacing_mm = -1;
  EXPECT_NE(input_error([&] { make_tets(mask, params); }).find("spacing: found -1"),
            std::string::npos);
  EXPECT_NE(input_error([&] { make_tets(VoxelMask(), SolidParams()); }).find("voxels: found none"),
            std::string::npos);
}

}  // namespace supple::test
