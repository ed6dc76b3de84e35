// Ctrl-C, SIGTERM and SIGHUP: a flag that long operations look at. Where none looks in time, inside
// a factorisation of a library for instance, the process ends without unwinding, and removes the
// files that it had begun to write.
#pragma once

#include <vector>

#include <sys/types.h>

#include "volumes/base/files.h"

namespace supple {

/// Installs the handlers; a second signal ends the process at once.
void install_signal_handlers();
/// The signal that asked to stop, or 0.
int pending_signal();
/// Adds files and empty folders that are removed when a signal ends the process, in the order of
/// their making. Called from one thread.
void remove_at_signal(const std::vector<Remains>& remains);
/// Forgets all files and folders that were added.
void keep_at_signal();
/// Adds a process of ours that writes such a file, which is ended before files are removed: it
/// could make its file anew. Called from any thread.
void end_at_signal(pid_t process);
/// Forgets the process, once it has ended and before its number is free for others.
void spare_at_signal(pid_t process);
/// Ends as the pending signal would have ended the process, so that shells see the interruption.
int end_by_signal();

}  // namespace supple
