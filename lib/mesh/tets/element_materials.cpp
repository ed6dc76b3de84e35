#include "lib/mesh/tets/element_materials.h"

#include <cmath>

#include "lib/mesh/tets/element_voxels.h"
#include "lib/mesh/tets/solid_quality.h"
#include "volumes/base/parallel.h"

namespace supple {

namespace {

/// Sums over voxels.
struct Constants {
  double young_kpa = 0, poisson = 0, weight = 0;

  void add(double young, double ratio, double by) {
    young_kpa += by * young;
    poisson += by * ratio;
    weight += by;
  }
  Constants mean() const { return {young_kpa / weight, poisson / weight, 1}; }
};

/// Voxels of the mask with their constants.
class VoxelConstants {
 public:
  VoxelConstants(const VoxelMask& mask, const DensityGrid& density, const ElasticOfLabels& elastic,
                 const VoxelLabel& label_of)
      : m_mask(mask), m_density(density), m_elastic(elastic), m_label_of(label_of) {}

  void add(const Vec3i& voxel, Constants& sum) const {
    if (!m_mask.holds(voxel)) return;
    const double density = m_density.at(voxel);
    const ElasticCurves& curves = curves_of(voxel);
    sum.add(curves.young_kpa(density), curves.poisson(density), 1);
  }

 private:
  const ElasticCurves& curves_of(const Vec3i& voxel) const {
    if (!m_label_of || m_elastic.of_labels.empty()) return m_elastic.common;
    const auto own = m_elastic.of_labels.find(m_label_of(voxel));
    return own != m_elastic.of_labels.end() ? own->second : m_elastic.common;
  }

  const VoxelMask& m_mask;
  const DensityGrid& m_density;
  const ElasticOfLabels& m_elastic;
  const VoxelLabel& m_label_of;
};

/// The means over the voxels of every element.
std::vector<Constants> constants_of(const SolidMesh& mesh, const VoxelMask& mask,
                                    const VoxelConstants& voxels) {
  const std::vector<Vec3d> places = index_places(mesh, mask.geometry);
  std::vector<Constants> of_elements(mesh.element_count());
  parallel_for(of_elements.size(), Grain{256}, [&](std::size_t e) {
    Constants sum;
    for_each_voxel(mesh, e, places, [&](const Vec3i& voxel) { voxels.add(voxel, sum); });
    if (sum.weight == 0) {
      for_each_corner(mesh, e, [&](std::size_t n) { voxels.add(nearest_voxel(places[n]), sum); });
    }
    if (sum.weight > 0) of_elements[e] = sum.mean();
  });
  Constants all;
  for (const Constants& own : of_elements) {
    if (own.weight > 0) all.add(own.young_kpa, own.poisson, 1);
  }
  for (Constants& own : of_elements) {
    if (own.weight == 0 && all.weight > 0) own = all.mean();
  }
  return of_elements;
}

}  // namespace

ElasticOfLabels elastic_curves(const MaterialTable& material) {
  const auto curves_of = [&](const LimitTable& table) {
    const std::optional<Curve>& stiffness = table.stiffness ? table.stiffness : material.stiffness;
    const std::optional<Curve>& poisson = table.poisson ? table.poisson : material.poisson;
    if (!stiffness) {
      throw InputError({"", "material", "a table without stiffness", "stiffness in kPa"});
    }
    return ElasticCurves{*stiffness, poisson.value_or(Curve{{{0, kDefaultPoisson}}})};
  };
  ElasticOfLabels elastic{curves_of(material), {}};
  for (const auto& [label, table] : material.labels) elastic.of_labels[label] = curves_of(table);
  return elastic;
}

void give_materials(SolidMesh& mesh, const VoxelMask& mask, const DensityGrid& density,
                    const ElasticOfLabels& elastic, const VoxelLabel& label_of, int bins) {
  require(bins >= 1, "bins", bins, "a count from 1 on");
  const std::vector<Constants> constants =
      constants_of(mesh, mask, VoxelConstants(mask, density, elastic, label_of));
  double least = 1e300, largest = 0;
  for (const Constants& own : constants) {
    least = std::min(least, own.young_kpa);
    largest = std::max(largest, own.young_kpa);
  }
  const double steps = largest > least ? bins / std::log(largest / least) : 0;
  const std::vector<double> volumes = volumes_mm3(mesh);
  std::vector<Constants> of_bins(static_cast<std::size_t>(bins));
  std::vector<std::size_t> bin_of(constants.size());
  for (std::size_t e = 0; e < constants.size(); ++e) {
    const double bin = steps * std::log(constants[e].young_kpa / least);
    bin_of[e] = std::min(std::size_t(std::max(bin, 0.0)), of_bins.size() - 1);
    of_bins[bin_of[e]].add(constants[e].young_kpa, constants[e].poisson, volumes[e]);
  }
  mesh.materials.clear();
  std::vector<std::int32_t> number(of_bins.size(), 0);
  for (std::size_t b = 0; b < of_bins.size(); ++b) {
    if (of_bins[b].weight == 0) continue;
    const Constants mean = of_bins[b].mean();
    number[b] = std::int32_t(mesh.materials.size());
    mesh.materials.push_back(
        {number_text(mean.young_kpa, 4) + " kPa", mean.young_kpa, mean.poisson});
  }
  mesh.material_of.clear();
  for (const std::size_t bin : bin_of) mesh.material_of.push_back(number[bin]);
}

}  // namespace supple
