// Stands in for load_module.cpp where the module's sources are linked in: in fuzz targets, which
// count what they reach in their own code.
#include "volumes/hdf5/hdf5_module.h"

extern "C" const supple::Hdf5Module supple_hdf5_module;

namespace supple {

const Hdf5Module& hdf5_module() {
  return supple_hdf5_module;
}

}  // namespace supple
