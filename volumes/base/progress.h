// The hook that long operations accept for progress, messages and cancelling; null means silent and
// not cancellable.
#pragma once

#include <string>
#include <string_view>
#include <vector>

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

  /// A warning about a result that is still valid; a line without a full stop.
  virtual void warn(const std::string& line) { static_cast<void>(line); }
  /// Information for the user, and details that help to find faults.
  virtual void note(const std::string& line) { static_cast<void>(line); }
  virtual void debug(const std::string& line) { static_cast<void>(line); }

  /// Warnings and notes from now on are of one of many, such as "frame" 3: a kind is told once,
  /// with its number.
  virtual void enter(const std::string& what, int number) {
    static_cast<void>(what), static_cast<void>(number);
  }
  /// Says which kinds came again, and ends the numbering.
  virtual void tell_repeats() {}
};

inline void stage(Progress* progress, std::string_view name) {
  if (progress != nullptr) progress->stage(name);
}
inline void warn(Progress* progress, const std::string& line) {
  if (progress != nullptr) progress->warn(line);
}
inline void note(Progress* progress, const std::string& line) {
  if (progress != nullptr) progress->note(line);
}
inline void debug(Progress* progress, const std::string& line) {
  if (progress != nullptr) progress->debug(line);
}

/// Throws Cancelled when the user asked to stop.
inline void poll(const Progress* progress) {
  if (progress != nullptr && progress->cancelled()) throw Cancelled();
}

/// Throws Cancelled when the user asked to stop; reports the fraction otherwise.
inline void report(Progress* progress, double fraction) {
  poll(progress);
  if (progress != nullptr) progress->update(fraction);
}

/// Findings of a reader, or losses of a writer, as warnings that name the file.
inline void warn_of_all(const std::string& path, const std::vector<std::string>& lines,
                        Progress* progress) {
  for (const std::string& line : lines) warn(progress, path + ": " + line);
}

}  // namespace supple
