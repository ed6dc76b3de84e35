// supple deform: drags voxels of a volume or state and writes the state.
#include <cstdio>

#include <nlohmann/json.hpp>

#include "lib/material/material_file.h"
#include "tools/console/command.h"
#include "tools/console/parse.h"
#include "tools/console/read_options.h"
#include "tools/outputs/output_plan.h"
#include "tools/outputs/outputs.h"
#include "tools/scene/run_step.h"

namespace supple::tools {

namespace {

struct DeformOptions {
  std::string input, material, labels, output;
  ReadOptions read;
  std::vector<std::string> grabs, bys, fixes, cuts;
  bool push = false, release = false;
  std::string limits = "box";
  std::optional<int> relax;
  std::optional<std::string> relax_method;
  std::optional<double> relax_tolerance;
  std::optional<double> relax_volume;
};

/// Every --grab takes the next --by, except files whose points have displacements of their own.
std::vector<GivenHandle> parse_handles(const DeformOptions& options) {
  std::vector<GivenHandle> handles;
  std::size_t bys = 0;
  for (const std::string& text : options.grabs) {
    GivenHandle handle;
    handle.push = options.push;
    handle.label = parse_label("--grab", text);
    if (is_point_file_name(text)) {
      handle.points = read_point_file(text);
    } else if (!handle.label) {
      handle.box = parse_box("--grab", text);
    }
    if (!handle.points || !handle.points->has_displacements) {
      if (bys < options.bys.size()) handle.by_mm = parse_vector("--by", options.bys[bys]);
      ++bys;
    }
    handles.push_back(std::move(handle));
  }
  if (bys != options.bys.size()) {
    throw UsageError(to_line({"", "--by", std::to_string(options.bys.size()) + " of them",
                              "one for each of " + std::to_string(bys) +
                                  " --grab, in order; files with dx,dy,dz take none"}));
  }
  if (options.push && handles.empty()) {
    throw UsageError(to_line({"", "--push", "no --grab", "a handle that pushes"}));
  }
  return handles;
}

std::vector<CutSurface> parse_cuts(const DeformOptions& options) {
  std::vector<CutSurface> cuts;
  for (const std::string& text : options.cuts) {
    const auto label = parse_label("--cut", text);
    cuts.push_back(label ? label_cut(*label, "--cut") : mesh_cut(text));
  }
  return cuts;
}

std::optional<RelaxParams> parse_relax(const DeformOptions& options) {
  if (!options.relax) {
    const char* alone = options.relax_method      ? "--relax-method"
                        : options.relax_tolerance ? "--relax-tolerance"
                        : options.relax_volume    ? "--relax-volume"
                                                  : nullptr;
    if (alone == nullptr) return std::nullopt;
    throw UsageError(to_line({"", alone, "no --relax", "--relax with the most passes"}));
  }
  RelaxParams params;
  params.passes = *options.relax;
  if (options.relax_method) params.method = *relax_method(*options.relax_method);
  if (options.relax_tolerance) params.tolerance_voxels = *options.relax_tolerance;
  if (options.relax_volume) params.bulk_modulus_kpa = *options.relax_volume;
  if (params.bulk_modulus_kpa > 0 && !conserves_volume(params.method)) {
    throw UsageError(
        to_line({"", "--relax-volume", std::string("--relax-method ") + name_of(params.method),
                 "red-black or accelerated"}));
  }
  return params;
}

/// The options as the one step of a scene.
SceneStep parse_step(const DeformOptions& options) {
  SceneStep step;
  step.handles = parse_handles(options);
  for (const std::string& text : options.fixes) {
    if (const auto label = parse_label("--fix", text)) {
      step.fix_labels.push_back(*label);
    } else if (is_point_file_name(text)) {
      step.fix_points.push_back(read_point_file(text));
    } else {
      step.fix.push_back(parse_box("--fix", text));
    }
  }
  step.cuts = parse_cuts(options);
  step.release = options.release;
  step.limits = *limits_of_name(options.limits);
  step.relax = parse_relax(options);
  if (step.does_nothing()) {
    throw UsageError(
        "deform: found neither --grab nor --fix nor --cut nor --release nor --relax nor --limits "
        "tighten, expected something to do");
  }
  return step;
}

void print_solve(const StepRecord& record) {
  const EcmReport& report = record.report;
  std::printf("moved           %lld, by the %s engine in %.3g ms\n",
              static_cast<long long>(report.moved), record.ball ? "ball" : name_of(report.engine),
              report.milliseconds);
  if (record.ball) {
    std::printf("links violated  %lld of %lld, by at most %.3g voxels, after %lld moves\n",
                static_cast<long long>(record.ball->violated),
                static_cast<long long>(record.ball->links), record.ball->worst_excess_voxels,
                static_cast<long long>(record.ball->moves));
    return;
  }
  std::printf("drag performed  %.6g (%lld/%lld)\n", report.fraction(),
              static_cast<long long>(report.fraction_numerator),
              static_cast<long long>(report.fraction_denominator));
}

void print_relaxation(const StepRecord& record) {
  const RelaxReport& report = record.relaxed;
  std::printf("relaxed         %d passes (%s%s), energy %.6g to %.6g uJ, last step %.2g voxels\n",
              report.passes, name_of(record.relax->method), report.converged ? ", converged" : "",
              report.energy_before, report.energy_after, report.largest_step_voxels);
  if (report.volumes_after) {
    std::printf("volume          %.4f to %.4f of %lld cells at rest, a cell %.3g to %.3g\n",
                report.volumes_before->ratio(), report.volumes_after->ratio(),
                static_cast<long long>(report.volumes_after->cells), report.volumes_after->smallest,
                report.volumes_after->largest);
  }
  if (report.yielded_links > 0) {
    std::printf("plastic flow    %lld links\n", static_cast<long long>(report.yielded_links));
  }
}

void print_tightening(const TightenReport& report) {
  std::printf("tightened       %lld links, %lld violated by at most %.3g voxels, %d iterations%s\n",
              static_cast<long long>(report.links), static_cast<long long>(report.violated),
              report.worst_excess_voxels, report.iterations, report.settled ? ", settled" : "");
}

void print_deform(const Session& session, const DeformOptions& options,
                  const InversionCertificate& certificate) {
  std::printf("elements        %lld\n",
              static_cast<long long>(session.body().elements.active_count()));
  if (!options.cuts.empty()) {
    std::printf("cut links       %lld\n",
                static_cast<long long>(session.records().back().cut_links));
  }
  if (!options.grabs.empty()) print_solve(session.records().back());
  if (options.relax) print_relaxation(session.records().back());
  if (session.records().back().tightened) print_tightening(*session.records().back().tightened);
  print_reactions(session.records().back().reactions);
  std::printf("folded cells    %lld of material%s, %lld in the air around it\n",
              static_cast<long long>(certificate.folded_cells - certificate.folded_air_cells),
              session.links().fold_free ? " (its limits exclude folds)" : "",
              static_cast<long long>(certificate.folded_air_cells));
  std::printf("inversion       residual max %.2g, p99.9 %.2g voxels, unresolved %lld\n",
              certificate.residual_max, certificate.residual_p999,
              static_cast<long long>(certificate.unresolved_voxels));
  std::printf("state           %s\n", options.output.c_str());
}

void print_json(const Session& session, const DeformOptions& options,
                const InversionCertificate& certificate) {
  nlohmann::ordered_json json = to_json(session.records().back());
  json["elements"] = session.body().elements.active_count();
  json["fold_free_material"] = session.links().fold_free;
  json["folded"] = certificate.folded_cells - certificate.folded_air_cells;
  json["certificate"] = to_json(certificate);
  json["state"] = options.output;
  std::printf("%s\n", json.dump(2).c_str());
}

int run_deform(const DeformOptions& options, const GlobalOptions& global, Console& console) {
  const SceneStep step = parse_step(options);
  OutputPlan plan(global);
  if (!is_state_file(options.input)) plan.protect(options.input);
  plan.add_state(options.output);
  if (!options.labels.empty()) plan.protect(options.labels);
  for (const CutSurface& cut : step.cuts) {
    if (cut.mesh) plan.protect(cut.place);
  }
  SessionOptions settings;
  settings.read = options.read;
  settings.labels_path = options.labels;
  if (!options.material.empty()) settings.material = read_material(options.material);

  Session session(options.input, settings, &console);
  run_step(session, step, true, &console);
  session.write_state(options.output, &console);

  const InversionCertificate& certificate = session.pose().offsets.certificate;
  if (global.json) {
    print_json(session, options, certificate);
  } else if (!global.quiet) {
    print_deform(session, options, certificate);
  }
  return kOk;
}

}  // namespace

Command add_deform(CLI::App& program) {
  auto options = std::make_shared<DeformOptions>();
  CLI::App* app = add_subcommand(
      program, "deform", "Drag parts of a volume or state; the body follows (Enhanced ChainMail)",
      "  supple deform head.nhdr --material ct.toml --grab 128,211,12 --by 0,12,0 -o drag.vdb\n"
      "  supple deform drag.vdb --grab 128,211,12 --by 0,0,-5 --fix 20,20,60:235,150,107 "
      "-o more.vdb\n"
      "  supple deform head.nhdr --grab 90,200,8:160,210,14 --by 0,-8,0 --push --fix pins.csv "
      "-o push.vdb");
  app->add_option("input", options->input, "A volume file, or a state to continue")
      ->required()
      ->option_text("VOLUME|STATE.vdb");
  add_read_options(*app, options->read);
  app->add_option("--material", options->material, "Look-up table from density to link limits")
      ->option_text("M.toml");
  app->add_option("--labels", options->labels,
                  "Label volume on the same grid: for [label.N] of the material, and label:N below")
      ->option_text("FILE");
  app->add_option("--grab", options->grabs,
                  "Voxel, box, label or points (x,y,z in LPS mm) to drag as one; repeat for "
                  "several handles. Points with columns dx,dy,dz too move each by its own")
      ->allow_extra_args(false)
      ->option_text("I,J,K[:I,J,K]|FILE.csv|label:N");
  app->add_option(
         "--by", options->bys,
         "How far, in mm along the grid axes; one per --grab, in order, but none for a file "
         "with dx,dy,dz")
      ->allow_extra_args(false)
      ->option_text("DX,DY,DZ");
  app->add_option("--fix", options->fixes, "Voxel, box, label or points that stay where they are")
      ->allow_extra_args(false)
      ->option_text("I,J,K[:I,J,K]|FILE.csv|label:N");
  app->add_flag("--release", options->release, "Let go of what the state has fixed");
  app->add_option("--cut", options->cuts,
                  "Cut the body at rest along a surface in LPS mm (.stl, .ply, .obj) or around a "
                  "label; repeatable")
      ->allow_extra_args(false)
      ->option_text("MESH|label:N");
  app->add_flag("--push", options->push,
                "Handles only push: in every axis they move tissue ahead of them, not back");
  app->add_option("--limits", options->limits,
                  "box: each component of a link (default); ball: its length, order-dependent; "
                  "tighten: box, and narrower across stretched links")
      ->check(CLI::IsMember({"box", "ball", "tighten"}))
      ->option_text("box|ball|tighten");
  app->add_option("--relax", options->relax,
                  "Then relax the body elastically, by at most so many passes")
      ->check(CLI::Range(1, kMaxPasses))
      ->option_text("N");
  app->add_option("--relax-method", options->relax_method,
                  "plain (the thesis' pass, breaks limits), jacobi, red-black or accelerated "
                  "(default)")
      ->check(CLI::IsMember({"plain", "jacobi", "red-black", "accelerated"}))
      ->option_text("NAME");
  app->add_option("--relax-tolerance", options->relax_tolerance,
                  "End when a pass moves nothing further than this, in voxels")
      ->check(CLI::Range(0.0, 16383.0))
      ->option_text("T");
  app->add_option("--relax-volume", options->relax_volume,
                  "Bulk modulus in kPa with which relaxed tissue keeps its volume (0: it does not)")
      ->check(CLI::Range(0.0, kMaxBulkModulusKpa))
      ->option_text("KPA");
  app->add_option("-o,--output", options->output, "State file to write")
      ->required()
      ->option_text("STATE.vdb");
  return {app, [options](const GlobalOptions& global, Console& console) {
            return run_deform(*options, global, console);
          }};
}

}  // namespace supple::tools
