// Memory and work of springs on a voxel body, for plans.
#pragma once

#include "volumes/base/unit_cost.h"

namespace supple {

constexpr UnitCost kSpringCost = {"spring", 750,
                                  "A spring, per step of the first two to a minimum"};

/// Bytes per element: of the springs with their cells, and of their matrix beside them; of both in
/// one slice. tests/lib/test_model_costs.cpp compares them with what a model takes.
constexpr double kSpringBytes = 670, kSpringMatrixBytes = 410, kSpringBytesInSlice = 456;
/// Springs per element, in a head and in one slice.
constexpr double kSpringsOfElement = 8.7, kSpringsInSlice = 4;

struct SpringWish {
  bool is_motion = false, has_matrix = false, has_contact = false;
  int most_steps = 1;  // that a motion takes, or a minimum may take
};

struct SpringWork {
  double springs = 0, steps = 0;
  double bytes = 0;
  double spring_steps = 0;  // of kSpringCost
};

SpringWork spring_work(double elements, bool is_slice, const SpringWish& wish);

}  // namespace supple
