// Loads the module that reads and writes HDF5. Cost: about 7 ms and 7 MB, once, when the first HDF5
// file is met.
#include "volumes/hdf5/hdf5_module.h"

namespace supple {

const Hdf5Module& hdf5_module() {
  static const Hdf5Module& module = module_entry<Hdf5Module>();
  return module;
}

}  // namespace supple
