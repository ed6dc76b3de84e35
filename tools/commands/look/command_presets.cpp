// supple presets: the transfer functions and materials that come with the program, to look at and
// to edit.
#include <cstdio>

#include "lib/material/presets.h"
#include "raycast/scene/transfer_file.h"
#include "tools/console/command.h"
#include "tools/console/parse.h"

namespace supple::tools {

Command add_presets(CLI::App& program) {
  auto name = std::make_shared<std::string>();
  auto materials = std::make_shared<bool>(false);
  CLI::App* app = add_subcommand(
      program, "presets", "List transfer functions or materials, or print one as TOML for editing",
      "  supple presets\n"
      "  supple presets ct-head > my_head.toml\n"
      "  supple presets Bone > my_bone.toml");
  app->add_option("name", *name, "Which to print")->option_text("NAME");
  app->add_flag("--materials", *materials, "List the materials of whole pictures instead");
  return {app, [name, materials](const GlobalOptions&, Console&) {
            if (const TissuePreset* tissue = find_tissue_preset(*name)) {
              std::fputs(tissue->table, stdout);
              return int(kOk);
            }
            if (*materials && name->empty()) {
              for (const TissuePreset& known : tissue_presets()) std::printf("%s\n", known.name);
              return int(kOk);
            }
            if (!name->empty()) {
              require_preset("name", *name);
              std::fputs(to_toml(preset(*name)).c_str(), stdout);
              return int(kOk);
            }
            for (const std::string& known : preset_names()) std::printf("%s\n", known.c_str());
            return int(kOk);
          }};
}

}  // namespace supple::tools
