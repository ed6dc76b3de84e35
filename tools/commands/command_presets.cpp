// supple presets: the transfer functions that come with the program, to look at and to edit.
#include <cstdio>

#include "tools/console/command.h"
#include "tools/scene/transfer_file.h"

namespace supple::tools {

Command add_presets(CLI::App& program) {
  auto name = std::make_shared<std::string>();
  CLI::App* app = add_subcommand(program, "presets",
                                 "List the transfer functions, or print one as TOML for editing",
                                 "  supple presets\n"
                                 "  supple presets CT-Bone > my_bone.toml\n"
                                 "  supple render head.nhdr --preset my_bone.toml -o head.png");
  app->add_option("name", *name, "Which to print")->option_text("NAME");
  return {app, [name](const GlobalOptions&, Console&) {
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
