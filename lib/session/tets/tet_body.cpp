#include "lib/session/tets/tet_body.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "lib/mesh/tets/element_materials.h"
#include "lib/mesh/tets/element_regions.h"
#include "lib/mesh/tets/solid_faces.h"
#include "lib/mesh/tets/solid_quality.h"
#include "lib/session/tets/parted_labels.h"
#include "volumes/base/text.h"
#include "volumes/base/units.h"
#include "volumes/io/solid/solid_mesh_file.h"

namespace supple {

namespace {

/// Cosine of the widest angle between `facing` and the normal of a face.
constexpr double kFacingCosine = 0.5;
constexpr const char* kBetween = " to ";

using OuterFace = std::array<std::int32_t, 3>;

Vec3d middle_of(const SolidMesh& mesh, const OuterFace& face) {
  Vec3d sum(0);
  for (const std::int32_t node : face) sum += mesh.nodes_lps_mm[std::size_t(node)];
  return sum / 3;
}

Vec3d normal_of(const SolidMesh& mesh, const OuterFace& face) {
  const auto at = [&](std::size_t c) { return mesh.nodes_lps_mm[std::size_t(face[c])]; };
  return (at(1) - at(0)).cross(at(2) - at(0)).normalized();
}

Vec3d centroid_of(const SolidMesh& mesh) {
  const std::vector<double> volumes = volumes_mm3(mesh);
  Vec3d sum(0);
  double weight = 0;
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    for (const std::int32_t node : mesh.tets[e]) {
      sum += mesh.nodes_lps_mm[std::size_t(node)] * (volumes[e] / 4);
    }
    weight += volumes[e];
  }
  return sum / weight;
}

/// True for outer faces at an element of the set.
class FacesOfElements {
 public:
  FacesOfElements(const SlotSet& slots, const Body& body) : m_slots(slots), m_body(body) {}
  bool operator()(const SolidMesh& mesh, const OuterFace& face) const {
    const auto slot =
        nearest_slot(m_body.elements, m_body.geometry.index_from_world(middle_of(mesh, face)));
    return slot && m_slots.contains(*slot);
  }

 private:
  const SlotSet& m_slots;
  const Body& m_body;
};

/// True for the faces of a region that end the mesh; the others are borders of two.
bool is_outer(const FaceSet& set) {
  return set.name.find(kBetween) == std::string::npos;
}

/// Parts the outer surface into openings and the rest; borders between labels stay.
void name_openings(const TetStep& step, const Body& body, const DensityGrid& density,
                   const BrickValues& labels, TetBody& tets) {
  SolidMesh& mesh = tets.mesh;
  for (const FaceSet& set : mesh.faces) {
    if (is_outer(set))
      tets.outer.insert(tets.outer.end(), set.triangles.begin(), set.triangles.end());
  }
  mesh.faces.erase(std::remove_if(mesh.faces.begin(), mesh.faces.end(), is_outer),
                   mesh.faces.end());
  std::vector<OuterFace> rest = tets.outer;
  const Vec3d centre = centroid_of(mesh);
  for (const TetOpening& opening : step.openings) {
    std::function<bool(const OuterFace&)> belongs;
    SlotSet slots;
    if (opening.part) {
      slots = elements_of(*opening.part, body, density, labels, "openings");
      belongs = [&, of = FacesOfElements(slots, body)](const OuterFace& face) {
        return of(mesh, face);
      };
    } else {
      const Vec3d axis = opening.toward->normalized();
      const double least = std::cos(opening.degrees * kRadiansPerDegree);
      belongs = [&mesh, centre, axis, least](const OuterFace& face) {
        return (middle_of(mesh, face) - centre).normalized().dot(axis) > least;
      };
    }
    const auto own = std::stable_partition(rest.begin(), rest.end(),
                                           [&](const OuterFace& face) { return !belongs(face); });
    if (own == rest.end()) {
      throw InputError({"", "openings", opening.name + ", without a face",
                        "a wider angle or a larger part of the surface"});
    }
    mesh.faces.push_back({opening.name, {own, rest.end()}});
    rest.erase(own, rest.end());
  }
  mesh.faces.push_back({kOutside, std::move(rest)});
}

/// The region of elements without a label: 0 is what lies outside of a mesh.
constexpr std::int32_t kUnlabelled = kMaxLabel + 1;
std::int32_t region_of_label(std::int32_t label) {
  return label == 0 ? kUnlabelled : label;
}

std::map<std::int32_t, std::string> numbers_as_names(const SolidMesh& mesh) {
  std::map<std::int32_t, std::string> names;
  for (const std::int32_t region : mesh.region_of) {
    names.try_emplace(region, std::to_string(region == kUnlabelled ? 0 : region));
  }
  return names;
}

/// Mean densities of mass of the voxels in the elements of each material.
std::vector<double> mass_densities(const TetBody& tets, const Body& body) {
  const MaterialClasses classes(body.material);
  std::vector<double> sums(tets.mesh.materials.size(), 0), counts(sums.size(), 0);
  std::size_t element = 0;
  double all = 0;
  for_each_element(body.elements, [&](Slot slot) {
    const std::int32_t tet = tets.sites[element++].tet;
    const double density = classes.mass_density_of_class(body.classes[slot]);
    all += density;
    if (tet < 0) return;
    const auto of = std::size_t(tets.mesh.material_of[std::size_t(tet)]);
    sums[of] += density;
    ++counts[of];
  });
  for (std::size_t m = 0; m < sums.size(); ++m) {
    sums[m] = counts[m] > 0 ? sums[m] / counts[m] : all / double(element);
  }
  return sums;
}

/// True where all elements have a stiffness of the file.
bool has_materials(const SolidMesh& mesh) {
  const auto is_stiff = [&](std::int32_t of) {
    return of >= 0 && std::size_t(of) < mesh.materials.size() &&
           mesh.materials[std::size_t(of)].young_kpa > 0;
  };
  return !mesh.material_of.empty() &&
         std::all_of(mesh.material_of.begin(), mesh.material_of.end(), is_stiff);
}

/// Volumes of meshes this many times that of the voxels, or a part as small, are in other units.
constexpr double kOtherUnits = 1000;

/// A mesh of a file without nodes of no tetrahedron, such as those in the middles of edges, as one
/// region. Throws InputError: hexahedra, another unit of length.
SolidMesh read_tets_of(const std::string& path, double voxels_mm3) {
  SolidMesh mesh = read_solid_mesh(path);
  if (!mesh.hexes.empty()) {
    throw InputError(
        {path, "mesh", std::to_string(mesh.hexes.size()) + " hexahedra", "tetrahedra alone"});
  }
  std::vector<std::int32_t> number(mesh.nodes_lps_mm.size(), -1);
  std::vector<Vec3d> nodes;
  for (auto& tet : mesh.tets) {
    for (std::int32_t& node : tet) {
      std::int32_t& of = number[std::size_t(node)];
      if (of < 0) {
        of = std::int32_t(nodes.size());
        nodes.push_back(mesh.nodes_lps_mm[std::size_t(node)]);
      }
      node = of;
    }
  }
  mesh.nodes_lps_mm = std::move(nodes);
  mesh.region_of.clear();
  mesh.faces.clear();
  double mm3 = 0;
  for (const double volume : volumes_mm3(mesh)) mm3 += std::abs(volume);
  if (!(mm3 < voxels_mm3 * kOtherUnits && mm3 > voxels_mm3 / kOtherUnits)) {
    throw InputError({path, "mesh", number_text(mm3 * kMlPerMm3) + " ml",
                      "a mesh of the body, which has " + number_text(voxels_mm3 * kMlPerMm3) +
                          " ml, in LPS millimetres"});
  }
  return mesh;
}

}  // namespace

std::string border_name(std::int32_t first, std::int32_t second) {
  if (region_of_label(first) > region_of_label(second)) std::swap(first, second);
  return std::to_string(first) + kBetween + std::to_string(second);
}

FaceSet loaded_faces(const std::string& name, const SlotSet& elements,
                     const std::optional<Vec3d>& facing, const Body& body, const TetBody& tets) {
  const FacesOfElements belongs(elements, body);
  FaceSet set{name, {}};
  for (const OuterFace& face : tets.outer) {
    const bool is_turned_away =
        facing && normal_of(tets.mesh, face).dot(facing->normalized()) < kFacingCosine;
    if (!is_turned_away && belongs(tets.mesh, face)) set.triangles.push_back(face);
  }
  if (set.triangles.empty()) {
    throw InputError({"", "pressures", "elements without an outer face there",
                      "elements at the surface of the mesh"});
  }
  return set;
}

namespace {

/// The mesh with its regions, and their surfaces and borders as sets of faces.
SolidMesh mesh_of(const TetStep& step, const VoxelMask& mask, const VoxelLabel& region_of,
                  Progress* progress) {
  SolidMesh mesh;
  if (!step.mesh.empty()) {
    mesh = read_tets_of(step.mesh, mask.volume_mm3());
    if (step.has_labels) give_regions(mesh, mask, region_of);
  } else if (step.has_labels) {
    mesh = make_tets(mask, region_of, step.solid, {}, nullptr, progress);
  } else {
    mesh = make_tets(mask, step.solid, 1, "surface", nullptr, progress);
  }
  mesh.faces = faces_of_regions(mesh, numbers_as_names(mesh));
  return mesh;
}

/// Parts the mesh where the body is cut between labels, and finds the places of the voxels: beside
/// such a border each goes with its own bank.
void part_and_place(const Body& body, const BrickValues& labels, TetBody& tets) {
  SolidMesh& mesh = tets.mesh;
  std::set<std::pair<std::int32_t, std::int32_t>> parted;
  std::set<std::string> borders;
  for (const auto& [first, second] : parted_labels(body, labels)) {
    parted.insert(std::minmax(region_of_label(first), region_of_label(second)));
    borders.insert(border_name(first, second));
  }
  SiteChoice is_own_bank;
  if (!parted.empty()) {
    part_mesh(borders, numbers_as_names(mesh), mesh);
    is_own_bank = [&](std::size_t tet, Slot slot) {
      const std::int32_t region = region_of_label(labels.at(slot));
      return parted.count(std::minmax(mesh.region_of[tet], region)) == 0;
    };
  }
  tets.sites = voxel_sites(mesh, body.geometry, body.elements, is_own_bank, &tets.far);
  tets.unmeshed = std::count_if(tets.sites.begin(), tets.sites.end(),
                                [](const VoxelSite& site) { return site.tet < 0; });
}

}  // namespace

TetBody make_tet_body(const TetStep& step, const Body& body, const DensityGrid& density,
                      const BrickValues& labels, Progress* progress) {
  if (step.has_labels && labels.empty()) {
    throw InputError({"", "labels", "a volume without labels", "a table [labels]"});
  }
  stage(progress, "meshing");
  const VoxelLabel label_of = [&](const Vec3i& voxel) {
    Slot slot;
    return slot_of(body.elements, voxel, slot) && !labels.empty() ? labels.at(slot) : 0;
  };
  const VoxelLabel region_of = [&](const Vec3i& voxel) { return region_of_label(label_of(voxel)); };
  const VoxelMask mask = mask_of(body.geometry, body.elements);
  TetBody tets;
  tets.voxels_ml = mask.volume_mm3() * kMlPerMm3;
  tets.mesh = mesh_of(step, mask, region_of, progress);
  poll(progress);
  part_and_place(body, labels, tets);
  if (tets.unmeshed == std::int64_t(tets.sites.size())) {
    throw InputError({step.mesh, "mesh", "no voxel of the body in its tetrahedra",
                      "a mesh of the body, in LPS millimetres"});
  }
  if (step.mesh.empty() || !has_materials(tets.mesh)) {
    give_materials(tets.mesh, mask, density, elastic_curves(body.material), label_of, step.bins);
  }
  name_openings(step, body, density, labels, tets);
  tets.density_kg_m3 = mass_densities(tets, body);
  return tets;
}

}  // namespace supple
