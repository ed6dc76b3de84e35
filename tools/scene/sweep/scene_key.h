// Paths of keys in a scene: material.poisson, step[2].tets.spacing,
// step.fem.swellings[left].pressure_kpa, material.label."left ventricle".stiffness.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "volumes/base/value.h"

namespace supple::tools {

/// A place in a tree of values: keys of tables, and items of lists, whose keys are empty.
using ScenePlace = std::vector<std::pair<std::string, std::size_t>>;

/// The value of a place; null where there is none.
const Value* find_at(const Value& root, ScenePlace::const_iterator begin,
                     ScenePlace::const_iterator end);

/// A key of a scene. A list of tables stands for each of its tables, with [N] for one of them,
/// counted from 1 as errors of scenes do, and with [NAME] for those of that `name`.
class SceneKey {
 public:
  /// Throws UsageError, of `option`, for a text that is no path.
  explicit SceneKey(const std::string& text, const std::string& option = "--vary");

  const std::string& text() const { return m_text; }

  /// Sets the value wherever the key is; where it is nowhere, in all tables that could have it,
  /// with the tables on the way: the reader of scenes then says whether it knows the key. `table =
  /// FILE` of a material is replaced by what is in the file. Returns the places that have the value
  /// now. A text in place of a table with a `path`, as of [volume] and [labels], is that path.
  /// Throws InputError, of `scene_file`, for a table that is not there.
  std::vector<ScenePlace> set(Value& root, const std::string& scene_file, const Value& value) const;

 private:
  struct Part {
    std::string name;
    std::string which;  // within [ ]; empty: all
  };
  /// A table that has the first `depth` parts of the path.
  struct End {
    Value* table;
    std::size_t depth;
    ScenePlace place;
  };
  std::size_t add_part(std::size_t at);
  void find_ends(Value& table, const ScenePlace& place, std::size_t depth, const std::string& file,
                 std::vector<End>& ends) const;
  ScenePlace put(const End& end, const std::string& file, const Value& value) const;
  std::vector<Value*> chosen(Value& child, std::size_t part, const std::string& file) const;
  std::string name_until(std::size_t part) const;

  std::string m_text;
  std::vector<Part> m_parts;
};

}  // namespace supple::tools
