// Ctrl-C, SIGTERM and SIGHUP: a flag that long operations look at. Where none looks in time, inside
// a factorisation of a library for instance, the process ends without unwinding, and removes the
// files that it had begun to write.
#pragma once

#include <vector>

#include "volumes/base/reserved_names.h"

namespace supple::tools {

/// Installs the handlers; a second signal ends the process at once.
void install_signal_handlers();
/// The signal that asked to stop, or 0.
int pending_signal();
/// Adds files and empty folders that are removed when a signal ends the process, in the order of
/// their making. From one thread.
void remove_at_signal(const std::vector<Remains>& remains);
/// Forgets them all.
void keep_at_signal();
/// Ends as the pending signal would have ended the process, so that shells see the interruption.
int end_by_signal();

}  // namespace supple::tools
