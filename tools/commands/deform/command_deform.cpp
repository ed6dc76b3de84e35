// supple deform: drags voxels of a volume or state and writes the state.
#include <cstdio>
#include <filesystem>
#include <map>
#include <optional>

#include "lib/session/file/step_keys.h"
#include "lib/session/spring_step.h"
#include "lib/session/step_model.h"
#include "tools/console/body_options.h"
#include "tools/console/command.h"
#include "tools/console/dry_run.h"
#include "tools/console/field_options.h"
#include "tools/console/parse.h"
#include "tools/console/result_lines.h"
#include "tools/scene/file/scene.h"
#include "tools/scene/plan/memory_need.h"
#include "tools/scene/plan/scene_plan.h"
#include "tools/scene/run/output_plan.h"
#include "tools/scene/run/reports.h"
#include "tools/scene/run/scene_run.h"
#include "volumes/base/json.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/point_file.h"

namespace supple::tools {

namespace {

struct DeformOptions {
  explicit DeformOptions(CLI::App& app) : scene(app) {}

  SceneOptions scene;
  BodyOptions body;
  std::string output, moved;
  std::vector<std::string> grabs, bys, targets, contacts, loads, retractions, elements;
  std::optional<double> radius_mm;
  bool push = false, no_contact = false, refer = false, dry_run = false;
};

/// Every --grab takes the next --by, except those that say how they move: tables with a motion, and
/// files whose points have displacements, or the next --to.
Value handle_tables(const DeformOptions& options) {
  Value tables = Value::List();
  std::size_t bys = 0, targets = 0, files = 0;
  for (const std::string& text : options.grabs) {
    GrabText grab = parse_grab("--grab", text);
    Value& table = tables.push_back(grab.keys);
    if (!grab.moves_itself && table.contains("points") && targets < options.targets.size()) {
      table["to"] = options.targets[targets++];
      grab.moves_itself = true;
    }
    const bool is_file = is_point_file_name(text);
    if (options.radius_mm && is_file) table["radius"] = *options.radius_mm;
    files += is_file;
    if (!grab.moves_itself && bys < options.bys.size()) {
      table["by"] = numbers_value("--by", options.bys[bys]);
    }
    bys += !grab.moves_itself;
    if (options.push) table["push"] = true;
  }
  if (bys != options.bys.size()) {
    throw UsageError(to_line({"", "--by", std::to_string(options.bys.size()) + " of them",
                              "one for each of " + std::to_string(bys) +
                                  " --grab, in order; files with dx,dy,dz and tables with a motion "
                                  "take none"}));
  }
  if (targets != options.targets.size()) {
    throw UsageError(to_line({"", "--to", std::to_string(options.targets.size()) + " of them",
                              "one for each --grab FILE without displacements, in order"}));
  }
  if (options.radius_mm && files == 0) {
    throw UsageError(to_line({"", "--radius", "no --grab FILE", "a file of points, or ball:"}));
  }
  if (options.push && options.grabs.empty()) {
    throw UsageError(to_line({"", "--push", "no --grab", "a handle that pushes"}));
  }
  return tables;
}

/// The list of fem to which a load belongs, by the key that says how large it is.
const char* list_of_load(const Value& load, const std::string& text) {
  const bool is_force = load.contains("force_n"), is_pressure = load.contains("pressure_kpa");
  if (is_force != is_pressure) return is_force ? "forces" : "pressures";
  refuse_option("--load", text, "one of force_n and pressure_kpa");
}

void set_loads(const std::vector<std::string>& loads, SceneOptions& given) {
  std::map<std::string, Value> lists;
  for (const std::string& text : loads) {
    const Value load = table_value("--load", text);
    lists[list_of_load(load, text)].push_back(load);
  }
  for (const auto& [list, tables] : lists) given.set("step.fem", list, tables, "--load");
}

/// QUANTITY=FILE of each.
Value element_table(const std::vector<std::string>& texts) {
  Value entries = Value::Entries();
  for (const std::string& text : texts) {
    NamedFile named = named_file("--elements", text);
    entries[named.name] = std::move(named.file);
  }
  return entries;
}

/// True for names of states; others are those of warps.
bool is_state_name(const std::string& name) {
  const std::string extension = std::filesystem::path(name).extension();
  return !name.empty() && (extension.empty() || extension == ".vdb");
}

/// The options as a scene of one step.
Scene to_scene(DeformOptions& options) {
  SceneOptions& given = options.scene;
  set_body(options.body, given);
  if (options.no_contact) given.set("material", "contact", false, "--no-contact");
  const Value handles = handle_tables(options);
  if (!options.grabs.empty()) given.set("step", "handles", handles, "--grab");
  const auto set_tables = [&](const char* table, const char* key, const char* option,
                              const std::vector<std::string>& texts) {
    Value tables;
    for (const std::string& text : texts) tables.push_back(table_value(option, text));
    if (!texts.empty()) given.set(table, key, tables, option);
  };
  set_tables("step", "retract", "--retract", options.retractions);
  set_tables("step.springs", "contact", "--contact", options.contacts);
  set_loads(options.loads, given);
  if (is_state_name(options.output)) {
    given.set("output", "state", options.output, "--output");
  } else if (!options.output.empty()) {
    given.set("output", "offsets", Value::List{options.output}, "--output");
  }
  if (!options.moved.empty()) {
    given.set("output", "volumes", Value::List{options.moved}, "--moved");
  }
  if (options.refer) given.set("output", "refer", true, "--refer");
  if (!options.elements.empty()) {
    given.set("output", "elements", element_table(options.elements), "--elements");
  }
  given.call("step[1]", "deform");
  given.call("step[1].relax", "--relax");
  if (!given.has("step") && !given.has("step.relax") && !given.has("step.springs")) {
    throw UsageError(
        "deform: found neither --grab nor --fix nor --cut nor --remove nor --rigid nor --release "
        "nor "
        "--relax nor --model nor --limits tighten, expected something to do");
  }
  return read_scene(given.scene());
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
  std::printf("drag performed  %.4g (%lld/%lld)\n", report.fraction(),
              static_cast<long long>(report.fraction_numerator),
              static_cast<long long>(report.fraction_denominator));
}

void print_relaxation(const StepRecord& record) {
  const RelaxReport& report = record.relaxed;
  std::printf("relaxed         %d passes (%s%s), energy %.4g to %.4g uJ, last step %.2g voxels\n",
              report.passes, name_of(record.relax->method),
              report.end == RelaxEnd::passes   ? ""
              : report.end == RelaxEnd::budget ? ", ended by its budget, not at rest"
                                               : (std::string(", ") + name_of(report.end)).c_str(),
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

void print_springs(const SpringRecord& record) {
  std::printf("springs         %d steps of %zu springs, energy %.4g to %.4g J\n", record.steps,
              record.springs, record.before.total_j(), record.after.total_j());
  std::printf("links violated  %lld of %lld, by at most %.3g voxels\n",
              static_cast<long long>(record.links.violated),
              static_cast<long long>(record.links.links), record.links.worst_excess_voxels);
}

void print_fem(const FemRecord& record) {
  const FemReport& report = record.report;
  std::printf("finite elements %lld unknowns, %d iterations, residual max %.2g, rms %.2g\n",
              static_cast<long long>(report.unknowns), report.iterations, report.residual_max,
              report.residual_rms);
  if (report.responses && report.responses->used > 0) {
    std::printf("responses       a sum of %d, %d of them found for it\n", report.responses->used,
                report.responses->solved);
  }
  if (report.error_mm) {
    std::printf("error left      %.2g mm of displacements, estimated\n", *report.error_mm);
  }
  if (report.newton) {
    const NewtonReport& newton = *report.newton;
    std::printf("finite strain   %d load steps and %d given up, %d corrections, det F from %.3g\n",
                newton.load_steps, newton.rejected_steps, newton.newton_iterations,
                newton.smallest_j);
  }
  std::printf("balance         forces %.2g, energy %.2g, reactions changed by %.2g\n",
              report.force_balance, report.energy_identity, report.reaction_change);
  std::printf("largest         turn %.3g degrees, strain %.3g; memory %zu MiB\n",
              report.largest_rotation_deg, report.largest_strain, report.bytes >> 20);
}

void print_deform(const Session& session, const Step& step,
                  const InversionCertificate& certificate) {
  const StepRecord& record = session.records().back();
  print_places(session.places(record));
  std::printf("elements        %lld\n",
              static_cast<long long>(session.body().elements.active_count()));
  if (!session.body().rigid.empty()) {
    std::printf("rigid pieces    %zu\n", session.body().rigid.list.size());
  }
  if (!step.remove.empty()) {
    std::printf("removed         %lld elements\n", static_cast<long long>(record.removed));
  }
  if (!step.cuts.empty() || record.cut_links > 0) {
    std::printf("cut links       %lld\n", static_cast<long long>(record.cut_links));
  }
  if (record.springs) {
    print_springs(record.sprung);
  } else if (record.fem) {
    print_fem(record.equilibrium);
  } else if (!record.own_report.is_null()) {
    std::printf("%-15s %s\n", model_of(record).title.c_str(), json_text(record.own_report).c_str());
  } else if (!step.drags.empty()) {
    print_solve(record);
  }
  if (record.relax) print_relaxation(record);
  if (record.tightened) print_tightening(*record.tightened);
  print_reactions(record.reactions);
  std::printf("folded cells    %lld of material%s, %lld in the air around it\n",
              static_cast<long long>(certificate.folded_cells - certificate.folded_air_cells),
              session.links().fold_free ? " (its limits exclude folds)" : "",
              static_cast<long long>(certificate.folded_air_cells));
  std::printf("inversion       residual max %.2g, p99.9 %.2g voxels, unresolved %lld\n",
              certificate.residual_max, certificate.residual_p999,
              static_cast<long long>(certificate.unresolved_voxels));
}

void print_json(const Session& session, const SceneOutput& output,
                const InversionCertificate& certificate) {
  Value json = to_value(session.records().back());
  json["handles"] = to_value(session.places(session.records().back()));
  if (!session.body().rigid.empty()) json["rigid_pieces"] = to_value(session.body().rigid);
  json["elements"] = session.body().elements.active_count();
  json["fold_free_material"] = session.links().fold_free;
  json["folded"] = certificate.folded_cells - certificate.folded_air_cells;
  json["certificate"] = to_value(certificate);
  if (!output.state.empty()) json["state"] = output.state;
  for (const std::string& name : output.offsets) json["offsets"] = name;
  for (const std::string& name : output.volumes) json["moved"] = name;
  std::printf("%s\n", json_text(json, 2).c_str());
}

int run_deform(DeformOptions& options, const GlobalOptions& global, Console& console) {
  if (options.output.empty() && options.moved.empty()) {
    if (!options.dry_run) throw UsageError("--output is required (see supple deform --help)");
    options.output = "state.vdb";
  }
  const Scene scene = to_scene(options);
  const OutputPlan plan = check_scene(scene, "", global.force || options.dry_run);
  if (options.dry_run) return tell_plan(scene, "", global, console);
  console.claim(plan.files());
  require_memory_to_run(scene, &console);
  SceneRun run(scene, "", true, console);
  require_memory(scene, run);
  run.run();
  if (global.json) {
    print_json(*run.session(), scene.output, *run.certificate());
  } else if (!global.quiet) {
    print_deform(*run.session(), scene.steps.front(), *run.certificate());
  }
  return kOk;
}

}  // namespace

Command add_deform(CLI::App& program) {
  CLI::App* app = add_subcommand(
      program, "deform", "Drag parts of a volume or state; the body follows (Enhanced ChainMail)",
      "  supple deform head.nhdr --material ct.toml --grab 128,211,12 --by 0,12,0 -o drag.vdb\n"
      "  supple deform drag.vdb --grab 128,211,12 --by 0,0,-5 --fix 20,20,60:235,150,107 "
      "-o more.vdb\n"
      "  supple deform ct.nrrd --material ct-head --grab F.mrk.json --to T.mrk.json -o warp.h5");
  auto options = std::make_shared<DeformOptions>(*app);
  add_body_options(*app, options->body);
  ReadOptions read;
  Step step;
  StepKeys keys;
  RelaxParams relax;
  SceneOptions& scene = options->scene;
  scene.add("volume", fields(read));
  scene.add("labels", {});
  scene.add("material", {});
  app->add_option("--grab", options->grabs,
                  "Voxel, box, ball (mm), densities, connected piece, label or points to drag as "
                  "one; PLACE is I,J,K or lps:X,Y,Z or ras:X,Y,Z in mm; TABLE as a scene's "
                  "handles; repeatable")
      ->allow_extra_args(false)
      ->option_text("I,J,K[:I,J,K]|ball:PLACE:R|density:LO:HI|piece:PLACE|label:N|FILE.csv|TABLE");
  app->add_option("--by", options->bys,
                  "In mm along the grid axes, lps: or ras:; one per --grab that has none")
      ->allow_extra_args(false)
      ->option_text("DX,DY,DZ");
  app->add_option("--to", options->targets, "Where the points of a --grab FILE go, pair by pair")
      ->allow_extra_args(false)
      ->option_text("FILE");
  app->add_option("--radius", options->radius_mm, "Of a ball around each point that goes its way")
      ->option_text("MM");
  app->add_option("--retract", options->retractions, "Push lips of a cut apart, as in scenes")
      ->allow_extra_args(false)
      ->option_text("TABLE");
  app->add_flag("--push", options->push,
                "Handles only push: they move tissue ahead of them, not back");
  scene.add("step", fields(step, keys));
  scene.add("step.relax", fields(relax), "relax-");
  for (const StepModel& model : step_models()) {
    if (!model.option_fields) continue;
    model.choose(step);
    scene.add("step." + model.name, model.option_fields(step), model.options);
  }
  scene.add("output", {});
  app->add_option("--contact", options->contacts,
                  "A shape that springs meet, as contacts of scenes; repeatable")
      ->allow_extra_args(false)
      ->option_text("TABLE");
  app->add_option("--load", options->loads,
                  "Force or pressure of finite elements, as in scenes; repeatable")
      ->allow_extra_args(false)
      ->option_text("TABLE");
  app->add_option("--elements", options->elements,
                  "Stress or strain as a volume, such as von_mises; repeatable")
      ->allow_extra_args(false)
      ->option_text("QUANTITY=FILE");
  app->add_flag("--no-contact", options->no_contact,
                "Bones and the sides of cuts pass through each other");
  app->add_flag("--refer", options->refer,
                "The state refers to its volume and holds only what moved");
  app->add_flag("--dry-run", options->dry_run,
                "Print what would be held and computed, and why; write nothing");
  app->add_option("--moved", options->moved, "Also write the volume, deformed and resampled")
      ->option_text("VOLUME");
  app->add_option("-o,--output", options->output,
                  "State, or offsets for ITK, Slicer, ANTs; not for --dry-run")
      ->option_text("STATE.vdb|WARP");
  return {app, [options](const GlobalOptions& global, Console& console) {
            return run_deform(*options, global, console);
          }};
}

}  // namespace supple::tools
