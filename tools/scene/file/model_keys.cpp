#include "tools/scene/file/model_keys.h"

#include "tools/scene/file/fem_keys.h"
#include "tools/scene/file/spring_keys.h"

namespace supple::tools {

namespace {

/// The table of a model; `read` of one that is left out gives the defaults.
template <class Settings, class Read>
std::optional<Settings> read_own_keys(Table& table, const std::string& name, bool is_chosen,
                                      Read&& read) {
  auto own = table.table(name);
  if (!is_chosen) {
    if (own) {
      const std::vector<std::string> keys = own->keys();
      own->fail(keys.empty() ? "" : keys.front(), name + " without its model",
                "model = \"" + name + '"');
    }
    return std::nullopt;
  }
  for (const char* key : {"relax", "limits"}) {
    if (table.has(key)) {
      table.fail(key, std::string(key) + " beside " + name, "a step of its own for it");
    }
  }
  return own ? read(*own) : Settings();
}

}  // namespace

void read_model(Table& table, const LabelNames& names, StepModel model, Step& step) {
  step.springs =
      read_own_keys<SpringStep>(table, "springs", model == StepModel::springs, read_spring_step);
  step.fem = read_own_keys<FemStep>(table, "fem", model == StepModel::fem,
                                    [&](Table& fem) { return read_fem(fem, names); });
}

}  // namespace supple::tools
