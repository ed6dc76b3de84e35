// Cleaving of several labels and in graded lattices: conformity, volumes, angles, thin parts.
#include <cmath>

#include <gtest/gtest.h>

#include "lib/mesh/tets/element_regions.h"
#include "tests/lib/mesh/tets/mesh_cases.h"

namespace supple::test {
TEST(PropertyLabelCleaving, AThousandRandomMasksOfLabelsAreMeshedConformingAndWithinTheToldAngles) {
  std::mt19937 random(2);
  double least = 180, largest = 0;
  int meshed = 0, with_junctions = 0, graded = 0;
  for (int n = 0; n < 1000; ++n) {
    const Vec3i dims(2 + int(random() % 5), 2 + int(random() % 5), 2 + int(random() % 5));
    const Geometry geometry = random_geometry(random, dims);
    const VoxelMask mask = mask_of(geometry, random_voxels(random, dims));
    // Labels by voxel, or by the nearest of a few seeds.
    const int count = 2 + int(random() % 5);
    std::vector<Vec3i> seeds;
    for (int s = 0; s < count; ++s) {
      seeds.push_back({int(random() % 5), int(random() % 5), int(random() % 5)});
    }
    const bool is_noise = random() % 2 == 0;
    const VoxelLabel label_of = [&](const Vec3i& v) {
      if (is_noise) return 3 + int(VoxelHash()(v) % std::size_t(count));
      const auto nearer = [&](const Vec3i& a, const Vec3i& b) {
        return (v - a).length2() < (v - b).length2();
      };
      return 3 + int(std::min_element(seeds.begin(), seeds.end(), nearer) - seeds.begin());
    };
    SolidParams params;
    const Vec3d size = geometry.spacing_mm();
    const double voxel = std::min({size.x, size.y, size.z});
    params.spacing_mm = voxel * std::uniform_real_distribution<double>(0.45, 1.4)(random);
    params.smooth_voxels = random() % 3 == 0 ? 0 : 1;
    LatticeGrading grading{int(random() % 3)};
    const VoxelMask thin = thin_voxels(mask, label_of, 1.5 * *params.spacing_mm);
    if (random() % 5 == 0) {
      grading.finer = 1;
      grading.fine = &thin;
    }
    const LabelField field(mask, label_of, params.smooth_voxels, *params.spacing_mm);
    const BccLattice lattice(geometry, mask.box, *params.spacing_mm);
    CleaveReport report;
    const SolidMesh mesh = cleave(field, lattice, lattice_tets(field, lattice, grading), &report);
    if (mesh.tets.empty()) continue;
    ++meshed;
    with_junctions += report.in_faces > 0 ? 1 : 0;
    graded += grading.finer;
    const SolidQuality quality = quality_of(mesh);
    ASSERT_EQ(quality.turned_inside_out, 0) << n;
    ASSERT_NO_THROW(require_conforming(mesh)) << n;
    least = std::min(least, quality.least_dihedral_deg);
    largest = std::max(largest, quality.largest_dihedral_deg);
  }
  EXPECT_GT(meshed, 850);
  EXPECT_GT(with_junctions, 100);
  EXPECT_GT(graded, 150);
  EXPECT_GE(least, kLeastJunctionDeg);
  EXPECT_LE(largest, kLargestJunctionDeg);
}

namespace {

/// A head of ellipsoids: scalp 1, skull 2, halves of the brain 3 and 4, ventricle 5; 0 is outside.
std::int32_t head_label(const Vec3i& voxel) {
  const Vec3d from = Vec3d(voxel) - Vec3d(40, 48, 40);
  const auto is_within = [&](const Vec3d& half) { return (from / half).length() < 1; };
  if (!is_within({38, 46, 38})) return 0;
  if (!is_within({33, 41, 33})) return 1;
  if (!is_within({28, 36, 28})) return 2;
  if (is_within({9, 15, 9})) return 5;
  return from.x + 0.2 * from.z < 0.3 ? 3 : 4;
}

VoxelMask head_mask() {
  const Vec3i dims(81, 97, 81);
  std::vector<Vec3i> voxels;
  for (int k = 0; k < dims.z; ++k) {
    for (int j = 0; j < dims.y; ++j) {
      for (int i = 0; i < dims.x; ++i) {
        if (head_label({i, j, k}) != 0) voxels.push_back({i, j, k});
      }
    }
  }
  const Geometry geometry(dims, Vec3d(0), {Vec3d(2, 0, 0), {0, 2, 0}, {0, 0, 2}});
  return mask_of(geometry, topology_of(voxels));
}

}  // namespace

TEST(PropertyLabelCleaving, LabelsOfAHeadHaveTheirVolumesWithinHalfAPercentAndShareSmoothFaces) {
  const VoxelMask mask = head_mask();
  SolidParams params;
  params.spacing_mm = 4.9;  // the skull and the scalp are two spacings thick
  const SolidMesh mesh = make_tets(mask, head_label, params, {{1, "scalp"}, {2, "skull"}});
  ASSERT_NO_THROW(require_conforming(mesh));
  const SolidQuality quality = quality_of(mesh);
  for (const auto& [label, count] : voxels_of_labels(mask, head_label)) {
    EXPECT_NEAR(quality.volume_mm3.at(label) / (8 * double(count)), 1, 0.005) << label;
  }
  EXPECT_EQ(quality.turned_inside_out, 0);
  EXPECT_GT(quality.junction_tets, 100);
  EXPECT_GE(quality.least_junction_deg, 8);
  EXPECT_LE(quality.largest_junction_deg, 165);
  std::vector<std::string> names;
  for (const FaceSet& faces : mesh.faces) names.push_back(faces.name);
  EXPECT_EQ(names, (std::vector<std::string>{"scalp", "scalp to skull", "skull to region_3",
                                             "skull to region_4", "region_3 to region_4",
                                             "region_3 to region_5", "region_4 to region_5"}));
  for (const std::int32_t node_set : {1, 2}) {
    const Vec3d half = node_set == 1 ? Vec3d(66, 82, 66) : Vec3d(56, 72, 56);
    for (const auto& triangle : mesh.faces[std::size_t(node_set)].triangles) {
      const Vec3d at = mesh.nodes_lps_mm[std::size_t(triangle[0])] - Vec3d(80, 96, 80);
      EXPECT_NEAR((at / half).length(), 1, 1.0 / 28);  // a voxel
    }
  }
}

TEST(PropertyLabelCleaving, ALatticeThatIsCoarserInsideHasTheSameSurfaceOfFewerElements) {
  const VoxelMask mask = ball(16, Vec3d(1));
  SolidParams params;
  params.spacing_mm = 1.2;
  params.keeps_volume = false;
  const SolidMesh even = make_tets(mask, params);
  for (const int levels : {1, 3}) {
    params.coarser_levels = levels;
    const SolidMesh graded = make_tets(mask, params);
    ASSERT_NO_THROW(require_conforming(graded));
    EXPECT_LT(double(graded.tets.size()), (levels == 1 ? 0.8 : 0.7) * double(even.tets.size()));
    EXPECT_EQ(graded.faces[0].triangles.size(), even.faces[0].triangles.size());
    EXPECT_NEAR(volume_of(graded), volume_of(even), 1e-9 * volume_of(even));
    const SolidQuality quality = quality_of(graded);
    EXPECT_GE(quality.least_dihedral_deg, kLeastDihedralDeg);
    EXPECT_LE(quality.largest_dihedral_deg, kLargestDihedralDeg);
    EXPECT_GT(quality.longest_edge_mm, (levels == 1 ? 1.9 : 3.9) * 1.2);
  }
}

TEST(PropertyLabelCleaving, PartsThinnerThanTheLatticeAreToldOrKept) {
  std::vector<Vec3i> voxels = {{3, 3, 28}, {24, 4, 28}, {24, 5, 28}};  // two islands
  for (int n = 0; n < 30 * 30; ++n) {
    const int i = n % 30, j = n / 30;
    for (int k = 2; k < 14; ++k) voxels.push_back({i, j, k});
    voxels.push_back({i, j, 20});  // a sheet
  }
  const Geometry geometry(Vec3i(32), Vec3d(0), {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}});
  const VoxelMask mask = mask_of(geometry, topology_of(voxels));
  SolidParams params;
  params.spacing_mm = 4;
  SolidReport told, kept;
  const SolidMesh without = make_tets(mask, params, 1, "surface", &told);
  params.thin = ThinWalls::keep;
  const SolidMesh with = make_tets(mask, params, 1, "surface", &kept);
  EXPECT_GE(told.thin, 903);
  EXPECT_GT(told.thin_lost, 600);
  EXPECT_EQ(kept.thin, told.thin);
  EXPECT_LT(kept.thin_lost, 0.02 * double(told.thin));
  EXPECT_EQ(count_pieces(with), 4);
  ASSERT_NO_THROW(require_conforming(with));
  const SolidQuality quality = quality_of(with);
  EXPECT_EQ(quality.turned_inside_out, 0);
  EXPECT_GE(quality.least_dihedral_deg, kLeastJunctionDeg);
  EXPECT_NEAR(volume_of(with), mask.volume_mm3(), 0.01 * mask.volume_mm3());
}

}  // namespace supple::test
