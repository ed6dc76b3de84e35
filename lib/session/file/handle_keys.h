// Tables of handles and anchors in a scene (docs/scenes.md).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lib/session/handles/drag.h"
#include "volumes/base/error.h"
#include "volumes/base/table.h"
#include "volumes/io/load/label_file.h"

namespace supple {

/// Throws InputError where the last key of a list comes before the one ahead of it.
template <class Keys>
void require_later(const Table& table, const Keys& keys) {
  if (keys.size() < 2 || keys.back().time > keys[keys.size() - 2].time) return;
  table.fail("time", number_text(keys.back().time),
             "a time after that of the key before it, " + number_text(keys[keys.size() - 2].time));
}

/// Corners in any order, "[i, j, k]" or "[i0, j0, k0, i1, j1, k1]".
IndexBox to_box(Table& table, const std::string& key, const std::vector<double>& row);

/// Reads labels by number or by name.
std::optional<std::int32_t> read_label(Table& table, const std::string& key,
                                       const LabelNames& names);
std::vector<std::int32_t> read_labels(Table& table, const std::string& key,
                                      const LabelNames& names);

/// True if the table has a key of a handle: the short form of a step.
bool has_handle(Table& table);
/// Throws InputError unless it grabs one thing and says how that moves.
Drag read_handle(Table& table, const LabelNames& names);
/// Reads the keys of a selection, as of handles.
PlacedSelection read_anchor(Table& table, const LabelNames& names);
/// Reads those keys with labels, and a name of its own.
ChosenPart read_part(Table& table, const LabelNames& names);

}  // namespace supple
