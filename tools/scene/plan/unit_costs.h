// Costs of units of work on this machine: measured by `supple bench --calibrate` and kept for the
// user, or as shipped. Times are of all threads that a run has, so that a plan is for the threads
// with which it was calibrated.
#pragma once

#include <map>
#include <string>

#include "volumes/base/fields.h"
#include "volumes/base/unit_cost.h"

namespace supple::tools {

/// Nanoseconds of each unit; as its owner says where nothing was measured.
class UnitCosts {
 public:
  double operator[](const UnitCost& unit) const;
  void set(const UnitCost& unit, double ns) { m_ns[unit.name] = ns; }
  /// Keys of a calibration, in the order of its file.
  Fields fields();

  std::string measured;  // when and where; empty: as shipped

 private:
  std::map<std::string, double> m_ns;
};

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
