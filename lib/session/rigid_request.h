// Choice of the elements of a body that a step makes rigid pieces, and the pieces of a state.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lib/body/body.h"
#include "lib/session/handles/selection.h"
#include "lib/session/step.h"
#include "volumes/base/progress.h"
#include "volumes/base/value.h"

namespace supple {

/// Connected parts of fewer elements than this stay tissue: specks of noise.
constexpr std::size_t kLeastPiece = 8;

/// Makes pieces, in the order of RigidRequest, and cuts the links between them in `cuts`, which are
/// those of the body without the links that its pieces hide. New pieces of elements that have moved
/// take the pose nearest to where they are. Throws InputError, the body unchanged: a part without
/// element, a seed that is in no piece. Returns the links that it cut.
std::int64_t make_pieces(Body& body, LinkCuts& cuts, const RigidRequest& request,
                         const DensityGrid& density, const BrickValues& labels, Progress* progress);

/// Parts the pieces that cuts have gone through since `inside_before` (cut_links_inside) was
/// counted: each connected part is a piece, of the same pose.
void part_pieces(Body& body, const LinkCuts& cuts, const std::vector<std::int64_t>& inside_before);

/// Shifts of poses, as far as the solver has shifted their elements.
void follow_shifts(Body& body);

/// Returns the request as a journal records it.
Value settings_value(const RigidRequest& request);

/// Pieces as a state keeps them, and back. Throws InputError naming `file`.
std::vector<Value> records_of(const RigidPieces& pieces);
RigidPieces pieces_of(const std::vector<Value>& records, const BrickValues& numbers,
                      const BrickTopology& elements, const std::string& file);

}  // namespace supple
