// supple info: the contents of volume, warp and state files.
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "lib/session/deformable_mesh.h"
#include "lib/state/state.h"
#include "lib/state/state_source.h"
#include "tools/console/command.h"
#include "tools/console/field_options.h"
#include "tools/console/result_lines.h"
#include "tools/scene/plan/scene_plan.h"
#include "tools/scene/run/reports.h"
#include "volumes/base/json.h"
#include "volumes/base/sha256.h"
#include "volumes/grid/labels.h"
#include "volumes/io/bytes/input_file.h"
#include "volumes/io/bytes/value_type.h"
#include "volumes/io/format/formats.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/load/load.h"
#include "volumes/io/mesh/mesh_contents.h"
#include "volumes/io/vtu/vtu.h"

namespace supple::tools {

namespace {

/// Bytes in which VTK's XML says what it holds.
constexpr std::size_t kVtkHead = 1024;

struct InfoOptions {
  std::vector<std::string> inputs;
  ReadOptions read;
};

void add_geometry(Value& json, const Geometry& geometry) {
  const Vec3d& origin = geometry.origin_lps_mm();
  const auto direction = geometry.direction();
  const auto& axes = geometry.axes_mm();
  json["dims"] = {geometry.dims().x, geometry.dims().y, geometry.dims().z};
  json["spacing_mm"] = geometry.spacing_mm();
  json["origin_lps_mm"] = origin;
  Value rows = Value::List(), affine = Value::List();
  for (int row = 0; row < 3; ++row) {
    rows.push_back({direction[0][row], direction[1][row], direction[2][row]});
    affine.push_back({axes[0][row], axes[1][row], axes[2][row], origin[row]});
  }
  affine.push_back({0.0, 0.0, 0.0, 1.0});
  json["direction"] = rows;
  json["affine_lps"] = affine;
}

/// Vectors of a warp: how long they are, beside what a volume says.
void add_vectors(Value& json, VolumeFile& file, Console& console) {
  const VolumeHeader& header = file.header();
  const Vec3i& dims = header.geometry.dims();
  const std::size_t values = std::size_t(dims.x) * dims.y * header.components;
  std::vector<char> stored(values * bytes_of(header.type));
  std::vector<double> numbers(values);
  Sha256 hash;
  double longest = 0, sum = 0;
  std::int64_t nan_count = 0, infinite_count = 0;
  console.stage("reading");
  for (int k = 0; k < dims.z; ++k) {
    file.read_slice(stored.data());
    hash.update(stored.data(), stored.size());
    scale_values_of(header.type)(stored.data(), values, header.slope, header.intercept,
                                 numbers.data());
    for (std::size_t n = 0; n < values; n += 3) {
      const double length = Vec3d(numbers[n], numbers[n + 1], numbers[n + 2]).length();
      nan_count += std::isnan(length);
      infinite_count += std::isinf(length);
      if (!std::isfinite(length)) continue;
      longest = std::max(longest, length);
      sum += length;
    }
    report(&console, double(k + 1) / dims.z);
  }
  const std::int64_t finite = header.geometry.voxel_count() - nan_count - infinite_count;
  json["components"] = header.components;
  json["direction_of_vectors"] = header.warp_direction.empty() ? "unsaid" : header.warp_direction;
  json["longest_mm"] = longest;
  json["mean_mm"] = finite > 0 ? sum / double(finite) : 0.0;
  json["nan_voxels"] = nan_count;
  json["infinite_voxels"] = infinite_count;
  if (!header.certificate.empty()) {
    json["certificate"] = json_or_null(header.certificate);
  }
  json["bytes_dense"] = stored_bytes(header);
  json["sha256"] = hash.hex();
}

/// Memory of a body of these bricks, for those who open, draw and save it.
void add_memory(Value& json, std::int64_t bricks) {
  const BodyBytes bytes = body_bytes(bricks);
  json["bytes_opened"] = bytes.opened;
  json["bytes_shown"] = bytes.shown;
  json["bytes_saved"] = bytes.saved;
  json["bytes_saved_referring"] = bytes.saved_referring;
}

void add_scalars(Value& json, VolumeFile& file, Console& console) {
  const VolumeHeader& header = file.header();
  const VolumeDigest digest = digest_volume(file, &console);
  json["min"] = digest.statistics.min;
  json["max"] = digest.statistics.max;
  json["mean"] = digest.statistics.mean;
  json["nan_voxels"] = digest.statistics.nan_count;
  json["infinite_voxels"] = digest.statistics.infinite_count;
  json["active_voxels"] = digest.statistics.above_min_count;
  json["bytes_dense"] = header.geometry.voxel_count() * bytes_of(header.type);
  json["bytes_sparse"] = digest.sparse_bytes;
  add_memory(json, digest.bricks);
  json["sha256"] = digest.sha256;
}

Value describe_volume(const std::string& path, ReadOptions read, Console& console) {
  std::int64_t frames = 1;
  read.frames_found = &frames;
  const auto file = open_scalars_or_vectors(path, read);
  const VolumeHeader& header = file->header();
  warn_of_all(path, header.warnings, &console);
  if (header.components != 3) require_scalars(header);
  Value json;
  json["format"] = header.format;
  if (!header.modality.empty()) json["modality"] = header.modality;
  json["type"] = numpy_name(header.type);
  if (frames > 1) {
    json["frames"] = frames;
    json["frame"] = read.frame.value_or(0);
    if (!header.frame_names.empty()) json["frame_names"] = header.frame_names;
  }
  add_geometry(json, header.geometry);
  for (const auto& [label, name] : header.label_names) {
    json["segments"].push_back({{"label", label}, {"name", name}});
  }
  if (header.components == 3) {
    add_vectors(json, *file, console);
  } else {
    add_scalars(json, *file, console);
  }
  return json;
}

Value describe_body(const DeformableMesh& mesh) {
  const MeshBody& body = mesh.body();
  double moved_mm = 0;
  for (std::size_t n = 0; n < body.node_count(); ++n) {
    moved_mm = std::max(moved_mm, (body.pos_mm[n] - body.rest_mm[n]).length());
  }
  return {{"name", mesh.name()},
          {"nodes", body.node_count()},
          {"links", body.links.size()},
          {"triangles", body.triangles.size()},
          {"moved_mm", moved_mm}};
}

Value describe_state(const std::string& path, Console& console) {
  const State state = read_reachable_state(path, &console);
  const BrickTopology& kept = state.density.bricks();
  double min = 0, max = 0, sum = 0;
  std::int64_t count = 0;
  for (std::size_t b = 0; b < kept.brick_count(); ++b) {
    for_each_active(kept.mask(b), [&](int offset) {
      const double value = state.density.values(b)[offset];
      min = count == 0 ? value : std::min(min, value);
      max = count == 0 ? value : std::max(max, value);
      sum += value;
      ++count;
    });
  }
  std::size_t offset_bytes = 0;
  double longest_voxels = 0;
  for (const BrickValues& q : state.q) {
    offset_bytes += q.bytes();
    for (std::size_t slot = 0; !q.empty() && slot < q.brick_count() * kBrickVoxels; ++slot) {
      longest_voxels = std::max(longest_voxels, std::abs(q.at(slot) / kFixedOne));
    }
  }
  Value json;
  json["format"] = "supple state";
  json["type"] = state.source_type;
  add_geometry(json, state.geometry);
  json["min"] = min;
  json["max"] = max;
  json["mean"] = count > 0 ? sum / double(count) : 0.0;
  json["active_voxels"] = state.elements.active_count();
  json["shell_voxels"] = count - state.elements.active_count();
  json["bytes_dense"] = state.geometry.voxel_count() * std::int64_t(sizeof(float));
  json["bytes_sparse"] = state.density.bytes() + state.elements.bytes() + state.cuts.bytes() +
                         state.labels.bytes() + offset_bytes;
  add_memory(json, std::int64_t(kept.brick_count()));
  json["source"] = state.source_name;
  if (state.source) {
    json["source_path"] = state.source->path;
    json["source_sha256"] = state.source->sha256;
    json["source_is_there"] = !lacks_source(state);
  }
  json["cut_links"] = state.cuts.count();
  json["anchors"] =
      state.anchors.size() + state.anchor_labels.size() + state.anchor_selections.size();
  const auto labels = label_counts(state.labels);
  for (const auto& [label, elements] : labels) json["labels"][std::to_string(label)] = elements;
  json["largest_offset_voxels"] = longest_voxels;
  for (const Value& record : state.meshes) {
    json["bodies"].push_back(describe_body(DeformableMesh(record, path)));
  }
  json["configuration"] = json_or_null(state.configuration);
  return json;
}

Value describe_mesh(const MeshContents& contents) {
  Value json = {{"format", contents.format},
                {"points", contents.points},
                {"cells", contents.cells},
                {"low_lps_mm", contents.low_lps_mm},
                {"high_lps_mm", contents.high_lps_mm}};
  for (const bool is_of_cells : {false, true}) {
    Value& arrays = json[is_of_cells ? "cell_arrays" : "point_arrays"];
    arrays = Value::Entries();
    for (const MeshArray& array : contents.arrays) {
      if (array.is_of_cells == is_of_cells) arrays[array.name] = array.components;
    }
  }
  return json;
}

/// The kind of file by its content, or for meshes by its name.
Value describe_any(const std::string& path, const ReadOptions& read, Console& console) {
  if (is_state_file(path)) return describe_state(path, console);
  if (std::filesystem::is_regular_file(path)) {
    if (is_vtu(InputFile(path).head(kVtkHead))) return describe_mesh(vtu_contents(path));
    if (is_mesh_name(path)) return describe_mesh(mesh_contents(path));
  }
  return describe_volume(path, read, console);
}

/// One "name  value" line per entry; the affine repeats the lines before it.
void print_info(const Value& json) {
  for (const auto& [name, value] : json.entries()) {
    if (name == "affine_lps") continue;
    std::printf("%-22s %s\n", name.c_str(), people_text(value).c_str());
  }
  if (!json.contains("active_voxels")) return;
  const double voxels =
      json["dims"][0].number() * json["dims"][1].number() * json["dims"][2].number();
  const double active = json["active_voxels"].number();
  std::printf("%-22s %.4g %%\n", "occupancy", 100 * active / voxels);
  if (active == 0) return;
  const auto per_voxel = [&](const char* name) { return json[name].number() / active; };
  std::printf("%-22s %.3g opened, %.3g shown, %.3g saved, %.3g saved referring\n",
              "bytes per voxel", per_voxel("bytes_opened"), per_voxel("bytes_shown"),
              per_voxel("bytes_saved"), per_voxel("bytes_saved_referring"));
}

Value describe(const std::string& path, const ReadOptions& read, Console& console) {
  const Value json = describe_any(path, read, console);
  const auto voids = [&](const char* key) { return json.contains(key) ? json[key].whole() : 0; };
  VolumeStatistics statistics;
  statistics.nan_count = voids("nan_voxels");
  statistics.infinite_count = voids("infinite_voxels");
  const std::string void_values = void_values_text(statistics);
  if (!void_values.empty()) console.warn(path + ": " + void_values + " count as void");
  return json;
}

/// Each file after the other. One that cannot be read has a line on stderr, and with --json an
/// entry with the line and the exit code that it would have alone. The exit code of all is that of
/// the first of these.
int run_on_several(const InfoOptions& options, const GlobalOptions& global, Console& console) {
  Value all = Value::List();
  int exit_code = kOk;
  const char* gap = "";
  const auto refuse = [&](const std::string& path, int code, const std::string& line) {
    if (exit_code == kOk) exit_code = code;
    console.error(line);
    all.push_back({{"file", path}, {"error", line}, {"exit_code", code}});
  };
  for (const std::string& path : options.inputs) {
    try {
      Value json = {{"file", path}};
      json.update(describe(path, options.read, console));
      if (!global.json) {
        std::printf("%s", gap);
        print_info(json);
        gap = "\n";
      }
      all.push_back(std::move(json));
    } catch (const InputError& error) {
      if (error.problem().file.empty()) throw;  // an option, which all files share
      refuse(path, kBadInput, error.what());
    } catch (const SystemError& error) {
      refuse(path, kSystem, error.what());
    }
  }
  if (global.json) std::printf("%s\n", json_text(all, 2).c_str());
  return exit_code;
}

int run_info(const InfoOptions& options, const GlobalOptions& global, Console& console) {
  if (options.inputs.size() > 1) return run_on_several(options, global, console);
  const Value json = describe(options.inputs.front(), options.read, console);
  console.stage_seconds();
  if (global.json) {
    std::printf("%s\n", json_text(json, 2).c_str());
  } else {
    print_info(json);
  }
  return kOk;
}

}  // namespace

Command add_info(CLI::App& program) {
  auto options = std::make_shared<InfoOptions>();
  CLI::App* app = add_subcommand(
      program, "info", "Print geometry, type, range and memory of volumes, warps and states",
      "  supple info head.nii.gz\n"
      "  supple info --json drag.vdb warp.nrrd\n"
      "  supple info scan.raw --raw "
      "dims=256,256,108,type=int16,spacing=0.957,0.957,1.5");
  app->add_option("file", options->inputs, "Volumes, folders of slices, warps or states")
      ->required()
      ->option_text("FILE ...");
  add_field_options(*app, fields(options->read));
  return {app, [options](const GlobalOptions& global, Console& console) {
            return run_info(*options, global, console);
          }};
}

}  // namespace supple::tools
