#include "tools/viewer/page_queries.h"

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "lib/material/material.h"
#include "lib/material/presets.h"
#include "lib/relax/relaxation.h"
#include "lib/session/spring_step.h"
#include "lib/session/step_model.h"
#include "tools/scene/file/live_event.h"
#include "tools/scene/run/reports.h"
#include "tools/viewer/saving.h"
#include "volumes/base/value.h"
#include "volumes/io/format/volume_file.h"

namespace supple::tools {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostListed = 2000;

const char* kind_of_file(const std::string& name) {
  const std::string extension = fs::path(name).extension().string();
  if (extension == ".toml") return "scene";
  if (extension == ".vdb") return "state";
  static const std::vector<std::string> volumes = {".nrrd", ".nhdr", ".mha",  ".mhd", ".nii",
                                                   ".gz",   ".hdr",  ".dcm",  ".tif", ".tiff",
                                                   ".png",  ".h5",   ".hdf5", ".raw"};
  return std::find(volumes.begin(), volumes.end(), extension) != volumes.end() ? "volume" : "other";
}

Value roots_json(const Folders& folders) {
  return {
      {"path", ""}, {"parent", nullptr}, {"folders", folders.roots()}, {"files", Value::List()}};
}

/// What a folder holds but for hidden files, names ascending; links that lead out are left out.
Value list_json(const std::string& path, const Folders& folders) {
  if (path.empty()) return roots_json(folders);
  const std::string folder = folders.input(path);
  std::vector<std::string> inside;
  std::vector<std::pair<std::string, std::uintmax_t>> files;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name.empty() || name.front() == '.') continue;
    if (inside.size() + files.size() == kMostListed) break;
    std::error_code missing;
    if (entry->is_symlink(missing)) {
      try {
        folders.input(entry->path().string());
      } catch (const InputError&) {
        continue;
      }
    }
    if (entry->is_directory(missing)) inside.push_back(name);
    if (entry->is_regular_file(missing)) files.emplace_back(name, entry->file_size(missing));
  }
  if (error) throw InputError({path, "list", "no folder to be read", "a folder"});
  std::sort(inside.begin(), inside.end());
  std::sort(files.begin(), files.end());
  Value json = {{"path", folder}, {"parent", ""}, {"folders", inside}, {"files", Value::List()}};
  const std::vector<std::string>& roots = folders.roots();
  if (std::find(roots.begin(), roots.end(), folder) == roots.end()) {
    json["parent"] = fs::path(folder).parent_path().string();
  }
  for (const auto& [name, bytes] : files) {
    json["files"].push_back({{"name", name}, {"bytes", bytes}, {"kind", kind_of_file(name)}});
  }
  return json;
}

const char* type_of(const Field& field) {
  if (!field.names().empty()) return "choice";
  if (field.holds<bool>()) return "bool";
  if (field.holds<int>()) return "integer";
  if (field.holds<double>()) return "number";
  if (field.holds<std::string>()) return "text";
  return "vector";
}

/// What the command line's help says of them.
Value options_json(const Fields& fields) {
  Value json = Value::List();
  for (const Field& field : fields) {
    Value one = {{"name", field.name()}, {"type", type_of(field)}, {"help", field.traits().help}};
    if (!field.names().empty()) one["choices"] = field.names();
    if (!field.traits().unit.empty()) one["unit"] = field.traits().unit;
    one["allowed"] = field.allowed();
    const Value value = field.value();
    if (!value.is_null()) one["default"] = value;
    json.push_back(std::move(one));
  }
  return json;
}

/// Behind the name of a model in the menu that is under the hand.
constexpr const char* kUnderHand = "/hand";

/// The menu of models, and whether each has keys.
Value models_json() {
  Value json = Value::List();
  for (const StepModel& model : step_models()) {
    json.push_back({{"name", model.name}, {"title", model.menu}, {"has_keys", bool(model.fields)}});
    Step step;
    if (model.choose) model.choose(step);
    if (!why_not_under_hand(step).empty()) continue;
    std::string title = model.title + ", under the hand";
    title[0] = char(std::toupper(title[0]));
    json.push_back({{"name", model.name + kUnderHand}, {"title", title}, {"has_keys", false}});
  }
  return json;
}

Value options_of(const std::string& kind) {
  if (kind == "relax") {
    RelaxParams params;
    return options_json(fields(params));
  }
  if (kind == "models") return models_json();
  for (const StepModel& model : step_models()) {
    if (kind != model.name || !model.fields) continue;
    Step step;
    model.choose(step);
    if (step.fem && !step.fem->tets) {
      step.fem->params.set_accuracy(FemAccuracy::picture);  // which a page is for
      step.fem->links_beyond = LinksBeyond::keep;
    }
    return options_json(model.fields(step));
  }
  if (kind == "save") {
    SaveRequest request;
    return options_json(fields(request));
  }
  if (kind == "slices") {
    SliceSettings slices;
    return options_json(fields(slices));
  }
  throw InputError({"options", "kind", "'" + kind + "'", "models, relax, a model, save or slices"});
}

Value presets_json() {
  Value json = Value::List();
  for (const std::string& name : preset_names()) json.push_back(transfer_json(preset(name)));
  return json;
}

/// Presets of materials, each with its whole table.
Value material_presets_json() {
  Value json = Value::List();
  for (const TissuePreset& preset : tissue_presets()) {
    const Table table = Table::parse(preset.table, preset.name);
    json.push_back({{"name", preset.name}, {"table", table.value()}});
  }
  return json;
}

/// A string of the message's only key.
std::string text_in(const PageMessage& message, const char* key) {
  Table table = table_of(message);
  const std::string text = table.require(table.get<std::string>(key), key, "a text");
  table.finish();
  return text;
}

}  // namespace

Value query(const PageMessage& message, const Folders& folders) {
  if (message.verb == "list") return list_json(text_in(message, "path"), folders);
  if (message.verb == "options") return options_of(text_in(message, "kind"));
  if (message.verb == "presets") return presets_json();
  return material_presets_json();
}

int histogram_bins(Table& table) {
  int bins = 256;
  table.read({Field("bins", bins, "Of equal width").range(2, 4096)});
  table.finish();
  return bins;
}

Value histogram_json(OpenScene& scene, int bins) {
  const State& state = scene.picture().opened();
  const DensityGrid& density = state.density;
  float lo = 0, hi = 0;
  bool is_first = true;
  const auto for_each_element = [&](const auto& visit) {
    for (std::size_t b = 0; b < state.elements.brick_count(); ++b) {
      const std::int32_t source = density.bricks().find(state.elements.origin(b));
      if (source < 0) continue;
      for_each_active(state.elements.mask(b),
                      [&](int offset) { visit(density.values(std::size_t(source))[offset]); });
    }
  };
  for_each_element([&](float value) {
    lo = is_first ? value : std::min(lo, value);
    hi = is_first ? value : std::max(hi, value);
    is_first = false;
  });
  std::vector<std::int64_t> counts(std::size_t(bins), 0);
  const double scale = hi > lo ? bins / (double(hi) - lo) : 0;
  for_each_element([&](float value) {
    const int bin = std::clamp(int((double(value) - lo) * scale), 0, bins - 1);
    ++counts[std::size_t(bin)];
  });
  return {{"lo", lo}, {"hi", hi}, {"counts", counts}};
}

Value material_json(OpenScene& scene) {
  const std::string text = material_to_toml(scene.live().session().material());
  return Table::parse(text, "material").value();
}

Value slices_json(SliceSettings slices) {
  Value json = fields_value(fields(slices));
  json["centre"] = Value::Entries();
  json["turned"] = Value::Entries();
  for (std::size_t plane = 0; plane < 3; ++plane) {
    if (slices.centre[plane]) {
      json["centre"][kViewNames[plane + 1]] = *slices.centre[plane];
    }
    if (const auto& axes = slices.turned[plane]) {
      json["turned"][kViewNames[plane + 1]] = {{"right", axes->right}, {"down", axes->down}};
    }
  }
  return json;
}

}  // namespace supple::tools
