#include "tools/scene/pictures/decoration.h"

#include <algorithm>

#include "raycast/pictures/background.h"
#include "volumes/base/error.h"

namespace supple::tools {

bool Decoration::shows(const std::string& annotation) const {
  return std::any_of(annotate.begin(), annotate.end(),
                     [&](const std::string& name) { return name == annotation || name == "all"; });
}

Fields fields(Decoration& decoration) {
  return {
      Field("background", decoration.background, "transparent, checker, #RRGGBB or a name")
          .shown_as("COLOUR")
          .for_slices()
          .otherwise("black in slices"),
      Field("annotate", decoration.annotate,
            "Write letters, cube, scale, text, legend, crosshair or all")
          .one_of({"letters", "cube", "scale", "text", "legend", "crosshair", "all"})
          .shown_as("A,B,...")
          .for_slices(),
  };
}

void check_decoration(const Decoration& decoration, bool is_of_slices) {
  if (!decoration.background.empty()) parse_background(decoration.background);
  const std::string foreign = is_of_slices ? "cube" : "crosshair";
  const std::vector<std::string>& names = decoration.annotate;
  if (std::find(names.begin(), names.end(), foreign) == names.end()) return;
  throw InputError({"", "annotate",
                    foreign + (is_of_slices ? " of slices" : " of a picture in space"),
                    is_of_slices ? "letters, scale, text, legend or crosshair"
                                 : "letters, cube, scale, text or legend"});
}

}  // namespace supple::tools
