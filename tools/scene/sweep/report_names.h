// Names of the values in a run's report: steps[0].fem.volume_change_ml.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "volumes/base/value.h"

namespace supple::tools {

/// Values of a report by name: numbers, texts and truths of tables and lists within each other,
/// whose items count from 0, in their order.
using NamedValues = std::vector<std::pair<std::string, Value>>;

/// A list of three numbers in newtons, newton millimetres or millimetres also stands for its
/// length, under its own name.
NamedValues named_values(const Value& report);

/// True for the results that a table of runs has unless told otherwise: forces, volumes, pressures,
/// the least det F, and the part of a drag that was possible. None of them is a time.
bool is_main_result(const std::string& name);

/// The one of the values that is meant by a name, or by the end of one that no other has; null
/// where there is none.
const std::pair<std::string, Value>* find_named(const NamedValues& values, const std::string& name);

/// The last part of a name in words, with the unit of its suffix: "volume change (ml)".
std::string words_of(const std::string& name);

}  // namespace supple::tools
