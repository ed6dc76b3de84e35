// The anchors and rigid pieces of a state as JSON.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "volumes/base/vec.h"

namespace supple {

/// Elements that stay where they are: boxes, both corners inside, then labels, then selections as
/// JSON.
struct Anchors {
  std::vector<IndexBox> boxes;
  std::vector<std::int32_t> labels;
  std::vector<std::string> selections;
};
/// [[i0, j0, k0, i1, j1, k1], ..., {"label": n}, ..., {"select": {...}}, ...]
std::string anchors_to_json(const Anchors& anchors);
/// Throws InputError naming `file` when the text is no list of those.
Anchors anchors_from_json(const std::string& text, const std::string& file);

/// A list of objects, each given as its JSON; and back.
std::string pieces_to_json(const std::vector<std::string>& pieces);
/// Throws InputError naming `file` when the text is no list of objects.
std::vector<std::string> pieces_from_json(const std::string& text, const std::string& file);

}  // namespace supple
