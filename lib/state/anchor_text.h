// The anchors, rigid pieces and mesh bodies of a state as JSON.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "volumes/base/value.h"

namespace supple {

/// Elements that stay where they are: boxes, both corners inside, then labels, then selections.
struct Anchors {
  std::vector<IndexBox> boxes;
  std::vector<std::int32_t> labels;
  std::vector<Value> selections;
};
/// [[i0, j0, k0, i1, j1, k1], ..., {"label": n}, ..., {"select": {...}}, ...]
std::string anchors_to_json(const Anchors& anchors);
/// Throws InputError naming `file` when the text is no list of those.
Anchors anchors_from_json(const std::string& text, const std::string& file);

/// Tables of a list of them, their keys in order. Throws InputError naming `file` and `field` when
/// the text is none.
std::vector<Value> tables_from_json(const std::string& text, const std::string& field,
                                    const std::string& file);

}  // namespace supple
