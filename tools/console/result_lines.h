// Results on stdout as people read them.
#pragma once

#include <string>
#include <vector>

#include "lib/session/session.h"
#include "volumes/base/value.h"
#include "volumes/field/offset_field.h"

namespace supple::tools {

/// One line per handle: voxel, LPS, density and label.
void print_places(const std::vector<HandlePlace>& places);
/// One line per handle: the force that it takes.
void print_reactions(const std::vector<HandleReaction>& reactions);
/// The report of `export` and `resample` with --json.
void print_dense_report(const std::string& path, const Geometry& grid, std::int64_t lost_voxels,
                        const InversionCertificate& certificate);

/// Numbers that are no integers to four digits, strings without quotes, lists in brackets.
std::string people_text(const Value& value);

}  // namespace supple::tools
