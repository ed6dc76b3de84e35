// supple mesh: elements of the tissue of a volume, or of labels, for programs of finite elements,
// and how good they are.
#include <cstdio>
#include <limits>

#include "lib/material/tissue.h"
#include "lib/mesh/tets/element_materials.h"
#include "lib/mesh/tets/make_solid.h"
#include "lib/mesh/tets/solid_faces.h"
#include "lib/mesh/tets/voxel_hexes.h"
#include "tools/commands/volumes/mesh_report.h"
#include "tools/console/command.h"
#include "tools/console/field_options.h"
#include "tools/console/parse.h"
#include "tools/scene/run/output_plan.h"
#include "volumes/base/json.h"
#include "volumes/grid/voxel_sets.h"
#include "volumes/io/load/label_file.h"
#include "volumes/io/load/load.h"
#include "volumes/io/mesh/mesh_contents.h"
#include "volumes/io/mesh/mesh_writer.h"
#include "volumes/io/solid/solid_mesh_file.h"

namespace supple::tools {

namespace {

struct MeshOptions {
  std::string input, material;
  std::vector<std::string> outputs, labels;
  ReadOptions read;
  std::optional<NumberPair> range;
  std::optional<int> hex;
  int components = 0, bins = 32;
  SolidParams solid;
};

Fields fields(MeshOptions& options) {
  Fields all = {
      Field("range", options.range, "Densities that are meshed")
          .shown_as("LO,HI")
          .otherwise("those that the material has, else all above the least"),
      Field("components", options.components,
            "The number of largest pieces that are kept; pieces hang together by faces")
          .at_least(0)
          .otherwise("as the material says, else all"),
  };
  for (const Field& field : fields(options.solid)) all.push_back(field);
  const Fields more = {
      Field("hex", options.hex,
            "Hexahedra of blocks of so many voxels along each axis: 1, 2, 4 … 64")
          .shown_as("VOXELS"),
      Field("bins", options.bins, "At most so many materials, in steps of equal ratio")
          .range(1, 10000),
  };
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

/// The voxels that become elements, with their densities or labels and the material's curves.
struct Meshed {
  VoxelMask mask;
  DensityGrid density;
  std::optional<ElasticOfLabels> elastic;
  std::int32_t region = 1;  // where there is one alone
  bool are_labels = false;  // densities are labels of several regions
  std::map<std::int32_t, std::string> names{{1, "surface"}};

  VoxelLabel label_of() const {
    return [this](const Vec3i& voxel) {
      return are_labels ? std::int32_t(density.at(voxel)) : region;
    };
  }
};

MaterialTable read_table(const MeshOptions& options, Console& console) {
  MaterialTable table = is_tissue_preset("--material", options.material)
                            ? preset_material(options.material)
                            : read_material(options.material, label_names(options.input));
  if (!table.fits_domain && !table.finds_foreground) return table;
  const auto file = open_volume(options.input, options.read);
  return fitted_to(std::move(table), digest_volume(*file, &console).statistics);
}

/// The labels that are meshed, by number; empty: all.
std::vector<std::int32_t> wanted_labels(const MeshOptions& options) {
  std::vector<std::int32_t> labels;
  if (options.labels == std::vector<std::string>{"all"}) return labels;
  const LabelNames names = label_names(options.input);
  for (const std::string& text : options.labels) {
    const auto label = find_label(names, text);
    if (!label) throw InputError({options.input, "--label", text, expected_label(names)});
    labels.push_back(*label);
  }
  return labels;
}

BrickTopology only_labels(const DensityGrid& density, const BrickTopology& voxels,
                          const std::vector<std::int32_t>& labels) {
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  for (std::size_t b = 0; b < voxels.brick_count(); ++b) {
    BrickMask mask{};
    for_each_active(voxels.mask(b), [&](int offset) {
      const float value = density.at(voxels.origin(b) + brick_local(offset));
      const auto is_it = [&](std::int32_t label) { return float(label) == value; };
      if (std::any_of(labels.begin(), labels.end(), is_it)) mask_set(mask, offset);
    });
    origins.push_back(voxels.origin(b));
    masks.push_back(mask);
  }
  return {std::move(origins), std::move(masks)};
}

/// Throws InputError at the first value that is no label, where all labels are meshed.
void require_labels(const std::string& path, const ElementVolume& loaded) {
  const auto require_label = [&](double value) {
    if (value >= 0 && value <= kMaxLabel && is_integer(value)) return;
    throw InputError({path, "--label all", "the value " + number_text(value),
                      "integers from 1 to " + std::to_string(kMaxLabel) + ", and 0 where none is"});
  };
  require_label(loaded.volume.statistics.min);
  for (std::size_t b = 0; b < loaded.elements.brick_count(); ++b) {
    for_each_active(loaded.elements.mask(b), [&](int offset) {
      require_label(loaded.volume.density.at(loaded.elements.origin(b) + brick_local(offset)));
    });
  }
}

/// The voxels of labels; several become regions.
BrickTopology read_labelled(const MeshOptions& options, Meshed& meshed, Console& console) {
  const std::vector<std::int32_t> labels = wanted_labels(options);
  double lo = std::numeric_limits<float>::min(), hi = std::numeric_limits<float>::max();
  if (!labels.empty()) {
    lo = *std::min_element(labels.begin(), labels.end());
    hi = *std::max_element(labels.begin(), labels.end());
    meshed.region = std::int32_t(lo);
  }
  const auto file = open_volume(options.input, options.read, &console);
  ElementVolume loaded = load_elements(*file, lo, hi, options.components, 0, &console);
  if (labels.empty()) require_labels(options.input, loaded);
  meshed.density = loaded.volume.density;
  meshed.names.clear();
  for (const auto& [label, name] : label_names(options.input)) meshed.names[label] = name;
  meshed.are_labels = lo != hi;
  if (labels.size() <= 1) return loaded.elements;
  for (const std::int32_t label : labels) {
    const std::vector<std::int32_t> one = {label};
    if (!only_labels(meshed.density, loaded.elements, one).empty()) continue;
    throw InputError({options.input, "--label", std::to_string(label) + ", which no voxel has",
                      "a label of the volume"});
  }
  return only_labels(meshed.density, loaded.elements, labels);
}

BrickTopology read_densities(const MeshOptions& options, const std::optional<NumberPair>& range,
                             int components, Meshed& meshed, Console& console) {
  const auto file = open_volume(options.input, options.read, &console);
  if (range) {
    ElementVolume loaded =
        load_elements(*file, range->first, range->second, components, 0, &console);
    meshed.density = loaded.volume.density;
    return loaded.elements;
  }
  meshed.density = load_volume(*file, &console).density;
  const BrickTopology& voxels = meshed.density.bricks();
  return components > 0 ? largest_components(voxels, components) : voxels;
}

Meshed read_meshed(const MeshOptions& options, Console& console) {
  Meshed meshed;
  std::optional<NumberPair> range = options.range;
  int components = options.components;
  if (!options.material.empty()) {
    const MaterialTable table = read_table(options, console);
    meshed.elastic = elastic_curves(table);
    if (!range) range = NumberPair(table.active_lo, table.active_hi);
    if (components == 0) components = table.components;
  }
  const BrickTopology voxels = options.labels.empty()
                                   ? read_densities(options, range, components, meshed, console)
                                   : read_labelled(options, meshed, console);
  if (voxels.empty()) {
    throw InputError({options.input, "", "no voxel that is to be meshed", "some tissue"});
  }
  meshed.mask = mask_of(open_volume(options.input, options.read)->header().geometry, voxels);
  return meshed;
}

/// The mesh with its regions, faces and materials; facts about its making go into the report.
SolidMesh make_mesh(const MeshOptions& options, const Meshed& meshed, Value& report,
                    Console& console) {
  SolidMesh mesh;
  if (options.hex) {
    mesh = make_hexes(meshed.mask, *options.hex, meshed.region);
    if (meshed.are_labels) give_regions(mesh, meshed.mask, meshed.label_of());
    mesh.faces = faces_of_regions(mesh, meshed.names);
  } else {
    SolidReport made;
    mesh = make_tets(meshed.mask, meshed.label_of(), options.solid, meshed.names, &made, &console);
    report["spacing_mm"] = spacing_for(options.solid, meshed.mask.volume_mm3());
    report["surface_outwards_mm"] = made.outwards_mm;
    report["passes"] = made.passes;
    const double voxel_ml = std::abs(meshed.mask.geometry.determinant()) / 1000;
    report["thin_ml"] = double(made.thin) * voxel_ml;
    report["thin_lost_ml"] = double(made.thin_lost) * voxel_ml;
  }
  if (meshed.elastic) {
    give_materials(mesh, meshed.mask, meshed.density, *meshed.elastic, meshed.label_of(),
                   options.bins);
  }
  return mesh;
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

void plan_outputs(const MeshOptions& options, const GlobalOptions& global, Console& console) {
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
}

/// Throws UsageError for options that exclude each other, InputError for blocks that cannot be.
void check_options(const CLI::App& app, const MeshOptions& options) {
  const auto fail = [](const std::string& found, const std::string& expected) {
    throw UsageError("mesh: found " + found + ", expected " + expected);
  };
  if (options.range && !options.labels.empty()) fail("--range and --label", "one of them");
  const bool are_several =
      options.labels.size() > 1 || options.labels == std::vector<std::string>{"all"};
  if (options.components > 0 && are_several) {
    fail("--components and several labels", "one label with --components");
  }
  if (app.count("--bins") > 0 && options.material.empty()) {
    fail("--bins without --material", "both of them");
  }
  if (!options.hex) return;
  for (const char* option :
       {"--spacing", "--elements", "--smooth", "--no-keep-volume", "--coarser", "--thin"}) {
    if (app.count(option) > 0) fail("--hex and " + std::string(option), "one of them");
  }
  require_block(*options.hex);
}

int run_mesh(const MeshOptions& options, const GlobalOptions& global, Console& console) {
  plan_outputs(options, global, console);
  const Meshed meshed = read_meshed(options, console);
  Value made;
  const SolidMesh mesh = make_mesh(options, meshed, made, console);
  console.stage("measuring");
  Value report = mesh_report(mesh, meshed.mask, voxels_of_labels(meshed.mask, meshed.label_of()));
  report.update(made);
  for (const std::string& path : options.outputs) {
    if (is_solid_mesh_name(path)) {
      write_solid_mesh(path, mesh, &console);
    } else {
      write_surface(path, mesh);
    }
  }
  console.stage_seconds();
  if (global.json) {
    std::printf("%s\n", json_text(report, 2).c_str());
  } else if (!global.quiet) {
    console.clear_line();
    print_mesh_report(report);
  }
  return kOk;
}

}  // namespace

Command add_mesh(CLI::App& program) {
  auto options = std::make_shared<MeshOptions>();
  CLI::App* app = add_subcommand(
      program, "mesh",
      "Elements of the tissue of a volume or of labels, for programs of finite elements",
      "  supple mesh brain.nii.gz --elements 35000 -o brain.vtu\n"
      "  supple mesh head.nhdr --material ct-head --spacing 3 -o head.inp -o head.stl\n"
      "  supple mesh labels.nii.gz --label 41 --label 42 --spacing 1.5 -o parts.feb");
  app->add_option("input", options->input, "A volume or a label volume")
      ->required()
      ->option_text("IN");
  app->add_option("-o,--output", options->outputs,
                  "Mesh to write: .vtu, .inp, .feb or .msh; its surface: .stl, .ply, .obj or .vtk; "
                  "repeatable")
      ->required()
      ->allow_extra_args(false)
      ->option_text("OUT");
  app->add_option("--label", options->labels,
                  "Label that is meshed, of a label volume; several, or all, become regions that "
                  "share faces; repeatable")
      ->allow_extra_args(false)
      ->option_text("N|NAME|all");
  app->add_option("--material", options->material,
                  "Table whose stiffness and Poisson's ratio the elements get by their densities")
      ->option_text("M.toml|NAME");
  add_field_options(*app, fields(*options));
  for (const Field& field : fields(options->read)) {
    if (field.name() != "spacing") add_field_options(*app, {field});
  }
  return {app, [app, options](const GlobalOptions& global, Console& console) {
            check_options(*app, *options);
            return run_mesh(*options, global, console);
          }};
}

}  // namespace supple::tools
