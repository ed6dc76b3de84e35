// supple probe: what is at a place of a volume or state: frames, density, material, displacement.
#include <cmath>
#include <cstdio>

#include "lib/material/material.h"
#include "lib/session/handles/handles.h"
#include "lib/session/session.h"
#include "tools/console/command.h"
#include "tools/console/field_options.h"
#include "tools/console/parse.h"
#include "tools/scene/run/reports.h"
#include "volumes/base/error.h"
#include "volumes/base/json.h"
#include "volumes/base/text.h"
#include "volumes/grid/voxel_sets.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/load/label_file.h"
#include "volumes/io/load/values_at.h"

namespace supple::tools {

namespace {

struct ProbeOptions {
  std::string input, material, labels;
  std::vector<std::string> at;
  ReadOptions read;
};

struct ProbedPlace {
  Vec3d index, lps_mm;
  Vec3i voxel;  // nearest
};

ProbedPlace place_at(const std::string& text, const Geometry& geometry) {
  PlacedSelection given;
  const PlaceText place = parse_place("--at", text);
  Table({{"frame", place.frame}, {"piece_at", place.numbers}}, "--at").read(fields(given));
  ProbedPlace found;
  found.index = index_of(*given.piece_at, given.frame, geometry);
  found.lps_mm = geometry.world_from_index(found.index);
  for (int c = 0; c < 3; ++c) {
    const double at = found.index[c];
    if (!(at >= -0.5 && at < geometry.dims()[c] - 0.5)) {
      throw InputError({"", "--at", text + ", voxel " + to_text(found.index),
                        "a place inside the volume of " + to_text(geometry.dims()) + " voxels"});
    }
    found.voxel[c] = std::min(int(std::lround(at)), geometry.dims()[c] - 1);
  }
  return found;
}

Value describe(const ProbedPlace& place) {
  const Vec3d& lps = place.lps_mm;
  return {{"voxel", {place.voxel.x, place.voxel.y, place.voxel.z}},
          {"index", place.index},
          {"lps_mm", lps},
          {"ras_mm", {-lps.x, -lps.y, lps.z}}};
}

/// The limits of the links to the six neighbours, as factors of the voxel size along the link.
Value links_at(const Body& body, Slot slot) {
  const MaterialClasses classes(body.material);
  Value links = Value::List();
  for (int axis = 0; axis < 3; ++axis) {
    for (const bool ahead : {false, true}) {
      const std::string name = std::string(ahead ? "+" : "-") + "ijk"[axis];
      Slot other = 0;
      if (!neighbour_slot(body.elements, {}, slot, axis, ahead, other)) continue;
      if (!neighbour_slot(body.elements, body.cuts, slot, axis, ahead, other)) {
        links.push_back({{"to", name}, {"cut", true}});
        continue;
      }
      const LinkLimits limits = classes.limits(axis, body.classes[slot], body.classes[other]);
      links.push_back({{"to", name},
                       {"min_length", limits.min_length},
                       {"max_length", limits.max_length},
                       {"shear", {limits.shear1, limits.shear2}}});
    }
  }
  return links;
}

/// What a body knows of a place, which is one at rest.
void add_element(Value& json, const ProbedPlace& place, const Session& session,
                 const State& state) {
  const Body& body = session.body();
  Slot slot = 0;
  const bool is_element = slot_of(body.elements, place.voxel, slot);
  json["element"] = is_element;
  if (!is_element) return;
  if (!state.labels.empty()) json["label"] = state.labels.at(slot);
  json["class"] = body.classes[slot];
  json["links"] = links_at(body, slot);
}

/// Material direction, of the tissue that is here at rest; and where what is here now came from.
void add_motion(Value& json, const ProbedPlace& place, const Pose& pose) {
  const Geometry& geometry = pose.offsets.geometry;
  const auto add = [&](const char* name, const char* end, const Vec3d& vector) {
    json[std::string(name) + "_mm"] = geometry.world_vector_from_index(vector);
    json[end] = geometry.world_from_index(place.index + vector);
  };
  Vec3d vector;
  if (pose.displacement.u.sample(place.index, vector)) {
    add("displacement", "moved_to_lps_mm", vector);
  }
  if (pose.offsets.sample(place.index, vector)) add("offset", "came_from_lps_mm", vector);
}

Value probe_body(const ProbeOptions& options, bool is_state, Console& console) {
  SessionOptions given;
  given.labels_path = options.labels;
  given.read = options.read;
  if (!options.material.empty()) {
    given.material =
        is_tissue_preset("--material", options.material)
            ? preset_material(options.material)
            : read_material(options.material,
                            options.labels.empty() ? LabelNames() : label_names(options.labels));
  }
  Session session(options.input, given, &console);
  const State state = session.state();
  Value json = Value::List();
  std::vector<Vec3i> voxels;
  for (const std::string& text : options.at) {
    const ProbedPlace place = place_at(text, session.geometry());
    voxels.push_back(place.voxel);
    json.push_back(describe(place));
    Value& entry = json.back();
    if (state.density.bricks().is_active(place.voxel)) {
      entry["density"] = state.density.at(place.voxel);
    }
    add_element(entry, place, session, state);
    if (is_state) add_motion(entry, place, session.pose(&console));
  }
  if (is_state) return json;
  const auto densities = values_at(*open_volume(options.input, options.read), voxels);
  for (std::size_t n = 0; n < voxels.size(); ++n) json[n]["density"] = densities[n];
  return json;
}

Value probe_volume(const ProbeOptions& options) {
  const auto file = open_volume(options.input, options.read);
  const Geometry geometry = file->header().geometry;
  Value json = Value::List();
  std::vector<Vec3i> voxels;
  for (const std::string& text : options.at) {
    const ProbedPlace place = place_at(text, geometry);
    voxels.push_back(place.voxel);
    json.push_back(describe(place));
  }
  const std::vector<float> densities = values_at(*file, voxels);
  for (std::size_t n = 0; n < voxels.size(); ++n) json[n]["density"] = densities[n];
  if (options.labels.empty()) return json;
  const BrickTopology asked = topology_of(voxels);
  const BrickValues labels = read_labels(options.labels, geometry, asked);
  for (std::size_t n = 0; n < voxels.size(); ++n) {
    Slot slot;
    const bool is_found = slot_of(asked, voxels[n], slot) && !labels.empty();
    json[n]["label"] = is_found ? labels.at(slot) : 0;
  }
  return json;
}

std::string list_text(const Value& list) {
  std::string text;
  for (const Value& value : list.items()) {
    text += (text.empty() ? "" : ", ") + number_text(value.number());
  }
  return text;
}

void print_place(const Value& place) {
  const auto print = [&](const char* key, const char* name) {
    if (!place.contains(key)) return;
    const auto& value = place[key];
    const std::string text = value.is_list()    ? list_text(value)
                             : value.is_truth() ? std::string(value.truth() ? "yes" : "no")
                             : value.is_null()  ? std::string("no number")
                                                : list_text(Value::List{value});
    std::printf("%-16s%s\n", name, text.c_str());
  };
  print("voxel", "voxel");
  print("index", "index");
  print("lps_mm", "LPS mm");
  print("ras_mm", "RAS mm");
  print("density", "density");
  print("element", "element");
  print("label", "label");
  print("class", "class");
  for (const Value& link : place["links"].items()) {
    const std::string to = link["to"].text();
    if (link.contains("cut")) {
      std::printf("link to %-8scut\n", to.c_str());
      continue;
    }
    std::printf("link to %-8slength %.4g to %.4g, shear %s of the voxel size\n", to.c_str(),
                link["min_length"].number(), link["max_length"].number(),
                list_text(link["shear"]).c_str());
  }
  print("displacement_mm", "displacement mm");
  print("moved_to_lps_mm", "moved to LPS mm");
  print("offset_mm", "offset mm");
  print("came_from_lps_mm", "came from LPS");
}

int run_probe(const ProbeOptions& options, const GlobalOptions& global, Console& console) {
  const bool is_state = is_state_file(options.input);
  const bool needs_body = is_state || !options.material.empty();
  const Value places = needs_body ? probe_body(options, is_state, console) : probe_volume(options);
  if (global.json) {
    std::printf("%s\n", json_text({{"places", places}}, 2).c_str());
    return kOk;
  }
  for (std::size_t n = 0; n < places.size(); ++n) {
    if (n > 0) std::printf("\n");
    print_place(places[n]);
  }
  return kOk;
}

}  // namespace

Command add_probe(CLI::App& program) {
  CLI::App* app = add_subcommand(
      program, "probe",
      "What is at a place: voxel, LPS and RAS, density, label, material, displacement",
      "  supple probe head.nhdr --at 128,211,12\n"
      "  supple probe head.nhdr --material ct.toml --at lps:0.5,-79.9,-62.3 --at ras:20,80,-60\n"
      "  supple probe drag.vdb --at 128,211,12 --json");
  auto options = std::make_shared<ProbeOptions>();
  app->add_option("input", options->input, "A volume file, or a state")
      ->required()
      ->option_text("VOLUME|STATE.vdb");
  app->add_option("--at", options->at,
                  "Voxel I,J,K, or lps:X,Y,Z or ras:X,Y,Z in mm; of a state, a place at rest; "
                  "repeatable")
      ->required()
      ->allow_extra_args(false)
      ->option_text("PLACE");
  app->add_option("--material", options->material,
                  "Look-up table, or a preset such as ct-head: also tells "
                  "class and limits of links")
      ->option_text("M.toml|NAME");
  app->add_option("--labels", options->labels, "Label volume on the same grid")
      ->option_text("FILE");
  add_field_options(*app, fields(options->read));
  return {app, [options](const GlobalOptions& global, Console& console) {
            return run_probe(*options, global, console);
          }};
}

}  // namespace supple::tools
