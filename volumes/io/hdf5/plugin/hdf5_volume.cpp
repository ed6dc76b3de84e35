// HDF5 volumes: `file.h5:/path` names a dataset; without a path the layouts of ITK images, ITK
// transforms and NeXus are recognised, or the only dataset of three axes is taken. Memory: as
// hdf5_slices.h. Everything outside the file is refused, see hdf5_file.h.
#include "volumes/io/hdf5/plugin/hdf5_volume.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include "volumes/io/bytes/text_header.h"
#include "volumes/io/hdf5/plugin/hdf5_layouts.h"
#include "volumes/io/hdf5/plugin/itk_transform.h"

namespace supple {

namespace {

using namespace hdf5;

class Hdf5Volume : public VolumeFile {
 public:
  Hdf5Volume(std::shared_ptr<const Hdf5File> file, Layout layout)
      : m_slices(file, std::move(layout.dataset), layout.header.type, std::move(layout.selection)) {
    m_header = std::move(layout.header);
    m_header.path = file->shown();
    m_header.format = "hdf5";
  }
  void read_slice(void* out) override { m_slices.read(out); }

 private:
  SliceReader m_slices;
};

/// "/a, /b and 3 more".
std::string listed(const std::vector<std::string>& paths) {
  constexpr std::size_t kShown = 5;
  std::string text;
  for (std::size_t n = 0; n < std::min(paths.size(), kShown); ++n) {
    text += (n == 0 ? "" : ", ") + printable(paths[n]);
  }
  if (paths.size() > kShown) text += " and " + std::to_string(paths.size() - kShown) + " more";
  return text;
}

[[noreturn]] void fail_several(const Hdf5File& file, const std::vector<std::string>& paths) {
  file.fail("datasets", std::to_string(paths.size()) + ": " + listed(paths),
            "one of them named as FILE:/path");
}

/// The only dataset of three axes; without one the only one of four, then of two.
std::string only_dataset(const Hdf5File& file) {
  for (const int rank : {3, 4, 2}) {
    const std::vector<std::string> paths = numeric_datasets(file, rank);
    if (paths.size() > 1) fail_several(file, paths);
    if (paths.size() == 1) return paths[0];
  }
  file.fail("datasets", "no numbers in 2 to 4 axes", "a volume in the file itself");
}

Layout found_layout(const Hdf5File& file, const ReadOptions& options) {
  if (is_itk_image(file, "/ITKImage/0")) return itk_image(file, "/ITKImage/0", options);
  if (file.has("/minc-2.0")) {
    file.fail("format", "MINC 2", "NIfTI or NRRD (mnc2nii), or a dataset named as FILE:/path");
  }
  const std::vector<NexusData> nexus = nexus_data(file);
  if (nexus.size() == 1) return nexus_volume(file, nexus[0], options);
  if (nexus.size() > 1) {
    std::vector<std::string> paths;
    for (const NexusData& data : nexus) paths.push_back(data.dataset);
    fail_several(file, paths);
  }
  return plain_volume(file, only_dataset(file), options);
}

Layout named_layout(const Hdf5File& file, const std::string& path, const ReadOptions& options) {
  const std::string group = std::filesystem::path(path).parent_path().string();
  if (path == group + "/VoxelData" && is_itk_image(file, group)) {
    return itk_image(file, group, options);
  }
  const haddr_t address = file.address(path);
  for (const NexusData& data : nexus_data(file)) {
    if (file.address(data.dataset) == address) return nexus_volume(file, data, options);
  }
  return plain_volume(file, path, options);
}

void collect_datasets(const Hdf5File& file, const std::string& group, int rank, int depth,
                      std::set<haddr_t>& seen, std::vector<std::string>& found) {
  constexpr int kMaxDepth = 32;
  if (depth > kMaxDepth) file.fail(group, "groups nested too deeply", "at most 32 levels");
  for (const Hdf5File::Entry& entry : file.children(group)) {
    if (!seen.insert(file.address(entry.path)).second) continue;
    if (entry.is_group) {
      collect_datasets(file, entry.path, rank, depth + 1, seen, found);
      continue;
    }
    const Hdf5Handle id = file.open(entry.path);
    const Hdf5Handle space(H5Dget_space(id.get()), H5Sclose);
    if (H5Sget_simple_extent_ndims(space.get()) != rank) continue;
    const Hdf5Handle type(H5Dget_type(id.get()), H5Tclose);
    const H5T_class_t type_class = H5Tget_class(type.get());
    if (type_class == H5T_INTEGER || type_class == H5T_FLOAT || type_class == H5T_ENUM) {
      found.push_back(entry.path);
    }
  }
}

}  // namespace

std::vector<std::string> hdf5::numeric_datasets(const Hdf5File& file, int rank) {
  std::set<haddr_t> seen = {file.address("/")};
  std::vector<std::string> found;
  collect_datasets(file, "/", rank, 0, seen, found);
  return found;
}

std::unique_ptr<VolumeFile> hdf5::open_file(const std::string& name, const std::string& path,
                                            const ReadOptions& options) {
  auto file = std::make_shared<const Hdf5File>(name, path);
  if (name != path) {
    return std::make_unique<Hdf5Volume>(file,
                                        named_layout(*file, path.substr(name.size() + 1), options));
  }
  if (file->has("/TransformGroup")) return open_itk_transform(file, options);
  return std::make_unique<Hdf5Volume>(file, found_layout(*file, options));
}

}  // namespace supple
