// Motions that an augmentation draws, one row each: what is held and moved, as a step of a scene.
#pragma once

#include <deque>
#include <functional>
#include <string>
#include <vector>

#include "lib/session/session.h"
#include "volumes/base/fields.h"
#include "volumes/base/random.h"

namespace supple::tools {

/// How far motions go at most.
struct DrawnLimits {
  int handles = 3;
  double reach_mm = 10, radius_mm = 10, turn_deg = 10;
};
Fields fields(DrawnLimits& limits);

/// A body to draw motions for, with what is found once for all of them.
struct DrawnBody {
  explicit DrawnBody(const Session& of);

  const Session& session;
  std::vector<Slot> free;  // elements that nothing holds and that are not rigid
};

/// The keys of a step that goes a part of the way, 0 to 1, that was drawn.
using DrawnMotion = std::function<Value(double part)>;

struct RandomMotion {
  std::string name, help;
  std::function<DrawnMotion(const DrawnBody&, const DrawnLimits&, RandomNumbers&)> draw;
};

/// All of them, that of handles in soft tissue first. Their draws throw InputError for bodies in
/// which nothing can move so.
const std::deque<RandomMotion>& random_motions();

}  // namespace supple::tools
