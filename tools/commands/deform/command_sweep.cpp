// supple sweep: a scene run once for each of many values, and a table of the results.
#include <cstdio>
#include <filesystem>

#include "tools/console/command.h"
#include "tools/scene/run/output_plan.h"
#include "tools/scene/sweep/report_names.h"
#include "tools/scene/sweep/sweep.h"
#include "tools/scene/sweep/sweep_chart.h"
#include "tools/scene/sweep/sweep_table.h"
#include "volumes/base/files.h"
#include "volumes/base/json.h"
#include "volumes/base/toml.h"

namespace supple::tools {

namespace {

struct SweepOptions {
  std::string scene, output, pictures, cases;
  std::vector<std::string> vary, collect;
  bool lists = false, dry_run = false, anew = false;
  std::string plot, log;
  ChartChoice axes;

  std::string journal() const { return output + ".cases"; }
};

/// The files of a sweep; all is checked that can be before anything is computed.
std::vector<std::string> outputs_of(const SweepOptions& options, const Sweep& sweep,
                                    bool may_overwrite) {
  OutputPlan plan(may_overwrite, true);
  plan.protect(options.scene);
  if (!options.cases.empty()) plan.protect(options.cases);
  for (const std::string& input : sweep.inputs()) plan.protect(input);
  plan.add_table(options.output);
  if (!options.plot.empty()) plan.add_chart(options.plot);
  std::vector<std::string> files = plan.files();
  const bool goes_on = std::filesystem::exists(options.journal());
  for (const std::string& file : sweep.pictures(may_overwrite || goes_on)) files.push_back(file);
  return files;
}

std::vector<Collected> collected_by(const SweepOptions& options) {
  std::vector<Collected> wanted;
  for (const std::string& text : options.collect) wanted.push_back(parse_collected(text));
  return wanted;
}

/// Names of results that no case will have are told after the first one.
void check_names(const SweepOptions& options, const Sweep& sweep, const CaseEnd& end,
                 Console& console) {
  try {
    const SweepTable table = make_table(sweep.cases(), {end}, collected_by(options));
    if (!options.axes.y.empty()) column_of(table, options.axes.y, "--y");
    if (!options.axes.x.empty()) column_of(table, options.axes.x, "--x");
  } catch (const InputError& error) {
    console.warn(error.what());
  }
}

/// Notes how long the others may take, by the first case that was run, where that is long.
void tell_time(const CaseEnd& first, std::size_t others, Console& console) {
  constexpr double kLong = 10;
  const double case_s = first.report["total_s"].number();
  if (case_s * double(others) < kLong) return;
  console.note("took " + number_text(case_s, 2) + " s; at that, " +
               with_count(std::int64_t(others), "other case") + " will take " +
               number_text(case_s * double(others), 2) + " s");
}

std::vector<CaseEnd> run_all(const SweepOptions& options, Sweep& sweep, SweepJournal& journal,
                             Console& console) {
  std::vector<CaseEnd> ends;
  bool is_checked = false;
  bool tells_time = true;
  const std::size_t left = sweep.cases().size() - sweep.known_in(journal);
  for (std::size_t n = 0; n < sweep.cases().size(); ++n) {
    poll(&console);
    console.enter("case", int(n) + 1);
    ends.push_back(sweep.end_of(n, journal, console));
    if (!ends.back().error.empty()) {
      console.warn(sweep.cases().title(n) + ": " + ends.back().error);
    } else if (!is_checked) {
      is_checked = true;
      check_names(options, sweep, ends.back(), console);
    }
    if (ends.back().error.empty() && ends.back().was_run && tells_time) {
      tells_time = false;
      tell_time(ends.back(), left - 1, console);
    }
  }
  console.tell_repeats();
  return ends;
}

/// Notes how many cases are in the journal, if any.
void tell_known(const SweepOptions& options, const Sweep& sweep, const SweepJournal& journal,
                const std::string& more, Console& console) {
  const std::size_t known = sweep.known_in(journal);
  if (known == 0) return;
  const bool is_one = known == 1;
  console.note(std::to_string(known) + " of " +
               with_count(std::int64_t(sweep.cases().size()), "case") +
               (is_one ? " is in " : " are in ") + options.journal() + more);
}

/// Runs what is left; where that is interrupted, says how to go on.
std::vector<CaseEnd> ends_of(const SweepOptions& options, Sweep& sweep, Console& console) {
  SweepJournal journal(options.journal(), sweep.scene_digest(), options.anew);
  tell_known(options, sweep, journal, "", console);
  try {
    return run_all(options, sweep, journal, console);
  } catch (const Cancelled&) {
    console.tell_repeats();
    tell_known(options, sweep, journal, "; the same command goes on with the others", console);
    throw;
  }
}

void print_table(const SweepTable& table, const SweepOptions& options,
                 const GlobalOptions& global) {
  if (global.json) {
    const Value json = {{"table", options.output}, {"cases", to_value(table)}};
    std::printf("%s\n", json_text(json, 2).c_str());
  } else if (!global.quiet) {
    std::printf("%s", to_text(table, one_line).c_str());
  }
}

int run_cases(const SweepOptions& options, Sweep& sweep, const GlobalOptions& global,
              Console& console) {
  console.claim(outputs_of(options, sweep, global.force));
  const std::vector<CaseEnd> ends = ends_of(options, sweep, console);
  const SweepTable table = make_table(sweep.cases(), ends, collected_by(options));
  if (table.results.empty()) {
    console.warn("no result is in tables unless --collect names it; --list prints all names");
  }
  replace_text_file(options.output, to_csv(table));
  print_table(table, options, global);
  std::size_t failed = 0;
  for (const CaseEnd& end : ends) failed += end.error.empty() ? 0 : 1;
  if (failed > 0) {
    console.error(std::to_string(failed) + " of " + with_count(std::int64_t(ends.size()), "case") +
                  " failed: see the column error of " + options.output);
  }
  if (!options.plot.empty() && failed < ends.size()) {
    replace_text_file(options.plot, to_svg_file(chart_of(table, sweep.cases(), options.axes)));
  }
  return failed == 0 ? kOk : kFailure;
}

/// Prints what the report of the first case has, by the names that --collect takes.
int list_results(Sweep& sweep, const GlobalOptions& global, Console& console) {
  const CaseEnd end = sweep.run(0, console);
  if (end.thrown) std::rethrow_exception(end.thrown);
  std::set<std::string> main;
  for (const Collected& result : main_results({end})) main.insert(result.name);
  Value json;
  for (const auto& [name, value] : named_values(end.report)) {
    if (global.json) {
      json[name] = value;
    } else {
      std::printf("%s %-50s %s\n", main.count(name) != 0 ? "*" : " ", one_line(name).c_str(),
                  one_line(shown_text(value)).c_str());
    }
  }
  if (global.json) {
    std::printf("%s\n", json_text(json, 2).c_str());
  } else {
    std::printf("* in tables without --collect\n");
  }
  return kOk;
}

int tell_cases(const SweepOptions& options, const Sweep& sweep, const GlobalOptions& global,
               Console& console) {
  std::size_t left = sweep.cases().size();
  if (!options.output.empty()) {
    left -= sweep.known_in(SweepJournal(options.journal(), sweep.scene_digest(), options.anew));
  }
  const ScenePlan plan = sweep.plan(console);
  if (global.json) {
    Value json = {
        {"left_to_run", left}, {"first_case_s", plan.seconds}, {"first_case_mb", plan.peak_mb}};
    for (std::size_t n = 0; n < sweep.cases().size(); ++n) {
      json["cases"].push_back(sweep.cases().title(n));
    }
    std::printf("%s\n", json_text(json, 2).c_str());
    return kOk;
  }
  for (std::size_t n = 0; n < sweep.cases().size(); ++n) {
    std::printf("case %zu  %s\n", n + 1, one_line(sweep.cases().title(n)).c_str());
  }
  std::printf("%s, %zu to run; the first is planned to take %s s and %s MB\n",
              with_count(std::int64_t(sweep.cases().size()), "case").c_str(), left,
              number_text(plan.seconds, 3).c_str(), number_text(plan.peak_mb, 3).c_str());
  return kOk;
}

int run_sweep(const SweepOptions& options, const GlobalOptions& global, Console& console) {
  SweepCases cases;
  if (!options.cases.empty()) cases.add_file(options.cases);
  for (const std::string& text : options.vary) cases.vary(text);
  collected_by(options);  // refuses a text that is none
  if (!options.plot.empty() && options.axes.x.empty() && cases.size() < 2) {
    throw UsageError(to_line({"", "--plot", "one case", "--vary with several values, or --x"}));
  }
  if (options.output.empty() && !options.lists && !options.dry_run) {
    throw UsageError(to_line({"", "--output", "nothing", "-o TABLE.csv, --list or --dry-run"}));
  }
  Sweep sweep(options.scene, std::move(cases), options.lists ? "" : options.pictures, console);
  if (options.lists) return list_results(sweep, global, console);
  if (options.dry_run) return tell_cases(options, sweep, global, console);
  return run_cases(options, sweep, global, console);
}

void add_chart_options(CLI::App& app, const std::shared_ptr<SweepOptions>& options) {
  CLI::Option* plot =
      app.add_option("--plot", options->plot, "Also a diagram: a curve per value of other keys")
          ->option_text("FILE.svg");
  app.add_option("--x", options->axes.x, "Its horizontal axis (default: the first key)")
      ->needs(plot)
      ->option_text("COLUMN");
  app.add_option("--y", options->axes.y, "Its vertical axis (default: the first result)")
      ->needs(plot)
      ->option_text("COLUMN");
  app.add_option("--log", options->log, "Axes in decades: x, y or xy")
      ->needs(plot)
      ->check(CLI::IsMember({"x", "y", "xy"}))
      ->option_text("AXES");
}

}  // namespace

Command add_sweep(CLI::App& program) {
  auto options = std::make_shared<SweepOptions>();
  CLI::App* app = add_subcommand(
      program, "sweep", "Run a scene for many values, and make a table of the results",
      "  supple sweep bend.toml --vary material.poisson=0.3,0.4,0.45 -o bend.csv\n"
      "  supple sweep bend.toml --vary material.poisson=0.3,0.45 --list\n"
      "  supple sweep head.toml --vary step.fem.swellings.pressure_kpa=1,2,4 -o p.csv --plot "
      "p.svg");
  app->add_option("scene", options->scene, "A scene file")->required()->option_text("SCENE.toml");
  app->add_option(
         "--vary", options->vary,
         "A key of the scene, such as step[2].fem.coarsen, and its values: numbers, words, "
         "lists or tables; repeat for all combinations, the last changes fastest")
      ->allow_extra_args(false)
      ->option_text("KEY=A,B,C");
  app->add_option("--cases", options->cases,
                  "Values that go together: keys in the first line, a line per case")
      ->option_text("FILE.csv");
  app->add_option("--collect", options->collect,
                  "A result, by its name in --list; repeat (default: forces, volumes, pressures, "
                  "least det F)")
      ->allow_extra_args(false)
      ->option_text("[NAME=]RESULT");
  app->add_option("-o,--output", options->output,
                  "Table to write, a row per case; finished cases are kept in TABLE.csv.cases, "
                  "with which the same command goes on")
      ->option_text("TABLE.csv");
  app->add_option("--pictures", options->pictures,
                  "Also draw the scene's views, each with its values in its name")
      ->option_text("DIR");
  add_chart_options(*app, options);
  app->add_flag("--anew", options->anew, "Run all cases again, whatever is in TABLE.csv.cases");
  CLI::Option* lists =
      app->add_flag("--list", options->lists, "Run the first case and print the names of results");
  app->add_flag("--dry-run", options->dry_run, "Check all cases and plan the first")
      ->excludes(lists);
  return {app, [options](const GlobalOptions& global, Console& console) {
            options->axes.x_is_log = options->log.find('x') != std::string::npos;
            options->axes.y_is_log = options->log.find('y') != std::string::npos;
            return run_sweep(*options, global, console);
          }};
}

}  // namespace supple::tools
