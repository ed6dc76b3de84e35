#include "lib/relax/plastic_flow.h"

#include <cstdlib>

#include "lib/body/slot_set.h"
#include "lib/relax/link_table.h"

namespace supple {

namespace {

std::int64_t let_flow_along(Body& body, std::size_t c) {
  const LinkTable table(body, int(c), RigidLinks::absent);
  const BrickValues& q = body.q[c];
  std::int64_t yielded = 0;
  for (std::size_t b = 0; b < body.elements.brick_count(); ++b) {
    for_each_link(body.elements, body.cuts, b, [&](int axis, Slot low, Slot high) {
      BrickValues& rest = body.rest[std::size_t(axis)][c];
      const std::int64_t stretch = std::int64_t(q.at(high)) - q.at(low) - rest.at(low);
      const float yield = table.values(axis, body.classes[low], body.classes[high]).yield;
      if (float(std::abs(stretch)) <= yield) return;
      const std::int32_t kept = std::int32_t(yield);
      if (rest.brick_count() == 0) rest.resize(body.elements.brick_count());
      rest.set(low, std::int32_t(rest.at(low) + stretch - (stretch > 0 ? kept : -kept)));
      ++yielded;
    });
  }
  return yielded;
}

}  // namespace

std::int64_t let_flow(Body& body) {
  std::int64_t yielded = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    if (!body.q[c].empty()) yielded += let_flow_along(body, c);
  }
  return yielded;
}

}  // namespace supple
