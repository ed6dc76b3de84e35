// How far a deformed body is from the reference: distances of its elements in mm, over those that
// the reference moves; change of volume, and energy in the springs of the links.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "lib/material/material.h"
#include "lib/state/state.h"
#include "volumes/base/progress.h"

namespace supple::tools {

struct ErrorNorms {
  std::int64_t moved = 0;  // elements that are looked at
  double p50_mm = 0, p95_mm = 0, max_mm = 0;
  double volume_percent = 0;
  double energy_uj = 0;
};

/// Elements whose reference moves by less than this part of the largest move do not count: most of
/// a body hardly moves, and would hide the error where it does.
constexpr double kMovedPart = 0.01;

class ErrorReference {
 public:
  /// Reads a state. Throws InputError as read_state.
  ErrorReference(const std::string& state_path, Progress* progress);

  /// Error of another state of the same body. The largest distance is that of all elements, moved
  /// or not. `distances_mm`: gets that of each element, in the order of the bricks. Throws
  /// InputError as read_state, and for another grid or other elements.
  ErrorNorms norms_of(const std::string& state_path, Progress* progress,
                      std::vector<float>* distances_mm = nullptr) const;

  const State& state() const { return m_state; }

  /// Steps in which a state stores places: no error below half of it is seen.
  double resolution_mm() const;

 private:
  State m_state;
  MaterialTable m_material;
  double m_least_mm;  // moves that count
};

}  // namespace supple::tools
