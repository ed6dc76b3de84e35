#include "lib/session/retraction.h"

#include <algorithm>
#include <cmath>

#include "lib/session/handles/drag_handles.h"
#include "volumes/base/error.h"
#include "volumes/base/text.h"
#include "volumes/base/value.h"

namespace supple {

namespace {

/// Coordinates of a patch: x = corner + s edge1 + t edge2 + d normal, d in mm.
class PatchFrame {
 public:
  PatchFrame(const Retraction& patch, const Geometry& geometry) {
    const auto world = [&](const Vec3d& v) {
      return patch.in_voxels ? geometry.world_vector_from_index(v) : v;
    };
    m_corner = patch.in_voxels ? geometry.world_from_index(patch.corner) : patch.corner;
    const Vec3d edge1 = world(patch.edge1), edge2 = world(patch.edge2);
    m_normal = edge1.cross(edge2).normalized();
    const double area = edge1.cross(edge2).length();
    m_along1 = edge2.cross(m_normal) / area;
    m_along2 = m_normal.cross(edge1) / area;
  }

  Vec3d operator()(const Vec3d& place_lps_mm) const {
    const Vec3d from = place_lps_mm - m_corner;
    return {m_along1.dot(from), m_along2.dot(from), m_normal.dot(from)};
  }
  const Vec3d& normal() const { return m_normal; }

 private:
  Vec3d m_corner, m_normal, m_along1, m_along2;
};

struct Lip {
  std::vector<Slot> slots;
  std::vector<Vec3d> places;  // in the frame of the patch
};

}  // namespace

Fields fields(Retraction& retraction) {
  return {
      Field("corner", retraction.corner, "A point [x, y, z], at the depth of the incision")
          .required(),
      Field("edge1", retraction.edge1, "A vector [x, y, z] along the incision").required(),
      Field("edge2", retraction.edge2, "A vector [x, y, z] from its depth to the skin").required(),
      Field("frame", retraction.in_voxels, {"lps", "voxel"}, "LPS mm, or voxels of the volume"),
      Field("by", retraction.by_mm, "How far apart the lips are pushed, in the middle at the skin")
          .unit("mm")
          .positive()
          .required(),
      Field("width", retraction.width_mm, "Of each lip, beside the patch").unit("mm").positive(),
  };
}

std::vector<Handle> handles_of(const Retraction& retraction, const Body& body,
                               const SlotSet& taken) {
  const Geometry& geometry = body.geometry;
  const PatchFrame frame(retraction, geometry);
  Lip lips[2];
  double t_skin = 0;
  for_each_element(body.elements, [&](Slot slot) {
    const Vec3d at = frame(geometry.world_from_index(Vec3d(voxel_of(body.elements, slot))));
    if (at.x < 0 || at.x > 1 || at.y < 0 || at.y > 1) return;
    if (std::abs(at.z) > retraction.width_mm || taken.contains(slot)) return;
    t_skin = std::max(t_skin, at.y);
    Lip& lip = lips[at.z < 0];
    lip.slots.push_back(slot);
    lip.places.push_back(at);
  });
  std::vector<Handle> handles;
  for (const Lip& lip : lips) {
    const bool is_first = handles.empty();
    const std::string name = std::string(is_first ? "first" : "second") + " lip of retract";
    if (lip.slots.empty()) {
      throw InputError({retraction.place, "retract",
                        "no element within " + number_text(retraction.width_mm) +
                            " mm of the patch on the side " + (is_first ? "of" : "against") +
                            " edge1 x edge2",
                        "a patch with tissue on both sides"});
    }
    Handle handle(region_of(SlotSet(lip.slots), body.elements, name), {0, 0, 0}, HandleKind::push);
    for (const Vec3d& at : lip.places) {
      const double part = 4 * at.x * (1 - at.x) * (t_skin > 0 ? at.y / t_skin : 0);
      const double way_mm = (is_first ? 0.5 : -0.5) * retraction.by_mm * part;
      const Vec3d by = geometry.index_vector_from_world(frame.normal() * way_mm);
      handle.each_by_q.push_back(fixed_from_mm(by, Vec3d(1)));
    }
    handles.push_back(std::move(handle));
  }
  return handles;
}

Value settings_value(const Retraction& retraction) {
  Retraction same = retraction;
  return fields_value(fields(same));
}

}  // namespace supple
