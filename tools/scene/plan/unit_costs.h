// Costs of units of work on this machine: measured by `supple bench --calibrate` and kept for the
// user, or as shipped. Times are of all threads that a run has, so that a plan is for the threads
// with which it was calibrated.
#pragma once

#include <string>

#include "volumes/base/fields.h"

namespace supple::tools {

/// Nanoseconds, where nothing else is said. The defaults are those of two shared cores (AMD EPYC,
/// AVX-512), as docs/benchmarks.md has them.
struct UnitCosts {
  double read_voxel = 6;              // of the file's box: read, compared, put into bricks
  double body_element = 25;           // its class, and the check of its links
  double ecm_element = 20;            // moved, per coordinate
  double relax_element = 9;           // per pass and coordinate
  double volume_element = 45;         // per pass, where cells keep their volume
  double spring = 750;                // per step, of the first two to a minimum
  double fem_unknown = 60;            // per iteration, of fem_work
  double displacement_voxel = 12;     // of the bricks that move, extension included
  double invert_voxel = 55;           // of the bricks that move, certificate included
  double source_brick = 250;          // sampling bricks of a picture
  double ray = 900;                   // set up, shaded and stored, per pixel
  double sample = 35;                 // read, classified, composited
  double still_brick = 570;           // of a body at rest, in all passes over its bricks
  double warp_voxel = 15;             // of a dense warp, made and written
  double state_brick = 14000;         // compressed and written
  double state_vector_brick = 50000;  // offsets of a state, likewise

  std::string measured;  // when and where; empty: as shipped
};
Fields fields(UnitCosts& costs);

/// Work of an equilibrium in unknowns times iterations: setting up the levels is as much as 5
/// iterations more, and every iteration takes what 18,000 unknowns more do.
double fem_work(double unknowns, double iterations);

/// $XDG_CACHE_HOME/supple/calibration.toml, or that below ~/.cache; empty where neither is known.
std::string calibration_file();

/// Reads costs from the file; as shipped where there is none. Throws InputError for a file that is
/// no calibration.
UnitCosts read_costs(const std::string& path);
/// Replaces the file as a whole. Throws SystemError.
void write_costs(const std::string& path, const UnitCosts& costs);

/// "as shipped (supple bench --calibrate measures this machine)", or when they were measured.
std::string origin_of(const UnitCosts& costs);

}  // namespace supple::tools
