#include "lib/session/rigid_request.h"

#include <algorithm>
#include <cmath>

#include "lib/body/rigid_links.h"
#include "lib/session/handles/handle_motion.h"
#include "volumes/base/error.h"
#include "volumes/base/json.h"
#include "volumes/base/text.h"
#include "volumes/grid/labels.h"

namespace supple {

namespace {

/// Elements that turn into a piece while more than this from a rigid pose are told of.
constexpr double kToldVoxels = 1e-3;

Vec3d centre_of(const BrickTopology& elements, const SlotSet& slots) {
  Vec3d sum(0.0);
  slots.for_each([&](Slot slot) { sum += Vec3d(voxel_of(elements, slot)); });
  return sum / double(slots.size());
}

RigidPiece piece_of(const Body& body, std::string name, SlotSet slots) {
  RigidPiece piece;
  piece.name = std::move(name);
  piece.centre_index = centre_of(body.elements, slots);
  piece.elements = std::make_shared<SlotSet>(std::move(slots));
  return piece;
}

bool is_shifted_as_one(const Body& body, const RigidPiece& piece,
                       std::array<std::int64_t, 3>& shift_q) {
  bool is_first = true, is_alike = true;
  piece.elements->for_each([&](Slot slot) {
    for (std::size_t c = 0; c < 3; ++c) {
      const std::int32_t q = body.q[c].at(slot);
      if (is_first) shift_q[c] = q;
      is_alike = is_alike && shift_q[c] == q;
    }
    is_first = false;
  });
  return is_alike;
}

/// Puts every element where the pose says; returns the largest move in voxels.
double put_at_pose(Body& body, const RigidPiece& piece) {
  const PoseOffsets offsets(body.geometry, piece);
  double largest = 0;
  for (BrickValues& q : body.q) q.resize(body.elements.brick_count());
  piece.elements->for_each([&](Slot slot) {
    const std::array<std::int64_t, 3> to = offsets(voxel_of(body.elements, slot));
    for (std::size_t c = 0; c < 3; ++c) {
      const std::int64_t by = to[c] - body.q[c].at(slot);
      largest = std::max(largest, double(std::llabs(by)) / kFixedOne);
      if (by != 0)
        body.q[c].set(slot, std::int32_t(std::clamp<std::int64_t>(to[c], -kMaxOffset, kMaxOffset)));
    }
  });
  return largest;
}

/// The pose of a new piece: the one nearest to where its elements are, which go there.
void find_pose(Body& body, RigidPiece& piece, Progress* progress) {
  piece.pose = {};
  if (is_shifted_as_one(body, piece, piece.pose.shift_q)) return;
  RigidFit fit;
  piece.pose = {};
  const Geometry& geometry = body.geometry;
  piece.elements->for_each([&](Slot slot) {
    fit.add(geometry.world_from_index(Vec3d(voxel_of(body.elements, slot))),
            geometry.world_from_index(place_now(body, slot)));
  });
  piece.pose = moved_by(fit.motion(), piece, geometry);
  const double largest = put_at_pose(body, piece);
  body.links_known_valid = false;
  if (largest <= kToldVoxels) return;
  warn(progress, "rigid " + piece.name + ": its elements were bent and moved by up to " +
                     number_text(largest) + " voxels into the nearest rigid pose");
}

std::vector<RigidPiece> without(const std::vector<RigidPiece>& pieces, const SlotSet& taken,
                                const Body& body) {
  std::vector<RigidPiece> rest;
  for (const RigidPiece& piece : pieces) {
    Slot slot;
    rest.push_back(piece);
    if (!piece.elements->first_common(taken, slot)) continue;
    SlotSet left = *piece.elements;
    left.remove(taken);
    if (!left.empty()) {
      // The pose is told about another centre, where the same turn shifts otherwise.
      rest.back() = piece_of(body, piece.name, std::move(left));
      const std::array<std::int64_t, 3> first = PoseOffsets(body.geometry, piece)(Vec3i(0));
      rest.back().pose.turn = piece.pose.turn;
      const std::array<std::int64_t, 3> other = PoseOffsets(body.geometry, rest.back())(Vec3i(0));
      for (std::size_t c = 0; c < 3; ++c) rest.back().pose.shift_q[c] = first[c] - other[c];
    } else {
      rest.pop_back();
    }
  }
  return rest;
}

std::string first_voxel_name(const Body& body, const SlotSet& slots) {
  return "piece:" + to_text(voxel_of(body.elements, slots.first()));
}

/// Adds every connected part of the densities that is in no piece yet.
void add_density(Body& body, const LinkCuts& cuts, const NumberPair& range,
                 const DensityGrid& density, Progress* progress) {
  Selection selection;
  selection.density = range;
  SlotSet slots = elements_of(body, region_of(selection, body, density, "rigid"), "rigid");
  for (const RigidPiece& piece : body.rigid.list) slots.remove(*piece.elements);
  std::vector<RigidPiece> pieces = body.rigid.list;
  for (SlotSet& part : connected_parts(body.elements, cuts, slots)) {
    if (part.size() < kLeastPiece) continue;
    std::string name = first_voxel_name(body, part);
    pieces.push_back(piece_of(body, std::move(name), std::move(part)));
    find_pose(body, pieces.back(), progress);
  }
  body.rigid = numbered(std::move(pieces), body.elements);
}

std::vector<Slot> slots_of_seeds(const Body& body, const std::vector<Vec3i>& seeds) {
  std::vector<Slot> slots;
  for (const Vec3i& seed : seeds) {
    Slot slot;
    if (!slot_of(body.elements, seed, slot) || body.rigid.at(slot) < 0) {
      throw InputError({"", "rigid_seeds", "voxel " + to_text(seed) + " of no rigid piece",
                        "voxels of rigid pieces"});
    }
    slots.push_back(slot);
  }
  return slots;
}

/// Parts every piece that holds several seeds; the rest of it stays with the first of them.
void part_between(Body& body, const LinkCuts& cuts, const std::vector<Vec3i>& seeds,
                  const DensityGrid& density) {
  const std::vector<Slot> slots = slots_of_seeds(body, seeds);
  std::vector<RigidPiece> pieces;
  for (std::size_t n = 0; n < body.rigid.list.size(); ++n) {
    const RigidPiece& piece = body.rigid.list[n];
    std::vector<Slot> own;
    for (const Slot slot : slots) {
      if (body.rigid.at(slot) == int(n)) own.push_back(slot);
    }
    if (own.size() < 2) {
      pieces.push_back(piece);
      continue;
    }
    std::vector<SlotSet> parts = flooded_parts(body, density, cuts, *piece.elements, own);
    std::vector<RigidPiece> others = {piece};
    for (std::size_t p = 1; p < parts.size(); ++p) {
      SlotSet taken;
      for (std::size_t o = 0; o < parts.size(); ++o) {
        if (o != p) taken.add(parts[o]);
      }
      SlotSet rest = *piece.elements;
      rest.remove(parts[p]);
      std::vector<RigidPiece> part = without({piece}, rest, body);
      part.front().name = "piece:" + voxel_text(voxel_of(body.elements, own[p]));
      others.push_back(std::move(part.front()));
    }
    SlotSet taken;
    for (std::size_t p = 1; p < parts.size(); ++p) taken.add(parts[p]);
    others.front() = without({piece}, taken, body).front();
    others.front().name = "piece:" + voxel_text(voxel_of(body.elements, own[0]));
    pieces.insert(pieces.end(), others.begin(), others.end());
  }
  body.rigid = numbered(std::move(pieces), body.elements);
}

void add_part(Body& body, const ChosenPart& part, const DensityGrid& density,
              const BrickValues& labels, Progress* progress) {
  SlotSet slots = elements_of(part, body, density, labels, "rigid");
  std::vector<RigidPiece> pieces = without(body.rigid.list, slots, body);
  pieces.push_back(piece_of(body, part.title(), std::move(slots)));
  find_pose(body, pieces.back(), progress);
  body.rigid = numbered(std::move(pieces), body.elements);
}

/// Between pieces of seeds, and around those of parts.
std::int64_t cut_joint_spaces_of(const Body& body, LinkCuts& cuts, const RigidRequest& request) {
  if (request.joint_mm <= 0) return 0;
  const std::size_t pieces = body.rigid.list.size();
  const std::size_t first_part = pieces - std::min(pieces, request.parts.size());
  std::vector<char> has_seed(pieces, 0);
  for (const Vec3i& seed : request.seeds) {
    Slot slot;
    if (slot_of(body.elements, seed, slot) && body.rigid.at(slot) >= 0) {
      has_seed[std::size_t(body.rigid.at(slot))] = 1;
    }
  }
  return cut_joint_spaces(body, cuts, request.joint_mm, [&](std::size_t piece, std::size_t other) {
    return std::max(piece, other) >= first_part || (has_seed[piece] && has_seed[other]);
  });
}

}  // namespace

std::int64_t make_pieces(Body& body, LinkCuts& cuts, const RigidRequest& request,
                         const DensityGrid& density, const BrickValues& labels,
                         Progress* progress) {
  if (request.empty()) return 0;
  stage(progress, "finding rigid pieces");
  RigidPieces earlier = body.rigid;
  std::array<BrickValues, 3> q = body.q;
  try {
    if (request.density) add_density(body, cuts, *request.density, density, progress);
    if (!request.seeds.empty()) part_between(body, cuts, request.seeds, density);
    for (const ChosenPart& part : request.parts) add_part(body, part, density, labels, progress);
  } catch (const InputError&) {
    body.rigid = std::move(earlier);
    body.q = std::move(q);
    throw;
  }
  const std::int64_t between = cut_joints(body, cuts);
  const std::int64_t cut = between + cut_joint_spaces_of(body, cuts, request);
  body.cuts = cuts_with_pieces(body, cuts);
  return cut;
}

void part_pieces(Body& body, const LinkCuts& cuts, const std::vector<std::int64_t>& inside_before) {
  const std::vector<std::int64_t> inside = cut_links_inside(body, cuts);
  std::vector<RigidPiece> pieces;
  for (std::size_t n = 0; n < inside.size(); ++n) {
    const RigidPiece& piece = body.rigid.list[n];
    std::vector<SlotSet> parts;
    if (inside[n] > inside_before[n]) parts = connected_parts(body.elements, cuts, *piece.elements);
    if (parts.size() < 2) {
      pieces.push_back(piece);
      continue;
    }
    for (const SlotSet& part : parts) {
      SlotSet rest = *piece.elements;
      rest.remove(part);
      RigidPiece own = without({piece}, rest, body).front();
      own.name = first_voxel_name(body, part);
      pieces.push_back(std::move(own));
    }
  }
  body.rigid = numbered(std::move(pieces), body.elements);
}

void follow_shifts(Body& body) {
  for (RigidPiece& piece : body.rigid.list) {
    const Slot slot = piece.elements->first();
    const std::array<std::int64_t, 3> by_pose =
        PoseOffsets(body.geometry, piece)(voxel_of(body.elements, slot));
    for (std::size_t c = 0; c < 3; ++c) {
      piece.pose.shift_q[c] += body.q[c].at(slot) - by_pose[c];
    }
  }
}

Value settings_value(const RigidRequest& request) {
  Value value = Value::Entries();
  if (request.density) {
    value["rigid_density"] = {request.density->first, request.density->second};
  }
  for (const Vec3i& seed : request.seeds) value["rigid_seeds"].push_back(seed);
  if (request.joint_mm > 0) value["joint"] = request.joint_mm;
  for (const ChosenPart& part : request.parts) {
    value["rigid"].push_back(chosen_value(part));
  }
  return value;
}

std::vector<Value> records_of(const RigidPieces& pieces) {
  std::vector<Value> records;
  for (const RigidPiece& piece : pieces.list) {
    const Turn& turn = piece.pose.turn;
    records.push_back({{"name", piece.name},
                       {"shift", piece.pose.shift_q},
                       {"turn", {turn.w, turn.v.x, turn.v.y, turn.v.z}}});
  }
  return records;
}

RigidPieces pieces_of(const std::vector<Value>& records, const BrickValues& numbers,
                      const BrickTopology& elements, const std::string& file) {
  if (records.empty()) return {};
  std::vector<std::vector<Slot>> slots(records.size());
  for_each_element(elements, [&](Slot slot) {
    const std::int32_t number = numbers.at(slot);
    if (number > 0) slots[std::size_t(number - 1)].push_back(slot);
  });
  std::vector<RigidPiece> pieces;
  for (std::size_t n = 0; n < records.size(); ++n) {
    RigidPiece piece;
    try {
      const Value& shift = records[n].at("shift");
      piece.name = records[n].at("name").text();
      const std::vector<double> turn = numbers_of(records[n].at("turn"));
      if (turn.size() != 4 || shift.size() != 3) throw std::out_of_range("no pose");
      piece.pose.turn = {turn[0], {turn[1], turn[2], turn[3]}};
      for (std::size_t c = 0; c < 3; ++c) piece.pose.shift_q[c] = shift[c].whole();
      const double square = piece.pose.turn.squared_length();
      if (!(std::abs(square - 1) < 1e-9) || slots[n].empty()) throw std::out_of_range("no pose");
    } catch (const std::exception&) {
      throw InputError({file, "pieces", json_text(records[n]).substr(0, 80),
                        "name, turn (a unit quaternion) and shift of a piece with elements"});
    }
    piece.elements = std::make_shared<SlotSet>(std::move(slots[n]));
    piece.centre_index = centre_of(elements, *piece.elements);
    pieces.push_back(std::move(piece));
  }
  return numbered(std::move(pieces), elements);
}

}  // namespace supple
