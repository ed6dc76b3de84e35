// Leaves of an OpenVDB grid decoded on all threads. A stream holds them one after another, each
// compressed by itself, so that their places are found by passing over them.
#pragma once

#include <cstdint>
#include <istream>
#include <streambuf>
#include <vector>

#include "volumes/grid/density_grid_vdb.h"
#include "volumes/io/bytes/input_file.h"

namespace supple {

/// A file that several streams read, each at a place of its own. Seeking costs nothing within what
/// is buffered.
class FileBuffer : public std::streambuf {
 public:
  explicit FileBuffer(const InputFile& file, std::int64_t place = 0);

 protected:
  int_type underflow() override;
  pos_type seekoff(off_type offset, std::ios::seekdir from, std::ios::openmode which) override;
  pos_type seekpos(pos_type place, std::ios::openmode which) override;

 private:
  const InputFile& m_file;
  std::int64_t m_end;  // place in the file of egptr()
  std::vector<char> m_bytes;
};

/// Reads leaves, in place of grid.readBuffers(in), of a grid whose topology was read from `in`, a
/// stream of the newest format over `file`. False, and nothing is read, for types of grids that
/// Supple does not write large. Throws what the first leaf that fails does.
bool read_leaf_ranges(openvdb::GridBase& grid, std::istream& in, const InputFile& file);

}  // namespace supple
