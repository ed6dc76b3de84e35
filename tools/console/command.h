// Parts of a subcommand, and helpers that several subcommands share.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "tools/console/console.h"

namespace supple::tools {

/// Documented exit codes (docs/errors.md, design.md section 8).
enum ExitCode : int { kOk = 0, kFailure = 1, kUsage = 2, kBadInput = 3, kSystem = 4 };

/// Runs with the options that its registration bound; returns an exit code.
using Action = std::function<int(const GlobalOptions&, Console&)>;

struct Command {
  CLI::App* app;
  Action run;
};

Command add_help(CLI::App& program);
Command add_info(CLI::App& program);
Command add_compose(CLI::App& program);
Command add_fit(CLI::App& program);
Command add_straighten(CLI::App& program);
Command add_convert(CLI::App& program);
Command add_crop(CLI::App& program);
Command add_deform(CLI::App& program);
Command add_export(CLI::App& program);
Command add_invert(CLI::App& program);
Command add_keys(CLI::App& program);
Command add_mesh(CLI::App& program);
Command add_metrics(CLI::App& program);
Command add_modes(CLI::App& program);
Command add_resample(CLI::App& program);
Command add_apply(CLI::App& program);
Command add_augment(CLI::App& program);
Command add_presets(CLI::App& program);
Command add_probe(CLI::App& program);
Command add_render(CLI::App& program);
Command add_replay(CLI::App& program);
Command add_run(CLI::App& program);
Command add_slice(CLI::App& program);
Command add_smooth(CLI::App& program);
Command add_threshold(CLI::App& program);
Command add_compare(CLI::App& program);
Command add_stress(CLI::App& program);
Command add_tradeoff(CLI::App& program);
Command add_slicer_module(CLI::App& program);
Command add_sweep(CLI::App& program);
Command add_cohort(CLI::App& program);
Command add_view(CLI::App& program);
Command add_bench(CLI::App& program);

/// A subcommand with its examples, one per line, below the options.
CLI::App* add_subcommand(CLI::App& program, const std::string& name, const std::string& description,
                         const std::string& examples);

}  // namespace supple::tools
