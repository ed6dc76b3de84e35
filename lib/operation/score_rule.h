// Rules by which an operation is scored: what takes how many points off.
#pragma once

#include <string>
#include <vector>

#include "lib/operation/measure.h"
#include "volumes/base/fields.h"
#include "volumes/base/table.h"
#include "volumes/base/value.h"

namespace supple {

/// Takes points off: per unit of what it measures beyond `allowed`, or short of it where more is
/// better, at most `most`.
struct ScoreRule {
  ScoreCategory category = ScoreCategory::tissue;
  std::string measure;     // a row of measure_kinds()
  std::string instrument;  // empty: events of any; tips of all but the lamp
  std::string at;          // obstacle or membrane; empty: all
  double allowed = 0;
  double points_per_unit = 1;
  double most = 100;
  std::string place;  // file and line, for errors
};
/// Keys of a row of [[score]].
Fields fields(ScoreRule& rule);

/// Rules that fit any scene, for one that gives none.
std::vector<ScoreRule> default_score_rules();
/// Rows of [[score]], or the default ones where there is no such key. A rule without a category has
/// the usual one of its measure. Throws InputError for a key that its measure does not look at.
std::vector<ScoreRule> read_score_rules(Table& scene);
/// The table from which the same rule is read.
Value to_value(const ScoreRule& rule);

}  // namespace supple
