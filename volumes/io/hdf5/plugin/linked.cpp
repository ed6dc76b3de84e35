// Stands in for hdf5_plugin.cpp where the plugin's sources are linked in: in fuzz targets, which
// count what they reach in their own code.
#include "volumes/io/hdf5/hdf5_plugin.h"

extern "C" const supple::Hdf5Plugin supple_hdf5_plugin;

namespace supple {

const Hdf5Plugin& hdf5_plugin() {
  return supple_hdf5_plugin;
}

}  // namespace supple
