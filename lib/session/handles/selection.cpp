#include "lib/session/handles/selection.h"

#include <algorithm>
#include <cmath>

#include "volumes/base/error.h"
#include "volumes/base/json.h"
#include "volumes/base/text.h"
#include "volumes/grid/labels.h"

namespace supple {

namespace {

constexpr std::size_t kMaxFoundText = 80;

bool is_within(const std::optional<NumberPair>& range, const DensityGrid& density,
               const Vec3i& voxel) {
  if (!range) return true;
  const double value = density.at(voxel);
  return value >= range->first && value <= range->second;
}

/// Distance of the voxel outside box and ball; 0 inside. Exact where the axes are perpendicular.
double distance_mm(const Selection& selection, const Geometry& geometry, const Vec3i& voxel) {
  const auto length_mm = [&](const Vec3d& step) {
    return geometry.world_vector_from_index(step).length();
  };
  double distance = 0;
  if (selection.box) {
    Vec3d step(0.0);
    for (int c = 0; c < 3; ++c) {
      step[c] = voxel[c] - std::clamp(voxel[c], selection.box->lo[c], selection.box->hi[c]);
    }
    distance = length_mm(step);
  }
  if (selection.ball_index) {
    distance = std::max(distance, beyond_ball_mm(selection, geometry, voxel));
  }
  return distance;
}

/// True if a brick may hold voxels no further than that outside box and ball: an axis of the grid
/// changes the distance by at most its own length for each voxel.
bool may_reach(const Selection& selection, const Geometry& geometry, const Vec3i& brick,
               double within_mm) {
  constexpr int kHalf = kBrickDim / 2;
  const Vec3d spacing = geometry.spacing_mm();
  const double half_mm = kHalf * (spacing.x + spacing.y + spacing.z);
  return distance_mm(selection, geometry, brick + Vec3i(kHalf)) - half_mm <= within_mm;
}

/// Visits the elements no further than `within_mm` outside box and ball for which `is_in(voxel)`
/// holds, brick by brick: visit(brick, mask).
template <class IsIn, class Visit>
void for_each_brick_of(const Selection& selection, const Body& body, double within_mm,
                       const IsIn& is_in, const Visit& visit) {
  const BrickTopology& elements = body.elements;
  for (std::size_t b = 0; b < elements.brick_count(); ++b) {
    if (!may_reach(selection, body.geometry, elements.origin(b), within_mm)) continue;
    BrickMask mask{};
    for_each_active(elements.mask(b), [&](int offset) {
      if (is_in(elements.origin(b) + brick_local(offset))) mask_set(mask, offset);
    });
    if (mask_count(mask) > 0) visit(b, mask);
  }
}

/// True if a link is cut on the way from a voxel to the box or ball: along links, as near to the
/// straight line as they lie.
bool is_cut_off(const Selection& selection, const Body& body, const LinkCuts& cuts, Vec3i voxel) {
  Vec3i count, step;  // links left along each axis, and their direction
  for (int c = 0; c < 3; ++c) {
    const int to = selection.ball_index
                       ? int(std::lround((*selection.ball_index)[c]))
                       : std::clamp(voxel[c], selection.box->lo[c], selection.box->hi[c]);
    count[c] = std::abs(to - voxel[c]);
    step[c] = to < voxel[c] ? -1 : 1;
  }
  const Vec3d all(count);
  while (count != Vec3i(0) && distance_mm(selection, body.geometry, voxel) > 0) {
    int axis = -1;  // that with the largest part of its links left
    for (int c = 0; c < 3; ++c) {
      if (count[c] == 0) continue;
      if (axis < 0 || (count[c] - 0.5) / all[c] > (count[axis] - 0.5) / all[axis]) axis = c;
    }
    Vec3i next = voxel;
    next[axis] += step[axis];
    --count[axis];
    const Vec3i& low = step[axis] > 0 ? voxel : next;
    const std::int32_t brick = body.elements.find(low);
    if (brick >= 0 && cuts.is_cut(std::size_t(brick), brick_offset(low), axis)) return true;
    voxel = next;
  }
  return false;
}

std::string density_text(const NumberPair& range) {
  return number_text(range.first) + ":" + number_text(range.second);
}

const SlotSet& rigid_elements(const Vec3i& voxel, const Body& body, const std::string& role) {
  Slot slot;
  const int piece = slot_of(body.elements, voxel, slot) ? body.rigid.at(slot) : -1;
  if (piece >= 0) return *body.rigid.list[std::size_t(piece)].elements;
  throw InputError({"", role + " rigid:" + to_text(voxel),
                    body.rigid.empty() ? "a body without rigid pieces"
                                       : "voxel " + to_text(voxel) + " of no rigid piece",
                    "a voxel of a rigid piece"});
}

bool holds(const SlotSet& set, const BrickTopology& elements, const Vec3i& voxel) {
  Slot slot;
  return slot_of(elements, voxel, slot) && set.contains(slot);
}

[[noreturn]] void throw_empty(const Selection& selection, const Body& body,
                              const std::string& role) {
  std::string expected = "a selection that holds elements";
  if (selection.ball_index) {
    Vec3i centre;
    for (int c = 0; c < 3; ++c) centre[c] = int(std::lround((*selection.ball_index)[c]));
    expected += "; " + nearest_text(body, centre);
  } else if (selection.density) {
    expected += "; those of the body have densities from " + number_text(body.material.active_lo) +
                " to " + number_text(body.material.active_hi);
  }
  throw InputError({"", role + " " + selection.name(), "no element", expected});
}

}  // namespace

double beyond_ball_mm(const Selection& selection, const Geometry& geometry, const Vec3i& voxel) {
  const Vec3d from = Vec3d(voxel) - *selection.ball_index;
  return geometry.world_vector_from_index(from).length() - selection.radius_mm;
}

bool Selection::operator==(const Selection& other) const {
  return box == other.box && ball_index == other.ball_index && radius_mm == other.radius_mm &&
         density == other.density && piece_at == other.piece_at && rigid_at == other.rigid_at;
}

std::string Selection::name() const {
  std::string text;
  const auto add = [&](const std::string& part) { text += (text.empty() ? "" : " ") + part; };
  if (box) add(Region(*box).name());
  if (ball_index) add("ball:" + to_text(*ball_index) + ":" + number_text(radius_mm));
  if (density) add("density:" + density_text(*density));
  if (rigid_at) add("rigid:" + to_text(*rigid_at));
  if (piece_at) add("piece:" + to_text(*piece_at));
  return text;
}

Region region_of(const Selection& selection, const Body& body, const DensityGrid& density,
                 const std::string& role) {
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  const SlotSet* rigid =
      selection.rigid_at ? &rigid_elements(*selection.rigid_at, body, role) : nullptr;
  const auto is_in = [&](const Vec3i& voxel) {
    if (rigid != nullptr && !holds(*rigid, body.elements, voxel)) return false;
    return distance_mm(selection, body.geometry, voxel) <= 0 &&
           is_within(selection.density, density, voxel);
  };
  for_each_brick_of(selection, body, 0, is_in, [&](std::size_t b, const BrickMask& mask) {
    origins.push_back(body.elements.origin(b));
    masks.push_back(mask);
  });
  BrickTopology found(std::move(origins), std::move(masks));
  if (found.empty()) throw_empty(selection, body, role);
  if (selection.piece_at) {
    const Vec3i& voxel = *selection.piece_at;
    found = component_at(found, voxel);
    if (found.empty()) {
      const bool is_element = body.elements.is_active(voxel);
      throw InputError({"", role + " " + selection.name(),
                        "voxel " + to_text(voxel) +
                            (is_element ? " of density " + number_text(density.at(voxel)) +
                                              ", which is not selected"
                                        : ", which is void"),
                        is_element ? "a voxel of the piece"
                                   : "a voxel of the piece; " + nearest_text(body, voxel)});
    }
  }
  return Region::of_mask(std::make_shared<BrickTopology>(std::move(found)), selection.name());
}

SoftEdge soft_edge(const Selection& selection, double width_mm, const Body& body,
                   const LinkCuts& cuts, const DensityGrid& density) {
  SoftEdge edge;
  std::vector<SlotSet::Brick> bricks;
  const auto is_in = [&](const Vec3i& voxel) {
    const double distance = distance_mm(selection, body.geometry, voxel);
    return distance > 0 && distance < width_mm && is_within(selection.density, density, voxel) &&
           (cuts.empty() || !is_cut_off(selection, body, cuts, voxel));
  };
  for_each_brick_of(selection, body, width_mm, is_in, [&](std::size_t b, const BrickMask& mask) {
    bricks.push_back({std::uint32_t(b), mask});
    for_each_active(mask, [&](int offset) {
      const Vec3i voxel = body.elements.origin(b) + brick_local(offset);
      const double t = distance_mm(selection, body.geometry, voxel) / width_mm;
      edge.parts.push_back(1 - t * t * (3 - 2 * t));
    });
  });
  edge.slots = SlotSet(std::move(bricks));
  return edge;
}

Value selection_value(const Selection& selection) {
  Value value = Value::Entries();
  if (const auto& box = selection.box) {
    value["grab_box"] = *box;
  }
  if (const auto& ball = selection.ball_index) {
    value["grab_ball"] = *ball;
    value["radius"] = selection.radius_mm;
  }
  if (const auto& range = selection.density) value["grab_density"] = {range->first, range->second};
  if (const auto& voxel = selection.rigid_at) value["rigid_at"] = *voxel;
  if (const auto& voxel = selection.piece_at) value["piece_at"] = *voxel;
  return value;
}

Selection selection_of(const Value& value, const std::string& file) {
  Selection selection;
  try {
    const auto list = [&](const char* key, std::size_t size) {
      const std::vector<double> values = numbers_of(value.at(key));
      if (values.size() != size) throw std::out_of_range("another length");
      for (const double one : values) {
        if (!(std::abs(one) <= kMaxCoordinate)) throw std::out_of_range("no place");
      }
      return values;
    };
    const auto voxel_at = [](const std::vector<double>& v, std::size_t first) {
      return Vec3i(int(v[first]), int(v[first + 1]), int(v[first + 2]));
    };
    if (value.contains("grab_box")) {
      const auto v = list("grab_box", 6);
      selection.box = IndexBox{voxel_at(v, 0), voxel_at(v, 3)};
    }
    if (value.contains("grab_ball")) {
      const auto v = list("grab_ball", 3);
      selection.ball_index = Vec3d(v[0], v[1], v[2]);
      selection.radius_mm = value.at("radius").number();
    }
    if (value.contains("grab_density")) {
      const auto v = list("grab_density", 2);
      selection.density = NumberPair(v[0], v[1]);
    }
    if (value.contains("rigid_at")) selection.rigid_at = voxel_at(list("rigid_at", 3), 0);
    if (value.contains("piece_at")) selection.piece_at = voxel_at(list("piece_at", 3), 0);
    if (selection == Selection()) throw std::out_of_range("nothing selected");
  } catch (const std::exception&) {
    throw InputError(
        {file, "anchors", json_text(value).substr(0, kMaxFoundText), "a selection of elements"});
  }
  return selection;
}

const IndexBox* ChosenPart::box() const {
  if (label != 0 || !selection || !selection->box) return nullptr;
  Selection box_alone;
  box_alone.box = selection->box;
  return *selection == box_alone ? &*selection->box : nullptr;
}

std::string ChosenPart::title() const {
  if (!name.empty()) return name;
  return selection ? selection->name() : "label:" + std::to_string(label);
}

SlotSet elements_of(const ChosenPart& part, const Body& body, const DensityGrid& density,
                    const BrickValues& labels, const std::string& role) {
  if (part.label != 0) {
    require_label(labels, part.label, role);
    return slots_in_mask(body.elements, label_mask(body.elements, labels, part.label));
  }
  return elements_of(body, region_of(*part.selection, body, density, role), role);
}

Value chosen_value(const ChosenPart& part) {
  Value value = Value::Entries();
  if (part.selection) value = selection_value(*part.selection);
  if (part.label != 0) value["grab_label"] = part.label;
  if (!part.name.empty()) value["name"] = part.name;
  return value;
}

}  // namespace supple
