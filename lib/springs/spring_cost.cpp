#include "lib/springs/spring_cost.h"

#include <algorithm>

namespace supple {

namespace {

/// Times per spring in steps of the calibration: setup, a step to a minimum, and a step of time;
/// the last is the factor where shapes press.
constexpr double kSpringStart = 0.35, kDownWork = 0.2, kMotionWork = 1.35, kContactWork = 5;
constexpr int kMinimumSteps = 40;  // that a minimum of springs takes, of those that it may

}  // namespace

SpringWork spring_work(double elements, bool is_slice, const SpringWish& wish) {
  const double steps = wish.is_motion ? wish.most_steps : std::min(wish.most_steps, kMinimumSteps);
  const double springs = elements * (is_slice ? kSpringsInSlice : kSpringsOfElement);
  const double bytes = is_slice          ? kSpringBytesInSlice
                       : wish.has_matrix ? kSpringBytes + kSpringMatrixBytes
                                         : kSpringBytes;
  const double work =
      wish.is_motion ? kMotionWork * (wish.has_contact ? kContactWork : 1) : kDownWork;
  return {springs, steps, elements * bytes, springs * (kSpringStart + steps * work)};
}

}  // namespace supple
