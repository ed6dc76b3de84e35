// The module's only exported symbol (hdf5_module.h).
#include "volumes/hdf5/hdf5_module.h"
#include "volumes/hdf5/hdf5_volume.h"
#include "volumes/hdf5/hdf5_writer.h"

extern "C" __attribute__((visibility("default"))) const supple::Hdf5Module supple_hdf5_module;

const supple::Hdf5Module supple_hdf5_module = {supple::Hdf5Module::kSizes, supple::hdf5::open_file,
                                               supple::hdf5::create_file};
