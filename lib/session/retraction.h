// Opening a cut: both lips are pushed apart, most in the middle of the incision and at the skin.
#pragma once

#include <string>
#include <vector>

#include "lib/chainmail/drag.h"
#include "lib/session/step.h"
#include "volumes/base/fields.h"
#include "volumes/base/value.h"

namespace supple {

Fields fields(Retraction& retraction);

/// The lips as pushing handles, which finite elements hold where they are drawn; first the one on
/// the side of edge1 x edge2: elements at rest within `width` of the patch go half of `by` away
/// from it, times 4 s (1 - s) along edge1 and t / t_skin along edge2, t_skin being the largest t of
/// any of them. Elements that are `taken` stay. Throws InputError where a side has no element.
std::vector<Handle> handles_of(const Retraction& retraction, const Body& body,
                               const SlotSet& taken);

/// Returns the retraction as a journal records it.
Value settings_value(const Retraction& retraction);

}  // namespace supple
