// A numeric HDF5 dataset, slice by slice. Memory: one layer of chunks or 256 MiB of slices,
// whichever is less, but always a slice (at most 2 GiB), and one chunk (at most 2 GiB).
// Cost: chunks deeper than those slices are decoded again for every run of slices.
#pragma once

#include <memory>

#include "volumes/io/hdf5/plugin/hdf5_file.h"

namespace supple::hdf5 {

/// Values of a dataset that make up the slices.
struct SliceSelection {
  std::vector<hsize_t> start, count;  // of all slices, per axis of the dataset
  int axis = 0;                       // slices follow each other along this axis ...
  hsize_t step = 1;                   // ... so many elements apart
  int slices = 1;
};

class SliceReader {
 public:
  /// Checks the claims before anything is allocated: more than 4 GiB of values need at least one
  /// byte in the file for every 4096. Throws InputError.
  SliceReader(std::shared_ptr<const Hdf5File> file, Dataset dataset, ValueType type,
              SliceSelection selection);
  /// Reads the next slice in native byte order.
  void read(void* out);

 private:
  void read_slices(int first, int count, void* out) const;

  std::shared_ptr<const Hdf5File> m_file;
  Dataset m_dataset;
  hid_t m_type;
  SliceSelection m_selection;
  std::size_t m_slice_bytes = 0;
  int m_slices_per_run = 1;
  int m_slices_read = 0;
  std::vector<char> m_run;
};

}  // namespace supple::hdf5
