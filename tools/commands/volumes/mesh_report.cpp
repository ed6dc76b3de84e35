#include "tools/commands/volumes/mesh_report.h"

#include <cmath>
#include <cstdio>

#include "lib/mesh/tets/solid_faces.h"
#include "lib/mesh/tets/solid_quality.h"
#include "lib/mesh/tets/voxel_cover.h"
#include "volumes/base/text.h"

namespace supple::tools {

namespace {

constexpr double kMm3PerMl = 1000;

/// The outer surface: all faces that belong to one element alone.
void add_surface(const SolidMesh& mesh, Value& report) {
  SolidMesh as_one = mesh;
  as_one.region_of.clear();
  as_one.faces.clear();
  const std::vector<FaceSet> faces = faces_of_regions(as_one);
  const SurfaceTopology topology = topology_of(faces.front().triangles);
  report["triangles"] = faces.front().triangles.size();
  report["pieces"] = count_pieces(mesh);
  report["open_edges"] = topology.open_edges;
  report["pinched_edges"] = topology.pinched_edges;
}

Value regions_of(const SolidQuality& quality, double voxel_ml,
                 const std::map<std::int32_t, std::int64_t>& region_voxels) {
  Value regions = Value::Entries();
  for (const auto& [region, voxels] : region_voxels) {
    const auto elements = quality.elements.find(region);
    const auto volume = quality.volume_mm3.find(region);
    const bool is_there = elements != quality.elements.end();
    regions[std::to_string(region)] = {{"elements", is_there ? elements->second : std::int64_t(0)},
                                       {"volume_ml", is_there ? volume->second / kMm3PerMl : 0.0},
                                       {"voxels_ml", double(voxels) * voxel_ml}};
  }
  return regions;
}

}  // namespace

Value mesh_report(const SolidMesh& mesh, const VoxelMask& mask,
                  const std::map<std::int32_t, std::int64_t>& region_voxels) {
  const SolidQuality quality = quality_of(mesh);
  const double voxel_ml = std::abs(mask.geometry.determinant()) / kMm3PerMl;
  Value report = {{"nodes", mesh.nodes_lps_mm.size()},
                  {"tetrahedra", mesh.tets.size()},
                  {"hexahedra", mesh.hexes.size()}};
  if (!mesh.tets.empty()) {
    report["least_dihedral_deg"] = quality.least_dihedral_deg;
    report["largest_dihedral_deg"] = quality.largest_dihedral_deg;
  }
  if (quality.junction_tets > 0) {
    report["junctions"] = {{"elements", quality.junction_tets},
                           {"least_dihedral_deg", quality.least_junction_deg},
                           {"largest_dihedral_deg", quality.largest_junction_deg}};
  }
  report["mean_aspect"] = quality.mean_aspect;
  report["largest_aspect"] = quality.largest_aspect;
  report["edges_mm"] = std::array<double, 3>{quality.shortest_edge_mm, quality.mean_edge_mm,
                                             quality.longest_edge_mm};
  report["element_volumes_mm3"] = std::array<double, 3>{
      quality.least_volume_mm3, quality.mean_volume_mm3, quality.largest_volume_mm3};
  report["turned_inside_out"] = quality.turned_inside_out;
  report["volume_ml"] = quality.mean_volume_mm3 * double(mesh.element_count()) / kMm3PerMl;
  report["voxels_ml"] = double(mask.count()) * voxel_ml;
  const VoxelCover cover = cover_of(mask, mesh);
  report["lost_ml"] = double(cover.lost) * voxel_ml;
  report["gained_ml"] = double(cover.gained) * voxel_ml;
  add_surface(mesh, report);
  if (!mesh.materials.empty()) {
    report["materials"] = mesh.materials.size();
    report["young_kpa"] =
        std::array<double, 2>{mesh.materials.front().young_kpa, mesh.materials.back().young_kpa};
  }
  if (region_voxels.size() > 1) report["regions"] = regions_of(quality, voxel_ml, region_voxels);
  return report;
}

void print_mesh_report(const Value& report) {
  const auto number = [&](const char* key) { return report[key].number(); };
  const auto count = [&](const char* key) { return static_cast<long long>(report[key].whole()); };
  const bool has_hexes = count("hexahedra") > 0;
  std::printf("%lld %s, %lld nodes, %lld triangles of the surface",
              count(has_hexes ? "hexahedra" : "tetrahedra"), has_hexes ? "hexahedra" : "tetrahedra",
              count("nodes"), count("triangles"));
  if (report.contains("spacing_mm")) std::printf("; spacing %.4g mm", number("spacing_mm"));
  std::printf("\n");
  if (!has_hexes) {
    std::printf("dihedral angles  %.2f to %.2f degrees\n", number("least_dihedral_deg"),
                number("largest_dihedral_deg"));
  }
  if (report.contains("junctions")) {
    const Value& junctions = report["junctions"];
    std::printf("junctions        %.2f to %.2f degrees, in %lld elements where regions meet\n",
                junctions["least_dihedral_deg"].number(),
                junctions["largest_dihedral_deg"].number(),
                static_cast<long long>(junctions["elements"].whole()));
  }
  std::printf("aspect           %.3g in the mean, %.3g at most\n", number("mean_aspect"),
              number("largest_aspect"));
  const Value& edges = report["edges_mm"];
  std::printf("edges            %.3g to %.3g mm, %.3g in the mean\n", edges[0].number(),
              edges[2].number(), edges[1].number());
  const Value& volumes = report["element_volumes_mm3"];
  std::printf("volumes          %.3g to %.3g mm³, %.3g in the mean\n", volumes[0].number(),
              volumes[2].number(), volumes[1].number());
  std::printf("volume           %.5g ml, %.2f %% of the voxels' %.5g ml\n", number("volume_ml"),
              100 * number("volume_ml") / number("voxels_ml"), number("voxels_ml"));
  std::printf("voxels           %.4g ml of them in no element, %.4g ml of others in one\n",
              number("lost_ml"), number("gained_ml"));
  if (report.contains("thin_ml") && number("thin_ml") > 0) {
    std::printf("thin parts       %.4g ml, %.4g ml of them in no element\n", number("thin_ml"),
                number("thin_lost_ml"));
  }
  std::printf("surface          %s; %lld edges at which parts touch; %s\n",
              count("open_edges") == 0 ? "closed" : "open", count("pinched_edges"),
              with_count(count("pieces"), "piece").c_str());
  if (report.contains("materials")) {
    std::printf("stiffness        %.4g to %.4g kPa in %s\n", report["young_kpa"][0].number(),
                report["young_kpa"][1].number(),
                with_count(count("materials"), "material").c_str());
  }
  for (const auto& [region, row] : report["regions"].entries()) {
    std::printf(
        "region %-9s %8lld elements, %.5g ml, %.2f %% of the voxels' %.5g ml\n", region.c_str(),
        static_cast<long long>(row["elements"].whole()), row["volume_ml"].number(),
        100 * row["volume_ml"].number() / row["voxels_ml"].number(), row["voxels_ml"].number());
  }
}

}  // namespace supple::tools
