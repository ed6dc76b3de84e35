// A part of a body under the name that the user gave it: a voxel, a box, points or a mask. It knows
// voxels only; elements_of() finds which of them are elements.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "lib/body/body.h"
#include "lib/body/slot_set.h"

namespace supple {

class Region {
 public:
  /// One voxel, named "i,j,k".
  Region(const Vec3i& voxel) : Region(voxel, voxel) {}
  /// A box, both corners included, named "i,j,k:i,j,k".
  Region(const IndexBox& box) : m_shape(box) {}
  Region(const Vec3i& lo, const Vec3i& hi) : m_shape(IndexBox{lo, hi}) {}
  /// Voxels that must all be elements, for example of a point list; duplicates are allowed.
  static Region of_points(std::vector<Vec3i> voxels, std::string name);
  /// The elements among the voxels of a mask, for example of a label. Shared, as masks are large.
  static Region of_mask(std::shared_ptr<const BrickTopology> mask, std::string name);

  using Mask = std::shared_ptr<const BrickTopology>;

  /// The same name and voxels; of masks, the same mask.
  bool operator==(const Region& other) const {
    return m_shape == other.m_shape && m_name == other.m_name;
  }
  bool operator!=(const Region& other) const { return !(*this == other); }

  /// The name as the user wrote it.
  std::string name() const;
  /// The shape of the region: one of these three, the others are null.
  const IndexBox* box() const { return std::get_if<IndexBox>(&m_shape); }
  const std::vector<Vec3i>* points() const { return std::get_if<std::vector<Vec3i>>(&m_shape); }
  const Mask* mask() const { return std::get_if<Mask>(&m_shape); }

 private:
  using Shape = std::variant<IndexBox, std::vector<Vec3i>, Mask>;
  Region(Shape shape, std::string name) : m_shape(std::move(shape)), m_name(std::move(name)) {}

  Shape m_shape;
  std::string m_name;
};

/// The elements of a region; cost as its size in bricks (boxes, masks) or voxels (points). Throws
/// InputError, named `role` ("grab", "fix") and by the region's name, when there is none or a point
/// is void; it says where the nearest element is.
SlotSet elements_of(const Body& body, const Region& region, const std::string& role);

/// The text "i,j,k" of a voxel, as users write it.
std::string voxel_text(const Vec3i& voxel);

/// The text "the nearest is i,j,k, D mm away", or that the body is empty.
std::string nearest_text(const Body& body, const Vec3i& voxel);

}  // namespace supple
