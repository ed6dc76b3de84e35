// supple mesh: tetrahedra of the tissue of a volume or of a label, for programs of finite elements,
// and how good they are.
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "lib/mesh/tets/make_solid.h"
#include "lib/mesh/tets/solid_faces.h"
#include "lib/mesh/tets/solid_quality.h"
#include "lib/mesh/tets/voxel_cover.h"
#include "tools/console/command.h"
#include "tools/console/field_options.h"
#include "tools/scene/run/output_plan.h"
#include "volumes/base/json.h"
#include "volumes/io/load/label_file.h"
#include "volumes/io/load/load.h"
#include "volumes/io/mesh/mesh_contents.h"
#include "volumes/io/mesh/mesh_writer.h"
#include "volumes/io/solid/solid_mesh_file.h"

namespace supple::tools {

namespace {

constexpr double kMm3PerMl = 1000;

struct MeshOptions {
  std::string input, label;
  std::vector<std::string> outputs;
  ReadOptions read;
  std::optional<NumberPair> range;
  int components = 0;
  SolidParams solid;
};

Fields fields(MeshOptions& options) {
  return {
      Field("range", options.range, "Densities that are meshed")
          .shown_as("LO,HI")
          .otherwise("all above the least"),
      Field("label", options.label, "The label that is meshed, of a label volume")
          .shown_as("N|NAME"),
      Field("components", options.components, "So many largest pieces that hang together by faces")
          .at_least(0)
          .otherwise("all"),
      Field("spacing", options.solid.spacing_mm, "Of the lattice; edges are about as long")
          .unit("mm")
          .positive(),
      Field("elements", options.solid.elements, "About so many, where no spacing is given")
          .range(1, 1e9),
      Field("smooth", options.solid.smooth_voxels,
            "Standard deviation by which steps of voxels are smoothed")
          .unit("voxel")
          .range(0, 10),
      Field("keep_volume", options.solid.keeps_volume,
            "Move the surface as a whole until the volume is that of the voxels"),
  };
}

/// What is meshed, and under which name.
struct Meshed {
  VoxelMask mask;
  std::int32_t region = 1;
  std::string name = "surface";
};

Meshed read_meshed(const MeshOptions& options, Console& console) {
  if (options.range && !options.label.empty()) {
    throw UsageError("mesh: found --range and --label, expected one of them");
  }
  Meshed meshed;
  BrickTopology voxels;
  const auto file = open_volume(options.input, options.read, &console);
  if (options.range || !options.label.empty()) {
    NumberPair range = options.range.value_or(NumberPair());
    if (!options.label.empty()) {
      const LabelNames names = label_names(options.input);
      const auto label = find_label(names, options.label);
      if (!label) {
        throw InputError({options.input, "--label", options.label, expected_label(names)});
      }
      range = {double(*label), double(*label)};
      meshed.region = *label;
      meshed.name = "label_" + std::to_string(*label);
    }
    voxels =
        load_elements(*file, range.first, range.second, options.components, 0, &console).elements;
  } else {
    voxels = load_volume(*file, &console).density.bricks();
    if (options.components > 0) voxels = largest_components(voxels, options.components);
  }
  if (voxels.empty()) {
    throw InputError({options.input, "", "no voxel above the least density", "some tissue"});
  }
  meshed.mask = mask_of(file->header().geometry, voxels);
  return meshed;
}

void write_surface(const std::string& path, const SolidMesh& mesh) {
  LineNetwork network;
  std::vector<std::int32_t> number(mesh.nodes_lps_mm.size(), -1);
  for (const FaceSet& faces : mesh.faces) {
    for (const auto& triangle : faces.triangles) {
      std::array<int, 3> corners{};
      for (std::size_t c = 0; c < 3; ++c) {
        std::int32_t& node = number[std::size_t(triangle[c])];
        if (node < 0) {
          node = std::int32_t(network.mesh.vertices_lps_mm.size());
          network.mesh.vertices_lps_mm.push_back(mesh.nodes_lps_mm[std::size_t(triangle[c])]);
        }
        corners[c] = node;
      }
      network.mesh.triangles.push_back(corners);
    }
  }
  write_mesh(path, network);
}

void write_outputs(const MeshOptions& options, const SolidMesh& mesh, Console& console) {
  for (const std::string& path : options.outputs) {
    if (is_solid_mesh_name(path)) {
      write_solid_mesh(path, mesh, &console);
    } else {
      write_surface(path, mesh);
    }
  }
}

Value report_of(const Meshed& meshed, const SolidParams& params, const SolidMesh& mesh,
                const SolidReport& made) {
  const SolidQuality quality = quality_of(mesh);
  const VoxelCover cover = cover_of(meshed.mask, mesh);
  const double voxel_ml = std::abs(meshed.mask.geometry.determinant()) / kMm3PerMl;
  std::size_t triangles = 0;
  SurfaceTopology surface;
  for (const FaceSet& faces : mesh.faces) {
    triangles += faces.triangles.size();
    const SurfaceTopology own = topology_of(faces.triangles);
    surface.open_edges += own.open_edges;
    surface.pinched_edges += own.pinched_edges;
  }
  double volume_ml = 0;
  for (const auto& [region, volume] : quality.volume_mm3) volume_ml += volume / kMm3PerMl;
  return {
      {"nodes", mesh.nodes_lps_mm.size()},
      {"tetrahedra", mesh.tets.size()},
      {"triangles", triangles},
      {"spacing_mm", spacing_for(params, meshed.mask.volume_mm3())},
      {"least_dihedral_deg", quality.least_dihedral_deg},
      {"largest_dihedral_deg", quality.largest_dihedral_deg},
      {"mean_aspect", quality.mean_aspect},
      {"largest_aspect", quality.largest_aspect},
      {"edges_mm",
       Value({quality.shortest_edge_mm, quality.mean_edge_mm, quality.longest_edge_mm})},
      {"element_volumes_mm3",
       Value({quality.least_volume_mm3, quality.mean_volume_mm3, quality.largest_volume_mm3})},
      {"turned_inside_out", quality.turned_inside_out},
      {"volume_ml", volume_ml},
      {"voxels_ml", double(meshed.mask.count()) * voxel_ml},
      {"lost_ml", double(cover.lost) * voxel_ml},
      {"gained_ml", double(cover.gained) * voxel_ml},
      {"pieces", count_pieces(mesh)},
      {"open_edges", surface.open_edges},
      {"pinched_edges", surface.pinched_edges},
      {"surface_outwards_mm", made.outwards_mm},
      {"passes", made.passes},
  };
}

void print_report(const Value& report) {
  const auto number = [&](const char* key) { return report[key].number(); };
  const auto count = [&](const char* key) { return static_cast<long long>(report[key].whole()); };
  std::printf("%lld tetrahedra, %lld nodes, %lld triangles of the surface; spacing %.4g mm\n",
              count("tetrahedra"), count("nodes"), count("triangles"), number("spacing_mm"));
  std::printf("dihedral angles  %.2f to %.2f degrees\n", number("least_dihedral_deg"),
              number("largest_dihedral_deg"));
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
  std::printf("surface          %s; %lld edges at which parts touch; %lld %s\n",
              count("open_edges") == 0 ? "closed" : "open", count("pinched_edges"), count("pieces"),
              count("pieces") == 1 ? "piece" : "pieces");
}

int run_mesh(const MeshOptions& options, const GlobalOptions& global, Console& console) {
  OutputPlan plan(global.force);
  plan.protect(options.input, options.read);
  for (const std::string& output : options.outputs) {
    if (!is_solid_mesh_name(output) && !is_mesh_name(output)) {
      throw InputError({output, "output", "another extension",
                        ".vtu, .inp, .feb, .msh, or for the surface .stl, .ply, .obj or .vtk"});
    }
    plan.add_like(output, output);
  }
  console.claim(plan.files());
  const Meshed meshed = read_meshed(options, console);
  SolidReport made;
  const SolidMesh mesh =
      make_tets(meshed.mask, options.solid, meshed.region, meshed.name, &made, &console);
  console.stage("measuring");
  const Value report = report_of(meshed, options.solid, mesh, made);
  write_outputs(options, mesh, console);
  console.stage_seconds();
  if (global.json) {
    std::printf("%s\n", json_text(report, 2).c_str());
  } else if (!global.quiet) {
    console.clear_line();
    print_report(report);
  }
  return kOk;
}

}  // namespace

Command add_mesh(CLI::App& program) {
  auto options = std::make_shared<MeshOptions>();
  CLI::App* app = add_subcommand(
      program, "mesh", "Tetrahedra of the tissue of a volume, for programs of finite elements",
      "  supple mesh brain.nii.gz --elements 35000 -o brain.vtu\n"
      "  supple mesh head.nhdr --range 300,3100 --spacing 3 -o skull.inp -o skull.stl\n"
      "  supple mesh labels.nii.gz --label 41 --spacing 1.5 --json -o part.feb");
  app->add_option("input", options->input, "A volume or a label volume")
      ->required()
      ->option_text("IN");
  app->add_option("-o,--output", options->outputs,
                  "Mesh to write: .vtu, .inp, .feb or .msh; its surface: .stl, .ply, .obj or .vtk; "
                  "repeatable")
      ->required()
      ->allow_extra_args(false)
      ->option_text("OUT");
  add_field_options(*app, fields(*options));
  for (const Field& field : fields(options->read)) {
    if (field.name() != "spacing") add_field_options(*app, {field});
  }
  return {app, [options](const GlobalOptions& global, Console& console) {
            return run_mesh(*options, global, console);
          }};
}

}  // namespace supple::tools
