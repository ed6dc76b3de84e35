// Meaning of the datasets of an HDF5 file, by the conventions of the programs that write them.
#pragma once

#include "volumes/io/hdf5/plugin/hdf5_slices.h"

namespace supple::hdf5 {

/// A volume inside a file.
struct Layout {
  Dataset dataset;
  SliceSelection selection;
  VolumeHeader header;  // geometry, type, components, warnings
};

/// True for a group laid out as ITK's HDF5ImageIO does: Dimension, Directions (row a: the unit
/// vector of axis a in LPS), Origin, Spacing, VoxelData with the axes reversed and the components
/// last.
bool is_itk_image(const Hdf5File& file, const std::string& group);
/// Two to four dimensions, the fourth one as frames.
Layout itk_image(const Hdf5File& file, const std::string& group, const ReadOptions& options);

/// The default data of the NeXus entries: NXentry / NXdata / `signal` or `data`.
struct NexusData {
  std::string dataset, group, entry;
};
std::vector<NexusData> nexus_data(const Hdf5File& file);
/// NXtomo and other NeXus data of 2 to 4 axes: x_pixel_size, y_pixel_size and z_pixel_size with
/// their `units`, beside the data or in a detector.
Layout nexus_volume(const Hdf5File& file, const NexusData& data, const ReadOptions& options);

/// A dataset of 2 to 4 axes, the last one i, a fourth one first: frames. Voxel sizes from
/// attributes in the order of the axes: `element_size_um`; `spacing`, `voxel_size` in mm or in
/// their `units`; `resolution` only with `units`. One number is for all axes. Axes along L, P, S.
Layout plain_volume(const Hdf5File& file, const std::string& path, const ReadOptions& options);

/// Every dataset of numbers of this rank, each once.
std::vector<std::string> numeric_datasets(const Hdf5File& file, int rank);

}  // namespace supple::hdf5
