#include "lib/mesh/tets/make_solid.h"

#include <cmath>
#include <numeric>

#include "lib/mesh/tets/solid_faces.h"
#include "lib/mesh/tets/solid_quality.h"
#include "lib/mesh/tets/voxel_cover.h"

namespace supple {

namespace {

/// The lattice's tetrahedra per cube: four at each of six faces, which two cubes share: 24 / 2.
constexpr int kTetsPerCube = 12;
/// The part of the voxels' volume by which those of labels may differ, all together.
constexpr double kVolumeTolerance = 5e-4;
/// The limit of meshes that are made on the way to that volume, and what one has to gain.
constexpr int kMostPasses = 8;
constexpr double kLeastGain = 0.9;
constexpr int kMostCoarserLevels = 6;
/// Walls of fewer cubes than this may have holes.
constexpr double kThinCubes = 1.5;
/// Elements end up to this many cubes before a sharp edge of the voxels.
constexpr double kRimCubes = 0.3;

double area_mm2(const SolidMesh& mesh, const FaceSet& faces) {
  double area = 0;
  for (const auto& triangle : faces.triangles) {
    const Vec3d& a = mesh.nodes_lps_mm[std::size_t(triangle[0])];
    const Vec3d& b = mesh.nodes_lps_mm[std::size_t(triangle[1])];
    const Vec3d& c = mesh.nodes_lps_mm[std::size_t(triangle[2])];
    area += (b - a).cross(c - a).length() / 2;
  }
  return area;
}

/// Volumes that labels lack, and the ways of their surfaces that would bring them: a border between
/// two labels moves by half the difference of theirs.
class VolumeBalance {
 public:
  VolumeBalance(const LabelField& field, const SolidMesh& mesh)
      : m_labels(field.labels()), m_missing(field.volumes_mm3()) {
    const std::vector<double> volumes = volumes_mm3(mesh);
    for (std::size_t e = 0; e < volumes.size(); ++e) {
      m_missing[place_of(mesh.region_of[e])] -= volumes[e];
    }
    for (const auto& [regions, faces] : borders_of_regions(mesh)) {
      const double area = area_mm2(mesh, faces);
      const bool is_outside = regions.second == 0;
      m_borders.push_back({place_of(regions.first),
                           is_outside ? m_labels.size() : place_of(regions.second),
                           is_outside ? area : area / 2});
    }
  }

  double missing_mm3() const {
    double sum = 0;
    for (const double missing : m_missing) sum += std::abs(missing);
    return sum;
  }

  std::vector<double> ways_mm() const {
    std::vector<double> ways(m_labels.size() + 1, 0), areas(ways.size(), 0), sums;
    for (const auto& [a, b, area] : m_borders) {
      areas[a] += area;
      areas[b] += area;
    }
    for (int round = 0; round < 100; ++round) {
      sums = m_missing;
      sums.push_back(0);
      for (const auto& [a, b, area] : m_borders) {
        sums[a] += area * ways[b];
        sums[b] += area * ways[a];
      }
      for (std::size_t n = 0; n < m_labels.size(); ++n) {
        if (areas[n] > 0) ways[n] = (ways[n] + sums[n] / areas[n]) / 2;
      }
    }
    ways.pop_back();
    return ways;
  }

 private:
  struct Border {
    std::size_t a, b;
    double area;
  };
  std::size_t place_of(std::int32_t label) const {
    return std::size_t(std::lower_bound(m_labels.begin(), m_labels.end(), label) -
                       m_labels.begin());
  }

  const std::vector<std::int32_t>& m_labels;
  std::vector<double> m_missing;
  std::vector<Border> m_borders;
};

/// How often the lattice's cubes are halved where a voxel's size is needed.
int halvings_for(const Geometry& geometry, double spacing_mm) {
  const Vec3d size = geometry.spacing_mm();
  const double fine = std::min({size.x, size.y, size.z}) / kThinCubes;
  int halvings = 0;
  while (spacing_mm > fine * (1 + 1e-9)) spacing_mm /= 2, ++halvings;
  return halvings;
}

}  // namespace

Fields fields(SolidParams& params) {
  return {
      Field("spacing", params.spacing_mm,
            "Edge of the lattice's cubes; edges of elements are about as long")
          .unit("mm")
          .positive()
          .recorded_as("spacing_mm"),
      Field("elements", params.elements, "About so many, where no spacing is given").range(1, 1e9),
      Field("smooth", params.smooth_voxels,
            "Standard deviation by which steps of voxels are smoothed")
          .unit("voxel")
          .range(0, 10),
      Field("keep_volume", params.keeps_volume,
            "Move the surface as a whole until the volume is that of the voxels"),
      Field("coarser", params.coarser_levels,
            "Inside, edges become up to 2^LEVELS times as long, away from borders")
          .shown_as("LEVELS"),
      Field("thin", params.thin, {"report", "keep"},
            "Parts that are thinner than the lattice: told in ml, or kept by edges of some half a "
            "voxel where they would be lost"),
  };
}

void SolidParams::validate() const {
  if (spacing_mm) require(*spacing_mm > 0, "spacing", *spacing_mm, "a positive number of mm");
  require(elements >= 1, "elements", elements, "a number from 1 on");
  require(smooth_voxels >= 0 && smooth_voxels <= 10, "smooth", smooth_voxels, "0 to 10 voxels");
  require(coarser_levels >= 0 && coarser_levels <= kMostCoarserLevels, "coarser", coarser_levels,
          "0 to " + std::to_string(kMostCoarserLevels));
}

double spacing_for(const SolidParams& params, double volume_mm3) {
  return params.spacing_mm.value_or(std::cbrt(kTetsPerCube * volume_mm3 / params.elements));
}

SolidMesh make_tets(const VoxelMask& mask, const VoxelLabel& label_of, const SolidParams& params,
                    const std::map<std::int32_t, std::string>& names, SolidReport* report,
                    Progress* progress) {
  params.validate();
  if (mask.box.empty()) throw InputError({"", "voxels", "none", "one at least"});
  const double spacing_mm = spacing_for(params, mask.volume_mm3());
  const BccLattice lattice(mask.geometry, mask.box, spacing_mm);
  LabelField field(mask, label_of, params.smooth_voxels, spacing_mm, progress);
  SolidReport own;
  LatticeGrading grading{params.coarser_levels};
  const VoxelMask thin = thin_voxels(mask, label_of, kThinCubes * spacing_mm);
  own.thin = thin.count();
  LatticeTets tets = lattice_tets(field, lattice, grading);
  VoxelMask lost;
  if (params.thin == ThinWalls::keep && own.thin > 0) {
    lost = uncovered_voxels(thin, label_of, cleave(field, lattice, tets, nullptr, progress));
    lost = without_rims(lost, mask, label_of, kRimCubes * spacing_mm);
    grading.fine = &lost;
    if (lost.count() > 0) grading.finer = halvings_for(mask.geometry, spacing_mm);
    if (grading.finer > 0) tets = lattice_tets(field, lattice, grading);
  }
  SolidMesh mesh;
  double missing = 0;
  for (;;) {
    mesh = cleave(field, lattice, tets, &own.cleaving, progress);
    ++own.passes;
    if (mesh.tets.empty()) {
      throw InputError({"", "spacing",
                        number_text(spacing_mm) + " mm, at which no vertex is inside",
                        "a smaller one"});
    }
    const VolumeBalance balance(field, mesh);
    const double before = missing;
    missing = balance.missing_mm3();
    const bool is_near = missing <= kVolumeTolerance * mask.volume_mm3() ||
                         (own.passes > 2 && missing > kLeastGain * before);
    if (!params.keeps_volume || is_near || own.passes == kMostPasses) break;
    if (!field.grow(balance.ways_mm())) break;
  }
  mesh.faces = faces_of_regions(mesh, names);
  if (own.thin > 0) own.thin_lost = uncovered_voxels(thin, label_of, mesh).count();
  for (const double way : field.outwards_mm()) {
    if (std::abs(way) > std::abs(own.outwards_mm)) own.outwards_mm = way;
  }
  if (report != nullptr) *report = own;
  return mesh;
}

SolidMesh make_tets(const VoxelMask& mask, const SolidParams& params, std::int32_t region,
                    const std::string& name, SolidReport* report, Progress* progress) {
  SolidMesh mesh = make_tets(mask, VoxelLabel(), params, {{1, name}}, report, progress);
  mesh.region_of.assign(mesh.tets.size(), region);
  return mesh;
}

}  // namespace supple
