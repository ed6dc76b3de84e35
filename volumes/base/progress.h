// Cancel and progress hook that long operations accept; null means silent and not cancellable.
#pragma once

#include <string_view>

#include "volumes/base/error.h"

namespace supple {

class Progress {
 public:
  virtual ~Progress() = default;
  /// Enters a named stage, e.g. "reading"; fractions below belong to it.
  virtual void stage(std::string_view name) = 0;
  /// Part of the stage that is done, 0…1; called from one thread at a time.
  virtual void update(double fraction) = 0;
  /// True once the user asked to stop; may be polled from any thread.
  virtual bool cancelled() const = 0;
};

/// Throws Cancelled when the user asked to stop; reports the fraction otherwise.
inline void report(Progress* progress, double fraction) {
  if (progress == nullptr) return;
  if (progress->cancelled()) throw Cancelled();
  progress->update(fraction);
}

}  // namespace supple
