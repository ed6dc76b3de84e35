// Other programs and copies of this one: how they are started, what they say, how they ended, and
// within which time and memory.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <sys/types.h>

#include "volumes/base/error.h"

namespace supple {

/// The file of the program that is running.
std::string own_program();
/// The program of that name in its folder; empty where there is none.
std::string program_beside(const std::string& name);
/// Returns that program; throws SystemError where there is none.
std::string require_program_beside(const std::string& name);
/// Starts the program in place of this one, as the same process, with arguments that begin with
/// its name. Throws SystemError where it cannot be started.
[[noreturn]] void become_program(const std::string& program,
                                 const std::vector<std::string>& arguments);

/// A program as it is started.
struct ProgramStart {
  static constexpr int kAsOurs = -1, kNowhere = -2;  // streams: this process's, /dev/null

  /// Its words begin with the program, which is looked for on the PATH unless its name has a slash.
  std::vector<std::string> words;
  std::string folder;                              // where it runs; empty: the present one
  std::vector<std::string> environment;            // NAME=VALUE, beside that of this process
  int in = kAsOurs, out = kAsOurs, err = kAsOurs;  // or a file descriptor
  bool ends_with_us = false;                       // killed when the thread that starts it ends
  bool is_apart = false;  // signals that are meant for this process's group do not reach it
};

/// Starts a program; sets errno and returns -1 where it cannot be started.
pid_t start_program(const ProgramStart& start);
/// Waits until the process has ended; returns its status as waitpid() tells it.
int wait_for_end(pid_t process);

/// A program that takes more is ended. Its memory is looked at every 50 ms.
struct ProgramLimits {
  double wall_s = std::numeric_limits<double>::infinity();
  double resident_mb = std::numeric_limits<double>::infinity();  // millions of bytes
};

struct ProgramEnd {
  int exit_code = -1;        // -1: ended by a signal
  int signal = 0;            // that one
  bool timed_out = false;    // it was ended when its time was over
  bool over_memory = false;  // it was ended when it held more than its limit
  std::string out, err;      // stdout and stderr
  double wall_s = 0;         // from its start to its end
  double peak_mb = 0;        // the largest resident size that was seen, in millions of bytes
};

/// Exit code of a program that is not there or cannot be started, as a shell has it.
constexpr int kNoSuchProgram = 127;

/// Runs a program, which is looked for on the PATH unless its name has a slash, in `folder` (empty:
/// the present one) until it ends, or ends it at its limits, or when `cancelled` says so, which is
/// asked every 50 ms; throws Cancelled then, when the program has removed its files or half a
/// second has passed. It never outlives this process. Throws SystemError where no process can be
/// started.
ProgramEnd run_program(const std::string& program, const std::vector<std::string>& arguments,
                       const std::string& folder, const ProgramLimits& limits,
                       const std::function<bool()>& cancelled);

/// The end of another run of this program.
struct ChildEnd : ProgramEnd {
  /// The last error on stderr, without "supple: error: "; where there is none the report of a
  /// sanitizer, or the last line.
  std::string complaint;
  std::string warnings;  // all lines of warnings, likewise, joined by "; "
};

/// Calls run_program() in a folder (empty: the present one) and reads the complaints of a program
/// like this one.
ChildEnd run_child(const std::string& program, const std::vector<std::string>& arguments,
                   const ProgramLimits& limits, const std::function<bool()>& cancelled,
                   const std::string& folder = "");

struct ChildBounds {
  std::int64_t bytes;     // memory beyond that of the process
  int processor_seconds;  // of the trial
  int seconds = 120;      // and by the clock
};

/// Allows run_in_child() to start processes. Off at first, since a host program with threads or a
/// display of its own may not be copied; a program that opens files of strangers switches it on
/// before it opens the first, as the command line does.
void allow_child_processes(bool allowed);

/// Tries a third-party parser that crashes on damaged files (HDF5's) where it does no harm: runs
/// `parse` in a copy of this process, without effect on the caller but for the file. Does nothing
/// unless child processes are allowed. Throws the InputError that `parse` throws there; and an
/// InputError, with file, field and expectation of `about`, where it ended by a signal, or reached
/// the bounds. Returns when it ended well or by another exception, which the caller meets on
/// repeating it, and where no process can be started. `parse` has one thread, also where it runs
/// loops of oneTBB, as trees of OpenVDB do when they are destroyed. Cost: a few milliseconds.
void run_in_child(const Problem& about, const ChildBounds& bounds,
                  const std::function<void()>& parse);

}  // namespace supple
