#include "tools/console/slicer_module.h"

#include <algorithm>
#include <cctype>
#include <sstream>

#include "tools/console/help.h"
#include "tools/scene/chart/template.h"
#include "volumes/base/error.h"
#include "volumes/base/text.h"
#include "volumes/base/version.h"

namespace supple::tools {

namespace {

/// Stands in an enumeration of Slicer, which always has a value, for none.
constexpr const char* kUnset = "default";

constexpr const char* kWarp = "type=\"nonlinear\" fileExtensions=\".h5,.nrrd,.nii.gz\"";
constexpr const char* kVolume = "type=\"scalar\" fileExtensions=\".nrrd,.nii.gz\"";
constexpr const char* kLabels = "type=\"label\" fileExtensions=\".nrrd,.nii.gz\"";
constexpr const char* kMesh = "fileExtensions=\".vtk,.ply,.stl,.obj\"";
constexpr const char* kPoints = "coordinateSystem=\"lps\" fileExtensions=\".fcsv\"";

/// A module of `apply`: the option of what follows is one of three.
SlicerModule apply_module(const std::string& option, const std::string& what,
                          const std::string& element, const char* attributes) {
  SlicerModule module = {"apply-" + option,
                         "apply",
                         "Apply a Deformation to " + what,
                         what + " follow a transform of displacements, forward or back.",
                         {{"deformation", "transform", kWarp, false, "Transform"},
                          {option, element, attributes, false, what},
                          {"output", element, attributes, true, "Moved " + what}},
                         {"raw", "frame", "channel", "spacing"},
                         {},
                         ""};
  if (option == "labels") {
    module.files.push_back({"grid", "image", kVolume, false, "Grid of the result"});
  } else {
    module.left_out.insert(module.left_out.end(), {"grid", "margin"});
  }
  for (const char* other : {"points", "mesh", "labels"}) {
    if (other != option) module.left_out.emplace_back(other);
  }
  return module;
}

/// A module of `deform`: points of one list go to those of another. `left_out`: more options.
SlicerModule deform_module(const std::string& name, const std::string& title,
                           const std::string& description, std::vector<std::string> left_out,
                           std::vector<std::string> fixed) {
  SlicerModule module = {
      name,
      "deform",
      title,
      description,
      {{"input", "image", kVolume, false, "Volume"},
       {"labels", "image", kLabels, false, "Labels of the material"},
       {"grab", "pointfile", kPoints, false, "Points that are dragged"},
       {"to", "pointfile", kPoints, false, "Where they go, in the same order"},
       {"fix", "pointfile", kPoints, false, "Points that stay"},
       {"output", "transform", kWarp, true, "Transform"},
       {"moved", "image", kVolume, true, "Deformed volume"}},
      {"cut", "remove", "rigid", "rigid-seed", "raw", "frame", "channel", "spacing", "by",
       "retract", "push", "release", "contact", "load", "elements", "refer", "dry-run"},
      std::move(fixed),
      "ct-head"};
  module.left_out.insert(module.left_out.end(), left_out.begin(), left_out.end());
  return module;
}

std::string tagged(const std::string& name, const std::string& text) {
  return "<" + name + ">" + html_text(text) + "</" + name + ">\n";
}

/// The name of an option or positional without its dashes.
std::string bare_name(const CLI::Option& option) {
  return option.get_lnames().empty() ? option.get_name() : option.get_lnames().front();
}

const SlicerFile* file_of(const SlicerModule& module, const std::string& name) {
  const auto found = std::find_if(module.files.begin(), module.files.end(),
                                  [&](const SlicerFile& file) { return file.option == name; });
  return found == module.files.end() ? nullptr : &*found;
}

/// The options of a module: those of its command, but for those of every command.
std::vector<const CLI::Option*> options_of_module(const SlicerModule& module, const CLI::App& app) {
  std::vector<const CLI::Option*> all;
  for (const CLI::Option* option : app.get_options()) {
    const std::string name = bare_name(*option);
    const bool is_shown = !option->get_group().empty() && option != app.get_help_ptr();
    const auto& out = module.left_out;
    if (is_shown && std::find(out.begin(), out.end(), name) == out.end()) all.push_back(option);
  }
  return all;
}

/// The name of an option as words: "Margin".
std::string label_of(const std::string& name) {
  std::string label = name;
  std::replace(label.begin(), label.end(), '-', ' ');
  label.front() = char(std::toupper(static_cast<unsigned char>(label.front())));
  return label;
}

std::string common_elements(const std::string& name, const std::string& label,
                            const CLI::Option& option) {
  std::string identifier = name;
  std::replace(identifier.begin(), identifier.end(), '-', '_');
  return tagged("name", identifier) + tagged("longflag", name) + tagged("label", label) +
         tagged("description", option.get_description());
}

std::string file_xml(const SlicerFile& file, const CLI::Option& option) {
  return "<" + file.element + " " + file.attributes + ">\n" +
         common_elements(file.option, file.label, option) +
         tagged("channel", file.is_output ? "output" : "input") + "</" + file.element + ">\n";
}

std::string parameter_xml(const SlicerModule& module, const CLI::Option& option) {
  const std::string name = bare_name(option), words = value_words(option);
  const std::string common = common_elements(name, label_of(name), option);
  if (option.get_items_expected_max() == 0) {
    return "<boolean>\n" + common + tagged("default", "false") + "</boolean>\n";
  }
  if (name == "material" && !module.material.empty()) {
    return "<string>\n" + common + tagged("default", module.material) + "</string>\n";
  }
  if (words.empty()) return "<string>\n" + common + "</string>\n";
  std::string elements = tagged("default", kUnset) + tagged("element", kUnset);
  std::istringstream each(words);
  for (std::string word; each >> word;) elements += tagged("element", word);
  return "<string-enumeration>\n" + common + elements + "</string-enumeration>\n";
}

}  // namespace

const std::vector<SlicerModule>& slicer_modules() {
  static const std::vector<SlicerModule> modules = {
      deform_module("deform", "Deform by Points",
                    "Tissue follows points that are dragged, within the limits of its material.",
                    {}, {}),
      deform_module(
          "finite-elements", "Deform by Finite Elements",
          "Elastic equilibrium of tissue of which points are dragged.",
          {"model", "limits", "no-relax", "relax", "relax-method", "relax-tolerance",
           "bulk-modulus", "relax-budget", "springs-minimise", "springs-time", "springs-step",
           "springs-integrator", "springs-mass-damping", "springs-tolerance", "springs-steps",
           "springs-gravity", "springs-structural", "springs-shear", "springs-bending"},
          {"--model", "fem"}),
      {"invert",
       "invert",
       "Invert a Deformation",
       "The inverse of a transform of displacements, with a certificate of how well it inverts.",
       {{"field", "transform", kWarp, false, "Transform"},
        {"output", "transform", kWarp, true, "Inverse"},
        {"grid", "image", kVolume, false, "Grid of the result"}},
       {"intent", "compress", "direction"},
       {},
       ""},
      apply_module("points", "Points", "pointfile", kPoints),
      apply_module("mesh", "Models", "geometry", kMesh),
      apply_module("labels", "Labels", "image", kLabels)};
  return modules;
}

const SlicerModule& slicer_module(const std::string& name) {
  std::string names;
  for (const SlicerModule& module : slicer_modules()) {
    if (module.name == name) return module;
    names += (names.empty() ? "" : ", ") + module.name;
  }
  throw UsageError(to_line({"", "slicer-module", "'" + name + "'", names}));
}

std::string slicer_xml(const SlicerModule& module, const CLI::App& app) {
  std::string files, others;
  for (const CLI::Option* option : options_of_module(module, app)) {
    const SlicerFile* file = file_of(module, bare_name(*option));
    (file != nullptr ? files : others) +=
        file != nullptr ? file_xml(*file, *option) : parameter_xml(module, *option);
  }
  std::string xml =
      "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<executable>\n" + tagged("category", "Supple") +
      tagged("title", module.title) + tagged("description", module.description) +
      tagged("version", kVersion) + tagged("documentation-url", "") +
      tagged("license", "Apache 2.0") + tagged("contributor", "Supple developers") +
      "<parameters>\n" + tagged("label", "Files") +
      tagged("description", "Nodes that are read and made") + files + "</parameters>\n";
  if (!others.empty()) {
    xml += "<parameters advanced=\"true\">\n" + tagged("label", "Settings") +
           tagged("description", "As `supple " + module.command + " --help` has them") + others +
           "</parameters>\n";
  }
  return xml + "</executable>\n";
}

std::vector<std::string> slicer_arguments(const SlicerModule& module, const CLI::App& app,
                                          const std::vector<std::string>& given) {
  std::vector<std::string> arguments = module.fixed, positionals;
  const std::vector<const CLI::Option*> options = options_of_module(module, app);
  for (std::size_t n = 0; n < given.size(); ++n) {
    const std::string name = given[n].rfind("--", 0) == 0 ? given[n].substr(2) : "";
    if (name == "returnparameterfile" || name == "processinformationaddress") {
      ++n;  // of modules with results that are numbers, and within Slicer's own process
      continue;
    }
    const auto found = std::find_if(options.begin(), options.end(), [&](const CLI::Option* option) {
      return bare_name(*option) == name;
    });
    if (found == options.end()) {
      throw UsageError(to_line({"", given[n], "no option of the module " + module.name,
                                "those that supple slicer-module " + module.name + " --xml has"}));
    }
    const bool is_flag = (*found)->get_items_expected_max() == 0;
    if (is_flag) {
      arguments.push_back(given[n]);
      continue;
    }
    if (++n == given.size()) throw UsageError(to_line({"", "--" + name, "no value", "one"}));
    if (given[n].empty() || (given[n] == kUnset && file_of(module, name) == nullptr)) continue;
    if ((*found)->get_positional()) {
      positionals.push_back(given[n]);
    } else {
      arguments.insert(arguments.end(), {"--" + name, given[n]});
    }
  }
  arguments.insert(arguments.end(), positionals.begin(), positionals.end());
  return arguments;
}

}  // namespace supple::tools
