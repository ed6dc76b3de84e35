// supple augment: random deformations of a volume, each with its truth.
#include <cstdio>

#include "lib/state/state_outputs.h"
#include "tools/commands/deform/apply_labels.h"
#include "tools/console/body_options.h"
#include "tools/console/command.h"
#include "tools/console/field_options.h"
#include "tools/scene/augment/augmentation.h"
#include "tools/scene/file/scene.h"
#include "tools/scene/pictures/picture_options.h"
#include "tools/scene/plan/memory_need.h"
#include "tools/scene/run/output_plan.h"
#include "tools/scene/run/scene_run.h"
#include "volumes/base/files.h"
#include "volumes/base/json.h"
#include "volumes/io/format/volume_file.h"

namespace supple::tools {

namespace {

struct AugmentOptions {
  explicit AugmentOptions(CLI::App& app) : scene(app) {}

  SceneOptions scene;
  BodyOptions body;
  AugmentParams params;
  int count = 10, first = 1;
  std::string images, label_maps, warps, back_warps, truth;

  /// Files of one sample: names with a place for its number.
  std::vector<const std::string*> numbered() const {
    std::vector<const std::string*> names;
    for (const std::string* name : {&images, &label_maps, &warps, &back_warps}) {
      if (!name->empty()) names.push_back(name);
    }
    return names;
  }
};

Fields fields(AugmentOptions& options) {
  Fields all{
      Field("count", options.count, "Samples").range(1, 100000),
      Field("first", options.first, "Number of the first, in names and of its motion").at_least(0),
      Field("label_maps", options.label_maps, "The labels of --labels, deformed, per sample")
          .shown_as("VOLUME"),
      Field("warps", options.warps, "Warps of resample direction, per sample").shown_as("FIELD"),
      Field("back_warps", options.back_warps, "Their inverses, of material direction, per sample")
          .shown_as("FIELD"),
      Field("truth", options.truth, "What was done, as JSON: a list with an entry per sample")
          .shown_as("FILE.json"),
  };
  for (Field& field : fields(options.params)) all.push_back(std::move(field));
  return all;
}

Scene scene_of(AugmentOptions& options) {
  SceneOptions& given = options.scene;
  set_body(options.body, given);
  given.call("step[1]", "augment");
  return read_scene(given.scene());
}

void check_options(const AugmentOptions& options) {
  if (options.numbered().empty()) {
    throw UsageError("-o: found no output, expected images, --label-maps or --warps");
  }
  for (const std::string* name : options.numbered()) {
    if (options.count > 1 && !has_frame_number(*name)) {
      throw UsageError("augment: found '" + *name + "', expected a name with a number, as a_%03d" +
                       name->substr(std::min(name->rfind('.'), name->size())));
    }
  }
  if (!options.label_maps.empty() && options.body.labels.empty()) {
    throw UsageError("--label-maps: found no --labels, expected the labels to deform");
  }
}

OutputPlan plan_of(const AugmentOptions& options, const Scene& scene, bool may_overwrite) {
  OutputPlan plan = check_scene(scene, "", may_overwrite);
  for (int n = options.first; n < options.first + options.count; ++n) {
    for (const std::string* name : options.numbered()) plan.add_dense(frame_name(*name, n));
  }
  if (!options.truth.empty()) plan.add_report(options.truth);
  return plan;
}

/// Writes the files of a sample, and says which.
Value write_sample(const AugmentOptions& options, Session& session, const StoredLabels* labels,
                   int number, Console& console) {
  const State state = session.state();
  const Pose& pose = session.pose(&console);
  Value files;
  const auto name_of = [&](const char* key, const std::string& pattern) {
    const std::string name = frame_name(pattern, number);
    files[key] = name;
    return name;
  };
  if (!options.images.empty()) {
    write_resampled(name_of("image", options.images), state, pose, state.geometry, {}, &console);
  }
  if (!options.label_maps.empty()) {
    write_labels(name_of("labels", options.label_maps), *labels, pose.offsets, state.geometry,
                 console);
  }
  if (!options.warps.empty()) {
    write_state_warp({name_of("warp", options.warps), WarpDirection::resample, VoidMode::nearest,
                      state.geometry},
                     state, pose, &console);
  }
  if (!options.back_warps.empty()) {
    write_state_warp({name_of("back_warp", options.back_warps), WarpDirection::material,
                      VoidMode::nearest, state.geometry},
                     state, pose, &console);
  }
  return files;
}

void print(const Value& sample) {
  const Value& certificate = sample["certificate"];
  std::printf("%6lld  part %.3f  smallest det F %.3f  residual %.1e voxel\n",
              static_cast<long long>(sample["sample"].whole()), sample["part"].number(),
              certificate["min_det"].number(), certificate["residual_max_voxels"].number());
}

/// Draws and writes all samples into `truth`, which has those so far where one is interrupted.
void augment(const AugmentOptions& options, const Scene& scene, const GlobalOptions& global,
             Value& truth, Console& console) {
  SessionOptions opening{scene.material, scene.labels_path, scene.read};
  opening.keeps_undo = true;
  Session session(scene.volume_path, opening, &console);
  check_places(scene, session.geometry());
  for (const Step& step : scene.steps) session.step(step, &console);
  std::optional<StoredLabels> labels;
  if (!options.label_maps.empty()) {
    labels.emplace(*open_volume(options.body.labels, {}, &console), &console);
  }
  Augmentation samples(session, options.params);
  for (int n = options.first; n < options.first + options.count; ++n) {
    poll(&console);
    console.enter("sample", n);
    Value sample = samples.draw(n, &console);
    sample["files"] = write_sample(options, session, labels ? &*labels : nullptr, n, console);
    if (!global.json && !global.quiet) print(sample);
    truth.push_back(std::move(sample));
  }
}

int run_augment(AugmentOptions& options, const GlobalOptions& global, Console& console) {
  check_options(options);
  const Scene scene = scene_of(options);
  console.claim(plan_of(options, scene, global.force).files());
  require_memory_to_open(scene, &console);
  Value truth = Value::List();
  const auto keep = [&] {
    if (!options.truth.empty()) replace_text_file(options.truth, json_text(truth, 2) + "\n");
  };
  try {
    augment(options, scene, global, truth, console);
  } catch (const Cancelled&) {
    if (!truth.items().empty()) keep();
    throw;
  }
  keep();
  console.tell_repeats();
  if (global.json) std::printf("%s\n", json_text(truth, 2).c_str());
  return kOk;
}

}  // namespace

Command add_augment(CLI::App& program) {
  CLI::App* app = add_subcommand(
      program, "augment",
      "Random deformations without folds, bones rigid: images, labels, warps and their truth",
      "  supple augment head.nhdr --material ct-head --count 20 --seed 7 -o aug_%02d.nii.gz\n"
      "  supple augment ct.nii.gz --material ct-head --motion joint --turn 8 --warps w_%03d.nrrd "
      "--truth t.json\n"
      "  supple augment mr.nii.gz --labels seg.nrrd -o a_%02d.nrrd --label-maps l_%02d.nrrd");
  auto options = std::make_shared<AugmentOptions>(*app);
  add_body_options(*app, options->body);
  ReadOptions read;
  SceneOptions& scene = options->scene;
  scene.add("volume", fields(read));
  scene.add("labels", {});
  scene.add("material", {});
  scene.add("step", {});
  app->add_option("-o,--output", options->images, "Deformed volumes, with %03d for the number")
      ->option_text("VOLUME");
  add_field_options(*app, fields(*options));
  return {app, [options](const GlobalOptions& global, Console& console) {
            return run_augment(*options, global, console);
          }};
}

}  // namespace supple::tools
