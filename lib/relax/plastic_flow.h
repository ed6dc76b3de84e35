// Plastic flow: where a link is stretched further than it yields, its rest stretch follows, so that
// a body that is let go keeps a permanent set (thesis section 4.2.3: a link length range which
// corresponds to minimal energy).
//
// A relaxation is one load step of rate-independent, perfectly plastic springs: while it runs, a
// spring beyond its yield stretch pulls no more than there, which is the energy that is stored and
// dissipated; then the rest stretch takes up the part beyond.
#pragma once

#include <cstdint>

#include "lib/body/body.h"

namespace supple {

/// Lets the rest stretch of every link of the body follow its present stretch; returns how many
/// links did, counted per coordinate. O(links), only for a material that yields.
std::int64_t let_flow(Body& body);

}  // namespace supple
