// Commands as command-line modules of 3D Slicer: their descriptions by the schema of its execution
// model, made of the options that commands declare, and their arguments as Slicer gives them.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace supple::tools {

/// An option that Slicer fills with a node of its scene.
struct SlicerFile {
  std::string option;      // name of the option or positional
  std::string element;     // image, transform, geometry or pointfile
  std::string attributes;  // of the element
  bool is_output = false;
  std::string label;
};

struct SlicerModule {
  std::string name, command, title, description;
  std::vector<SlicerFile> files;      // all others are parameters
  std::vector<std::string> left_out;  // options that Slicer has no use for
  std::vector<std::string> fixed;     // arguments that the command always has
  std::string material;               // preset that the panel begins with
};

/// The modules that there are.
const std::vector<SlicerModule>& slicer_modules();
/// Throws UsageError for another name.
const SlicerModule& slicer_module(const std::string& name);

/// The description of a module, as its --xml prints it. `app`: its command.
std::string slicer_xml(const SlicerModule& module, const CLI::App& app);

/// The arguments of the command for those of Slicer. Values that are empty, or say that the default
/// is meant, are left out. Throws UsageError for an option that the module does not have.
std::vector<std::string> slicer_arguments(const SlicerModule& module, const CLI::App& app,
                                          const std::vector<std::string>& given);

}  // namespace supple::tools
