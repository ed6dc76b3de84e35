// Runs the `supple` program as a user does, and makes small inputs for it.
#pragma once

#include <csignal>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.h"

namespace supple::test {

struct Outcome {
  int exit_code = -1;  // 128 + signal when a signal ended the program
  std::string out, err;
  int threads = 0;  // the most at a time, with count_threads
};

struct RunOptions {
  std::string directory;            // working directory, empty: the present one
  long long max_file_bytes = -1;    // RLIMIT_FSIZE, stands in for a full disk
  bool as_nobody = false;           // drops root, for whom no folder is read-only
  std::string interrupt_at_file{};  // sends a signal as soon as this file is there
  double interrupt_after_s = -1;    // so long after that, or after the start where none is named
  int interrupt_by = SIGINT;
  bool count_threads = false;  // looks every millisecond
};

/// Runs build/…/bin/supple (environment SUPPLE_BINARY) with these arguments.
Outcome run_supple(const std::vector<std::string>& arguments, const RunOptions& options = {});
/// Any program; the first argument is its path.
Outcome run_program(const std::vector<std::string>& arguments, const RunOptions& options = {});
/// A command of the shell, its output thrown away; whether it succeeds.
bool runs(const std::string& command);
/// The same of the system's Python, whose errors are shown.
bool runs_python(const std::string& arguments);

/// A ball of uint8 densities in void, size^3 voxels, spacing 1 x 1 x 1.5 mm, as .nhdr + .raw.
void write_ball(const TemporaryFolder& folder, const std::string& name, int size);
/// A soft material for it, densities 1 to 255 active.
void write_soft_material(const std::string& path);

std::string source_dir();
/// Digest of the values of the head CT, whose place a phantom takes offline.
constexpr const char* kHeadCtSha256 =
    "d87fd5e6aaf2c4fdf4f3fe28ee3335192fc2464ed8e9682fc78530cb837938da";
/// A public volume: in build/data, or of Debian's package mricron-data; "" where it is in neither.
std::string public_volume(const std::string& name);

}  // namespace supple::test
