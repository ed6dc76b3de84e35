#include "tools/scene/live/first_anchor.h"

#include <algorithm>

#include "tools/scene/file/scene.h"

namespace supple::tools {

std::optional<LiveEvent> first_anchor(LiveSession& live) {
  const Body& body = live.session().body();
  const bool is_state = is_state_file(live.scene().volume_path);
  if (is_state || !live.events().empty() || body.rigid.empty()) return std::nullopt;
  const std::vector<RigidPiece>& pieces = body.rigid.list;
  const auto largest =
      std::max_element(pieces.begin(), pieces.end(), [](const RigidPiece& a, const RigidPiece& b) {
        return a.elements->size() < b.elements->size();
      });
  const Vec3i voxel = voxel_of(body.elements, largest->elements->first());
  Table root =
      Table::parse("[[event]]\nkind = \"anchor\"\nrigid_at = [" + std::to_string(voxel.x) + ", " +
                       std::to_string(voxel.y) + ", " + std::to_string(voxel.z) + "]\n",
                   "the anchor of the largest bone");
  return read_event(root.tables("event").front(), live.scene().label_names);
}

}  // namespace supple::tools
