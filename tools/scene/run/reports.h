// Reports of commands: JSON, and lines for people.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "lib/session/session.h"
#include "raycast/render.h"
#include "volumes/state/pose.h"

namespace supple::tools {

nlohmann::ordered_json vector_json(const Vec3d& v);
nlohmann::ordered_json to_json(const InversionCertificate& certificate);
nlohmann::ordered_json to_json(const BallReport& report, std::int64_t cut_links);
/// Name, elements, turn and shift of each.
nlohmann::ordered_json to_json(const RigidPieces& pieces);
nlohmann::ordered_json to_json(const StepRecord& record);
/// One line per handle on stdout: voxel, LPS, density and label.
void print_places(const std::vector<HandlePlace>& places);
nlohmann::ordered_json to_json(const std::vector<HandlePlace>& places);
/// One line per handle on stdout.
void print_reactions(const std::vector<HandleReaction>& reactions);
nlohmann::ordered_json to_json(const RenderReport& report);

/// The report of `export` and `resample` with --json.
void print_dense_report(const std::string& path, const Geometry& grid, std::int64_t lost_voxels,
                        const InversionCertificate& certificate);

}  // namespace supple::tools
