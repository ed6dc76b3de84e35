// A step as a table of keys, of a scene, a journal or a message (docs/scenes.md).
#pragma once

#include <optional>
#include <string>

#include "lib/session/step.h"
#include "volumes/base/table.h"
#include "volumes/io/load/label_file.h"

namespace supple {

/// Keys of a [[step]] that choose among members of a Step.
struct StepKeys {
  int model = 0;                          // in step_models()
  std::optional<NumberPair> fix_density;  // an anchor
};
/// Keys of a [[step]], but for its lists and tables: handles, fix, cut, remove, rigid, relax, and
/// those of models.
Fields fields(Step& step, StepKeys& keys);

/// Reads the table of a model of step_models(), by its place there, unless it is ECM; without a
/// table its defaults. Throws InputError for the table of another model, and for relax or limits
/// beside one.
void read_model(Table& table, const LabelNames& names, int chosen, Step& step);

/// A table [material], or one of a step: a file or the keys of one. `path`: gets the file's.
MaterialTable read_material_choice(Table& table, const LabelNames& names,
                                   std::string* path = nullptr);

/// Reads an entry of [[step]]. Throws InputError: unknown key (line and suggestion), wrong type or
/// value, missing key, a step that does nothing.
Step read_step(Table& table, const LabelNames& names);

}  // namespace supple
