// Procedural sampling paths as scenes and files give them: `path = { function = "twist", … }`, or
// a list of such tables, applied to the body one after another.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "lib/state/pose.h"
#include "volumes/base/progress.h"
#include "volumes/base/table.h"
#include "volumes/base/value.h"
#include "volumes/field/paths/path_functions.h"

namespace supple::tools {

/// Numbers, places and names in the tables of functions, as far as they are given. A function has
/// some of them.
struct FunctionKeys {
  std::optional<Vec3d> point, axis, towards, normal, hinge;
  std::optional<NumberPair> range;
  std::optional<double> angle, factor, gap;
  std::string points;
};
Fields fields(FunctionKeys& keys);

/// A function of one table. Absent values are chosen by the volume's geometry.
struct OffsetFunction {
  std::string place, name;  // for errors: "file:line", "path[2]"
  Value given;              // the table
  std::function<std::shared_ptr<const PathFunction>(const Geometry&)> make;
};

/// The key `path` of a table: a table of a function, a list of them, or the name of a file that
/// holds that key; empty when absent. Throws InputError as Table does.
std::vector<OffsetFunction> read_path(Table& table);
/// The option that names such a file.
Field path_file_field(std::string& file);
/// A file that holds the key `path`; none for an empty name.
std::vector<OffsetFunction> read_path_file(const std::string& file, Progress& progress);

/// Throws InputError with the place of the function that has a bad value.
SamplingPath to_path(const std::vector<OffsetFunction>& functions, const Geometry& geometry);

/// A body at rest as the functions show it; `body`: elements and shell, or all that a volume holds.
Pose send_along(const std::vector<OffsetFunction>& functions, const Geometry& geometry,
                const BrickTopology& body, Progress& progress);
/// Sends a body along that has moved already.
Pose send_along(const std::vector<OffsetFunction>& functions, const Pose& moved,
                Progress& progress);
/// Sends a pose along that nothing else needs: at no time both are whole.
Pose send_along(const std::vector<OffsetFunction>& functions, Pose&& moved, Progress& progress);
/// Inverts and sends the offsets of a state along; without functions as invert_state() does.
Pose invert_and_send_along(const State& state, const std::vector<OffsetFunction>& functions,
                           Progress& progress);
OffsetField send_along(const std::vector<OffsetFunction>& functions, const OffsetField& moved,
                       Progress& progress);

}  // namespace supple::tools
