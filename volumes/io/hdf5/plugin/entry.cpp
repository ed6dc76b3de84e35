// The plugin's only exported symbol (hdf5_plugin.h).
#include "volumes/io/hdf5/hdf5_plugin.h"
#include "volumes/io/hdf5/plugin/hdf5_volume.h"
#include "volumes/io/hdf5/plugin/hdf5_writer.h"

extern "C" __attribute__((visibility("default"))) const supple::Hdf5Plugin supple_hdf5_plugin;

const supple::Hdf5Plugin supple_hdf5_plugin = {supple::Hdf5Plugin::kSizes, supple::hdf5::open_file,
                                               supple::hdf5::create_file};
