// HDF5 as the rest of the house sees it (formats.h, dense_writer.h): what can be said of a file
// without the library, and the calls into the plugin, which hold the library to its bounds.
#include <filesystem>
#include <vector>

#include "volumes/base/process.h"
#include "volumes/io/bytes/byte_source.h"
#include "volumes/io/format/formats.h"
#include "volumes/io/hdf5/hdf5_plugin.h"

namespace supple {

std::string file_part(const std::string& path) {
  std::error_code ignored;
  const std::size_t at = path.rfind(":/");
  if (at == std::string::npos || at == 0 || std::filesystem::exists(path, ignored)) return path;
  const std::string file = path.substr(0, at);
  const std::filesystem::file_status status = std::filesystem::status(file, ignored);
  const bool is_file = std::filesystem::exists(status) && !std::filesystem::is_directory(status);
  return is_file ? file : path;
}

namespace {

// Volumes of at most so many bytes and slices are tried whole, of others all that describes the
// values.
constexpr std::int64_t kTriedBytes = std::int64_t(64) << 20;
constexpr int kTriedSlices = 4096;

void read_small(VolumeFile& file) {
  const VolumeHeader& header = file.header();
  if (stored_bytes(header) > kTriedBytes || header.geometry.dims().z > kTriedSlices) return;
  const Vec3i& dims = header.geometry.dims();
  std::vector<char> slice(std::size_t(stored_bytes(header) / dims.z));
  for (int k = 0; k < dims.z; ++k) file.read_slice(slice.data());
}

}  // namespace

std::unique_ptr<VolumeFile> open_hdf5(const std::string& path, const ReadOptions& options) {
  const std::string name = file_part(path);
  // In a damaged file the library reads through null pointers and behind the ends of chunks, or
  // follows a circle of free blocks and keeps each of them. What describes the values is smaller
  // than the file.
  const ChildBounds bounds{4 * (kTriedBytes + InputFile(name).size()), 8};
  const Hdf5Plugin& plugin = hdf5_plugin();
  run_in_child({path, "HDF5 structure", "", "an intact HDF5 file"}, bounds,
               [&] { read_small(*plugin.open(name, path, options)); });
  return plugin.open(name, path, options);
}

std::unique_ptr<DenseWriter> create_hdf5(const std::string& path, const std::string&,
                                         const DenseImage& image, const WriteOptions& options) {
  require_perpendicular(image, path, "HDF5");
  return hdf5_plugin().create(path, image, options);
}

}  // namespace supple
