#include "lib/body/region.h"

#include "volumes/base/error.h"
#include "volumes/base/text.h"

namespace supple {

namespace {

SlotSet slots_at(const Body& body, const std::vector<Vec3i>& voxels, const std::string& field) {
  std::vector<Slot> slots;
  slots.reserve(voxels.size());
  for (const Vec3i& voxel : voxels) {
    Slot slot;
    if (!slot_of(body.elements, voxel, slot)) {
      throw InputError({"", field, "no element at " + voxel_text(voxel),
                        "points in the body; " + nearest_text(body, voxel)});
    }
    slots.push_back(slot);
  }
  return SlotSet(std::move(slots));
}

/// Any voxel of a box or a mask, from which to look for the nearest element.
Vec3i some_voxel(const Region& region) {
  if (region.box() != nullptr) return region.box()->lo;
  Vec3i voxel(0);
  if (region.mask() != nullptr && !(*region.mask())->empty()) {
    const BrickTopology& mask = **region.mask();
    for_each_active(mask.mask(0),
                    [&](int offset) { voxel = mask.origin(0) + brick_local(offset); });
  }
  return voxel;
}

}  // namespace

std::string voxel_text(const Vec3i& voxel) {
  return to_text(voxel);
}

std::string nearest_text(const Body& body, const Vec3i& voxel) {
  Vec3i nearest;
  if (!nearest_element(body, voxel, nearest)) return "the body has no elements";
  const Vec3d apart =
      body.geometry.world_from_index(Vec3d(nearest)) - body.geometry.world_from_index(Vec3d(voxel));
  return "the nearest is " + voxel_text(nearest) + ", " + number_text(apart.length()) + " mm away";
}

Region Region::of_points(std::vector<Vec3i> voxels, std::string name) {
  return {Shape(std::move(voxels)), std::move(name)};
}

Region Region::of_mask(std::shared_ptr<const BrickTopology> mask, std::string name) {
  return {Shape(std::move(mask)), std::move(name)};
}

std::string Region::name() const {
  if (box() == nullptr) return m_name;
  return voxel_text(box()->lo) + (box()->lo == box()->hi ? "" : ":" + voxel_text(box()->hi));
}

SlotSet elements_of(const Body& body, const Region& region, const std::string& role) {
  const std::string field = role + " " + region.name();
  const IndexBox* box = region.box();
  SlotSet slots = box != nullptr               ? slots_in_box(body.elements, *box)
                  : region.points() != nullptr ? slots_at(body, *region.points(), field)
                                               : slots_in_mask(body.elements, **region.mask());
  if (!slots.empty()) return slots;
  const bool single = box != nullptr && box->lo == box->hi;
  throw InputError(
      {"", field, "no element",
       std::string(single ? "a voxel of the body; " : "a region that holds elements; ") +
           nearest_text(body, some_voxel(region))});
}

}  // namespace supple
