#include "volumes/io/hdf5/plugin/hdf5_layouts.h"

#include <cmath>

#include "volumes/base/error.h"
#include "volumes/io/bytes/text_header.h"
#include "volumes/io/format/formats.h"
#include "volumes/io/format/length_units.h"

namespace supple::hdf5 {

namespace {

const char* const kNoSpacing = "no voxel sizes in the file: 1 mm is taken (spacing)";

/// The unit that `units` or `unit` of an object names; 0 without one.
double unit_of(const Hdf5File& file, const std::string& object) {
  for (const char* name : {"units", "unit"}) {
    const std::optional<std::string> text = file.attribute_text(object, name);
    if (!text) continue;
    const std::optional<double> mm = mm_per_unit(*text);
    if (!mm) file.fail(object + " " + name, printable(*text), "nm, um, mm, cm or m");
    return *mm;
  }
  return 0;
}

double checked_length(const Hdf5File& file, const std::string& name, double mm) {
  if (!(mm > 0) || !std::isfinite(mm)) file.fail(name, number_text(mm), "lengths above 0");
  return mm;
}

/// Lengths in the order of the dataset's axes, as spacings of i, j, k.
Vec3d spacing_from(const Hdf5File& file, const std::string& name, const std::vector<double>& values,
                   std::size_t rank, double mm_per_unit) {
  const std::size_t spatial = std::min<std::size_t>(rank, 3);
  if (values.size() != 1 && values.size() != spatial && values.size() != rank &&
      values.size() != 3) {
    file.fail(name, std::to_string(values.size()) + " numbers",
              "one per axis of the dataset, or one for all");
  }
  Vec3d spacing(1, 1, 1);
  for (std::size_t a = 0; a < std::max(spatial, std::min<std::size_t>(values.size(), 3)); ++a) {
    const double value = values.size() == 1 ? values[0] : values[values.size() - 1 - a];
    spacing[int(a)] = checked_length(file, name, value * mm_per_unit);
  }
  return spacing;
}

/// Spacing by the dataset's attributes; empty where none says it.
std::optional<Vec3d> attribute_spacing(const Hdf5File& file, const Dataset& dataset,
                                       std::vector<std::string>& warnings) {
  const auto read = [&](const char* name, double mm) -> std::optional<Vec3d> {
    const auto values = file.attribute_numbers(dataset.path, name, 16);
    if (!values) return {};
    return spacing_from(file, name, *values, dataset.dims.size(), mm);
  };
  if (const auto spacing = read("element_size_um", 1e-3)) return spacing;
  for (const char* name : {"spacing", "voxel_size", "resolution"}) {
    if (!file.attribute_numbers(dataset.path, name, 16)) continue;
    const double unit = unit_of(file, dataset.path);
    if (unit > 0 || std::string(name) != "resolution") return read(name, unit > 0 ? unit : 1);
    // Nanometres in CREMI, micrometres elsewhere.
    warnings.push_back("attribute resolution has no units and is not used (spacing)");
  }
  return {};
}

/// The lattice of a dataset of 2 to 4 axes; the geometry is left to the caller.
Layout lattice(const Hdf5File& file, const std::string& path, const ReadOptions& options,
               Vec3i& dims) {
  Layout layout;
  layout.dataset = file.open_dataset(path);
  const std::vector<hsize_t>& sizes = layout.dataset.dims;
  const std::size_t rank = sizes.size();
  if (rank < 2 || rank > 4) {
    file.fail(path, std::to_string(rank) + " axes", "2 to 4 axes: [frame,] [k,] j, i");
  }
  std::string refused;
  const auto type = file.numeric_type(layout.dataset, refused);
  if (!type) file.fail(path, refused, "integers of 8 to 64 bits or floats of 16 to 64 bits");
  layout.header.type = *type;

  std::vector<std::int64_t> fastest_first;
  for (std::size_t a = 0; a < std::min<std::size_t>(rank, 3); ++a) {
    fastest_first.push_back(std::int64_t(sizes[rank - 1 - a]));
  }
  dims =
      dims_from({file.shown(), path, "sizes of " + std::to_string(rank) + " axes"}, fastest_first);
  layout.selection = {std::vector<hsize_t>(rank, 0), sizes, int(rank) - 3, 1, dims.z};
  if (rank == 2) {
    layout.selection.axis = 0;
    layout.selection.step = sizes[0];
  }
  if (rank == 4) {
    const int frame = chosen_frame(options, std::int64_t(sizes[0]), file.shown(), path);
    layout.selection.start[0] = hsize_t(frame);
    layout.selection.count[0] = 1;
  } else {
    chosen_frame(options, 1, file.shown(), path);
  }
  return layout;
}

Geometry along_lps(const Hdf5File& file, const Vec3i& dims, const Vec3d& spacing) {
  return make_geometry(file.shown(), dims, {0, 0, 0},
                       {Vec3d(spacing.x, 0, 0), {0, spacing.y, 0}, {0, 0, spacing.z}});
}

std::string attribute_or_empty(const Hdf5File& file, const std::string& object, const char* name) {
  return file.attribute_text(object, name).value_or("");
}

/// Groups below `group` of a NeXus class.
std::vector<std::string> nexus_groups(const Hdf5File& file, const std::string& group,
                                      const char* nexus_class) {
  std::vector<std::string> found;
  for (const Hdf5File::Entry& entry : file.children(group)) {
    if (entry.is_group && attribute_or_empty(file, entry.path, "NX_class") == nexus_class) {
      found.push_back(entry.path);
    }
  }
  return found;
}

/// A pixel size in mm beside the data or in a detector; 0 where there is none.
double pixel_size(const Hdf5File& file, const NexusData& data, const char* name) {
  std::vector<std::string> groups = {data.group};
  for (const std::string& instrument : nexus_groups(file, data.entry, "NXinstrument")) {
    for (const std::string& detector : nexus_groups(file, instrument, "NXdetector")) {
      groups.push_back(detector);
    }
  }
  for (const std::string& group : groups) {
    const std::string path = group + "/" + name;
    if (!file.has(path)) continue;
    const std::vector<double> sizes = file.numbers(path, 16);
    const double unit = unit_of(file, path);
    if (unit == 0) file.fail(path, "no units", "the attribute units, or spacing");
    if (sizes.size() != 1) file.fail(path, std::to_string(sizes.size()) + " numbers", "one");
    return checked_length(file, path, sizes[0] * unit);
  }
  return 0;
}

}  // namespace

std::vector<NexusData> nexus_data(const Hdf5File& file) {
  std::vector<NexusData> found;
  for (const std::string& entry : nexus_groups(file, "/", "NXentry")) {
    for (const std::string& group : nexus_groups(file, entry, "NXdata")) {
      const std::string signal = file.attribute_text(group, "signal").value_or("data");
      const std::string dataset = group + "/" + signal;
      if (file.has(dataset)) found.push_back({dataset, group, entry});
    }
  }
  return found;
}

Layout nexus_volume(const Hdf5File& file, const NexusData& data, const ReadOptions& options) {
  Vec3i dims;
  Layout layout = lattice(file, data.dataset, options, dims);
  Vec3d spacing(1, 1, 1);
  if (!options.spacing_mm) {
    const double x = pixel_size(file, data, "x_pixel_size");
    const double y = pixel_size(file, data, "y_pixel_size");
    const double z = pixel_size(file, data, "z_pixel_size");
    if (x > 0 && y > 0) {
      spacing = {x, y, z > 0 ? z : y};
      if (z == 0) {
        layout.header.warnings.push_back("no z_pixel_size: y_pixel_size is taken for the slices");
      }
    } else {
      layout.header.warnings.push_back(kNoSpacing);
    }
  }
  layout.header.geometry = along_lps(file, dims, spacing);
  return layout;
}

Layout plain_volume(const Hdf5File& file, const std::string& path, const ReadOptions& options) {
  Vec3i dims;
  Layout layout = lattice(file, path, options, dims);
  std::optional<Vec3d> spacing = options.spacing_mm;
  if (!spacing) {
    spacing = attribute_spacing(file, layout.dataset, layout.header.warnings);
    if (!spacing) layout.header.warnings.push_back(kNoSpacing);
  }
  layout.header.geometry = along_lps(file, dims, spacing.value_or(Vec3d(1, 1, 1)));
  return layout;
}

}  // namespace supple::hdf5
