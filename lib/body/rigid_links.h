// Links of a body that rigid pieces hide or cut, and parts that links connect.
#pragma once

#include <functional>
#include <vector>

#include "lib/body/body.h"

namespace supple {

/// Links that solvers must not see: `cuts`, and every link between two elements of pieces.
LinkCuts cuts_with_pieces(const Body& body, const LinkCuts& cuts);

/// Cuts the links between two different pieces. Returns how many of them were not cut before.
std::int64_t cut_joints(const Body& body, LinkCuts& cuts);

/// Parts tissue halfway between pieces that are nearer to each other than `gap_mm` by way of links:
/// a joint's space. `is_joint` says between which two pieces. Returns the links cut.
std::int64_t cut_joint_spaces(const Body& body, LinkCuts& cuts, double gap_mm,
                              const std::function<bool(std::size_t, std::size_t)>& is_joint);

/// Links inside each piece that are cut.
std::vector<std::int64_t> cut_links_inside(const Body& body, const LinkCuts& cuts);

/// The parts of a set that uncut axis links connect, in the order of their first elements. About
/// 0.5 us per element.
std::vector<SlotSet> connected_parts(const BrickTopology& elements, const LinkCuts& cuts,
                                     const SlotSet& set);

/// The parts of a set that belong to each seed, flooded from the seeds through axis links inside
/// the set, densest elements first (Meyer's watershed, 1991, in floating point): parts meet where
/// bone is thinnest between them. Of equally dense elements the one nearest to denser ones, in mm,
/// goes first, then that of the earlier seed. Elements that no way reaches belong to no part. Seeds
/// are elements of the set. About 1 us per element.
std::vector<SlotSet> flooded_parts(const Body& body, const DensityGrid& density,
                                   const LinkCuts& cuts, const SlotSet& set,
                                   const std::vector<Slot>& seeds);

/// The pieces under numbers in their order; those without element are dropped.
RigidPieces numbered(std::vector<RigidPiece> pieces, const BrickTopology& elements);

}  // namespace supple
