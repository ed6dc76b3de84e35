// supple slicer-module: commands as command-line modules of 3D Slicer.
#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "tools/console/command.h"
#include "tools/console/help.h"
#include "tools/console/slicer_module.h"
#include "volumes/base/process.h"

namespace supple::tools {

namespace {

struct SlicerOptions {
  std::string name;
  bool xml = false;
};

int run_module(const SlicerOptions& options, const CLI::App& program, const GlobalOptions& global) {
  const SlicerModule& module = slicer_module(options.name);
  const CLI::App& app = *find_command(program, module.command);
  if (options.xml) {
    std::fputs(slicer_xml(module, app).c_str(), stdout);
    return kOk;
  }
  const auto name = std::find(global.arguments.begin(), global.arguments.end(), options.name);
  std::vector<std::string> words = {"supple", module.command, "--force"};
  const std::vector<std::string> given(name + 1, global.arguments.end());
  for (const std::string& word : slicer_arguments(module, app, given)) words.push_back(word);
  ::setenv("SUPPLE_PROGRESS", "slicer", 1);
  become_program(own_program(), words);
}

}  // namespace

Command add_slicer_module(CLI::App& program) {
  auto options = std::make_shared<SlicerOptions>();
  CLI::App* app = add_subcommand(
      program, "slicer-module", "Commands as command-line modules of 3D Slicer",
      "  supple slicer-module invert --xml\n"
      "  supple slicer-module invert --field warp.h5 --output inverse.h5\n"
      "  supple slicer-module apply-points --deformation warp.h5 --points F.fcsv --output M.fcsv");
  app->add_option("name", options->name,
                  "deform, finite-elements, invert, apply-points, apply-mesh or apply-labels")
      ->required()
      ->option_text("NAME");
  app->add_flag("--xml", options->xml, "Print the description that Slicer makes a panel of");
  app->fallthrough(false)->prefix_command();  // the rest is read as the module's
  return {app, [options, &program](const GlobalOptions& global, Console&) {
            return run_module(*options, program, global);
          }};
}

}  // namespace supple::tools
