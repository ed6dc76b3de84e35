// Cuts of a body between labels, and a mesh whose regions are these labels parted there.
#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>

#include "lib/body/body.h"
#include "volumes/io/solid/solid_mesh.h"

namespace supple {

/// Pairs of labels, the smaller one first, some of whose links are cut. Throws InputError, field
/// "cut", for a link that is cut within a label.
std::set<std::pair<std::int32_t, std::int32_t>> parted_labels(const Body& body,
                                                              const BrickValues& labels);

/// Gives nodes on these sets of faces, borders of two regions, copies: one for each set of elements
/// around a node that hang together by faces that stay. The borders are no sets any more; all other
/// sets have the nodes of the elements that they are faces of. `names`: of regions, for sets.
void part_mesh(const std::set<std::string>& borders,
               const std::map<std::int32_t, std::string>& names, SolidMesh& mesh);

}  // namespace supple
