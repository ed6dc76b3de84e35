// Third-party parsers that crash on damaged files (HDF5's), tried where it does no harm.
#pragma once

#include <cstdint>
#include <functional>

#include "volumes/base/error.h"

namespace supple {

struct ChildBounds {
  std::int64_t bytes;     // memory beyond that of the process
  int processor_seconds;  // of the trial
  int seconds = 120;      // and by the clock
};

/// Allows run_in_child() to start processes. Off at first, since a host program with threads or a
/// display of its own may not be copied; a program that opens files of strangers switches it on
/// before it opens the first, as the command line does.
void allow_child_processes(bool allowed);

/// Does nothing unless child processes are allowed. Runs `parse` in a child process, a copy of this
/// one, without effect on the caller but for the file. Throws the InputError that `parse` throws
/// there; and an InputError, with file, field and expectation of `about`, where it ended by a
/// signal, or reached the bounds. Returns when it ended well or by another exception, which the
/// caller meets on repeating it, and where no process can be started. `parse` has one thread, also
/// where it runs loops of oneTBB, as trees of OpenVDB do when they are destroyed. Cost: a few
/// milliseconds.
void run_in_child(const Problem& about, const ChildBounds& bounds,
                  const std::function<void()>& parse);

}  // namespace supple
