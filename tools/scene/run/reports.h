// Reports of commands as JSON.
#pragma once

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
nlohmann::ordered_json to_json(const std::vector<HandlePlace>& places);
nlohmann::ordered_json to_json(const RenderReport& report);

}  // namespace supple::tools
