#include "lib/body/region.h"

#include "volumes/base/error.h"

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

}  // namespace

std::string voxel_text(const Vec3i& voxel) {
  return std::to_string(voxel.x) + "," + std::to_string(voxel.y) + "," + std::to_string(voxel.z);
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
  const auto* box = std::get_if<IndexBox>(&m_shape);
  if (box == nullptr) return m_name;
  return voxel_text(box->lo) + (box->lo == box->hi ? "" : ":" + voxel_text(box->hi));
}

Vec3i Region::some_voxel() const {
  if (const auto* box = std::get_if<IndexBox>(&m_shape)) return box->lo;
  if (const auto* voxels = std::get_if<std::vector<Vec3i>>(&m_shape)) {
    return voxels->empty() ? Vec3i(0) : voxels->front();
  }
  const BrickTopology& mask = *std::get<Mask>(m_shape);
  Vec3i voxel(0);
  if (!mask.empty()) {
    for_each_active(mask.mask(0),
                    [&](int offset) { voxel = mask.origin(0) + brick_local(offset); });
  }
  return voxel;
}

SlotSet elements_of(const Body& body, const Region& region, const std::string& role) {
  const std::string field = role + " " + region.name();
  SlotSet slots;
  bool single = false;
  if (const auto* box = std::get_if<IndexBox>(&region.m_shape)) {
    single = box->lo == box->hi;
    slots = slots_in_box(body.elements, *box);
  } else if (const auto* voxels = std::get_if<std::vector<Vec3i>>(&region.m_shape)) {
    slots = slots_at(body, *voxels, field);
  } else {
    slots = slots_in_mask(body.elements, *std::get<Region::Mask>(region.m_shape));
  }
  if (!slots.empty()) return slots;
  throw InputError(
      {"", field, "no element",
       std::string(single ? "a voxel of the body; " : "a region that holds elements; ") +
           nearest_text(body, region.some_voxel())});
}

}  // namespace supple
