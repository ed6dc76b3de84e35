// Options of commands that make a body of a volume or a state: its material and labels, what stays
// where it is, cuts, and pieces.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "tools/console/field_options.h"

namespace supple::tools {

struct BodyOptions {
  std::string input, material, labels;
  std::vector<std::string> fixes, cuts, removed, rigid, rigid_seeds;
};

void add_body_options(CLI::App& app, BodyOptions& options);

/// Sets the options as keys of the scene's volume, labels, material and step, whose tables it has.
/// Throws UsageError.
void set_body(const BodyOptions& options, SceneOptions& scene);

}  // namespace supple::tools
