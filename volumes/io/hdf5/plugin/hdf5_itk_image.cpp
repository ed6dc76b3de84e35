// ITK's HDF5 images, as itk::HDF5ImageIO writes them:
// /ITKImage/0/{Dimension, Directions, Origin, Spacing, VoxelData}.
#include <cmath>
#include <limits>

#include "volumes/base/error.h"
#include "volumes/io/bytes/text_header.h"
#include "volumes/io/format/formats.h"
#include "volumes/io/hdf5/plugin/hdf5_layouts.h"

namespace supple::hdf5 {

namespace {

constexpr hsize_t kMaxComponents = 16;

/// Values of the header that stand beside the voxels.
struct ItkHeader {
  std::vector<double> sizes, origin, spacing;
  std::vector<double> directions;  // row a: the unit vector of axis a
};

ItkHeader read_header(const Hdf5File& file, const std::string& group) {
  ItkHeader header;
  header.sizes = file.numbers(group + "/Dimension", 16);
  const std::size_t rank = header.sizes.size();
  if (rank < 2 || rank > 4) {
    file.fail(group + "/Dimension", std::to_string(rank) + " sizes", "2 to 4 sizes");
  }
  const auto read = [&](const char* name, std::size_t count) {
    std::vector<double> values = file.numbers(group + "/" + name, 64);
    if (values.size() != count) {
      file.fail(group + "/" + name, std::to_string(values.size()) + " numbers",
                std::to_string(count));
    }
    return values;
  };
  header.origin = read("Origin", rank);
  header.spacing = read("Spacing", rank);
  header.directions = read("Directions", rank * rank);
  return header;
}

Geometry geometry_of(const Hdf5File& file, const std::string& group, const ItkHeader& header) {
  const std::size_t rank = header.sizes.size(), spatial = std::min<std::size_t>(rank, 3);
  std::vector<std::int64_t> sizes;
  std::array<Vec3d, 3> axes = {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}};
  Vec3d origin(0, 0, 0);
  for (std::size_t a = 0; a < spatial; ++a) {
    if (!(header.spacing[a] > 0)) {
      file.fail(group + "/Spacing", number_text(header.spacing[a]), "lengths above 0");
    }
    // Beyond 2^31 dims_from refuses it.
    sizes.push_back(std::int64_t(std::min(header.sizes[a], 4e9)));
    origin[int(a)] = header.origin[a];
    for (std::size_t c = 0; c < spatial; ++c) {
      axes[a][int(c)] = header.directions[a * rank + c] * header.spacing[a];
    }
  }
  if (spatial == 2) axes[2] = axes[0].cross(axes[1]).normalized();
  const Vec3i dims =
      dims_from({file.shown(), group + "/Dimension", "sizes beyond the limit"}, sizes);
  return make_geometry(file.shown(), dims, origin, axes);
}

/// Components of the dataset, whose axes must be those of the header reversed.
hsize_t components_of(const Hdf5File& file, const Dataset& dataset,
                      const std::vector<double>& sizes) {
  const std::size_t rank = sizes.size(), axes = dataset.dims.size();
  bool is_same = axes == rank || axes == rank + 1;
  for (std::size_t a = 0; is_same && a < rank; ++a) {
    is_same = double(dataset.dims[rank - 1 - a]) == sizes[a];
  }
  if (!is_same) file.fail(dataset.path, "other sizes", "the sizes in Dimension, reversed");
  const hsize_t components = axes == rank ? 1 : dataset.dims.back();
  if (components < 1 || components > kMaxComponents) {
    file.fail(dataset.path, std::to_string(components) + " components", "1 to 16");
  }
  return components;
}

}  // namespace

bool is_itk_image(const Hdf5File& file, const std::string& group) {
  for (const char* name : {"/Dimension", "/Directions", "/Origin", "/Spacing", "/VoxelData"}) {
    if (!file.has(group + name)) return false;
  }
  return true;
}

Layout itk_image(const Hdf5File& file, const std::string& group, const ReadOptions& options) {
  const ItkHeader header = read_header(file, group);
  Layout layout;
  layout.dataset = file.open_dataset(group + "/VoxelData");
  std::string refused;
  const auto type = file.numeric_type(layout.dataset, refused);
  if (!type) file.fail(layout.dataset.path, refused, "integers or floats");
  layout.header.type = *type;
  layout.header.components = int(components_of(file, layout.dataset, header.sizes));
  layout.header.geometry = geometry_of(file, group, header);

  const std::size_t rank = header.sizes.size();
  const Vec3i& dims = layout.header.geometry.dims();
  const std::vector<hsize_t>& sizes = layout.dataset.dims;
  layout.selection = {std::vector<hsize_t>(sizes.size(), 0), sizes, int(rank) - 3, 1, dims.z};
  if (rank == 2) {
    layout.selection.axis = 0;
    layout.selection.step = sizes[0];
  }
  const std::int64_t frames = rank == 4 ? std::int64_t(sizes[0]) : 1;
  const int frame = chosen_frame(options, frames, file.shown(), layout.dataset.path);
  if (rank == 4) {
    layout.selection.start[0] = hsize_t(frame);
    layout.selection.count[0] = 1;
  }
  return layout;
}

}  // namespace supple::hdf5
