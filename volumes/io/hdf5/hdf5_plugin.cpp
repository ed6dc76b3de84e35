// Loads the plugin that reads and writes HDF5. Cost: about 7 ms and 7 MB, once, when the first HDF5
// file is met.
#include "volumes/io/hdf5/hdf5_plugin.h"

namespace supple {

const Hdf5Plugin& hdf5_plugin() {
  static const Hdf5Plugin& plugin = plugin_entry<Hdf5Plugin>();
  return plugin;
}

}  // namespace supple
