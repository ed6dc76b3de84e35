// Datasets of an HDF5 file as they are opened, and the small values around them: attributes, and
// datasets that hold a few numbers or a line of text.
#include <algorithm>

#include "volumes/io/bytes/text_header.h"
#include "volumes/io/hdf5/plugin/hdf5_file.h"

namespace supple::hdf5 {

namespace {

constexpr std::size_t kMaxText = std::size_t(1) << 20;

/// Reads all values of a dataset or attribute in the given type of memory.
struct SmallSource {
  hid_t id;
  Hdf5Handle type, space;
  herr_t (*read)(hid_t id, hid_t type, void* out);
  std::string name;  // for errors
};

herr_t read_dataset(hid_t id, hid_t type, void* out) {
  return H5Dread(id, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, out);
}

SmallSource source_of(const Dataset& dataset) {
  const hid_t id = dataset.id.get();
  return {
      id, {H5Dget_type(id), H5Tclose}, {H5Dget_space(id), H5Sclose}, read_dataset, dataset.path};
}

SmallSource source_of(const Hdf5Handle& attribute, const std::string& name) {
  const hid_t id = attribute.get();
  return {id, {H5Aget_type(id), H5Tclose}, {H5Aget_space(id), H5Sclose}, H5Aread, name};
}

std::vector<double> numbers_of(const Hdf5File& file, const SmallSource& source, std::size_t limit) {
  const hssize_t count = H5Sget_simple_extent_npoints(source.space.get());
  if (!source.type.is_open() || count < 0) file.fail_library(source.name);
  const H5T_class_t type_class = H5Tget_class(source.type.get());
  if (type_class != H5T_INTEGER && type_class != H5T_FLOAT) {
    file.fail(source.name, "no numbers", "numbers");
  }
  if (std::size_t(count) > limit) {
    file.fail(source.name, std::to_string(count) + " numbers", "at most " + std::to_string(limit));
  }
  std::vector<double> values(static_cast<std::size_t>(count));
  if (count > 0 && source.read(source.id, H5T_NATIVE_DOUBLE, values.data()) < 0) {
    file.fail_library(source.name);
  }
  return values;
}

std::string text_of(const Hdf5File& file, const SmallSource& source) {
  const hid_t type = source.type.get();
  const bool is_one = H5Sget_simple_extent_npoints(source.space.get()) == 1;
  if (!is_one || H5Tget_class(type) != H5T_STRING) file.fail(source.name, "no text", "one string");
  if (H5Tis_variable_str(type) > 0) {
    char* characters = nullptr;
    if (source.read(source.id, type, &characters) < 0) file.fail_library(source.name);
    const std::string text(characters == nullptr ? "" : characters);
    H5free_memory(characters);
    return text.substr(0, kMaxText);
  }
  const std::size_t size = H5Tget_size(type);
  if (size == 0 || size > kMaxText) file.fail(source.name, "a long string", "at most 1 MiB");
  std::string text(size, '\0');
  if (source.read(source.id, type, text.data()) < 0) file.fail_library(source.name);
  text.resize(std::min(text.find('\0'), text.size()));
  return trimmed(text);
}

/// Opens an attribute; the handle is closed where the object has none of this name.
Hdf5Handle open_attribute(const Hdf5File& file, const Hdf5Handle& object, const std::string& name) {
  const htri_t exists = H5Aexists(object.get(), name.c_str());
  if (exists < 0) file.fail_library(name);
  if (exists == 0) return {};
  Hdf5Handle attribute(H5Aopen(object.get(), name.c_str(), H5P_DEFAULT), H5Aclose);
  if (!attribute.is_open()) file.fail_library(name);
  return attribute;
}

bool is_built_in(H5Z_filter_t filter) {
  return filter >= H5Z_FILTER_DEFLATE && filter <= H5Z_FILTER_SCALEOFFSET &&
         H5Zfilter_avail(filter) > 0;
}

/// Refuses what would read other files or run code from plugins.
void check_storage(const Hdf5File& file, const std::string& path, hid_t creation) {
  const H5D_layout_t layout = H5Pget_layout(creation);
  if (layout < 0) file.fail_library(path);
  if (layout == H5D_VIRTUAL) {
    file.fail(path, "a virtual dataset", "values inside the file");
  }
  if (H5Pget_external_count(creation) > 0) {
    file.fail(path, "values in an external file", "values inside the file");
  }
  const int filters = H5Pget_nfilters(creation);
  if (filters < 0) file.fail_library(path);
  for (int n = 0; n < filters; ++n) {
    unsigned flags = 0, config = 0;
    std::size_t values = 0;
    char name[60] = "";
    const H5Z_filter_t filter =
        H5Pget_filter2(creation, unsigned(n), &flags, &values, nullptr, sizeof name, name, &config);
    if (filter < 0) file.fail_library(path);
    if (is_built_in(filter)) continue;
    name[sizeof name - 1] = '\0';
    file.fail(path,
              "filter " + std::to_string(filter) + (*name == '\0' ? "" : " " + printable(name)),
              "gzip, shuffle, fletcher32, szip, n-bit or scale-offset (h5repack -f GZIP=5)");
  }
}

}  // namespace

Dataset Hdf5File::open_dataset(const std::string& path) const {
  Dataset dataset{path, open(path), {}, {}, 0};
  const hid_t id = dataset.id.get();
  if (H5Iget_type(id) != H5I_DATASET) fail(path, "a group or type", "a dataset");
  const Hdf5Handle creation(H5Dget_create_plist(id), H5Pclose);
  if (!creation.is_open()) fail_library(path);
  check_storage(*this, path, creation.get());

  const Hdf5Handle space(H5Dget_space(id), H5Sclose);
  const int rank = H5Sget_simple_extent_ndims(space.get());
  if (rank < 0) fail_library(path);
  if (H5Sget_simple_extent_type(space.get()) == H5S_NULL) fail(path, "no values", "values");
  dataset.dims.resize(std::size_t(rank));
  H5Sget_simple_extent_dims(space.get(), dataset.dims.data(), nullptr);
  if (H5Pget_layout(creation.get()) == H5D_CHUNKED) {
    dataset.chunk.resize(dataset.dims.size());
    if (H5Pget_chunk(creation.get(), rank, dataset.chunk.data()) != rank) fail_library(path);
  }
  dataset.storage = std::int64_t(H5Dget_storage_size(id));
  return dataset;
}

std::vector<double> Hdf5File::numbers(const std::string& path, std::size_t limit) const {
  const Dataset dataset = open_dataset(path);
  return numbers_of(*this, source_of(dataset), limit);
}

std::string Hdf5File::text(const std::string& path) const {
  const Dataset dataset = open_dataset(path);
  return text_of(*this, source_of(dataset));
}

std::optional<std::vector<double>> Hdf5File::attribute_numbers(const std::string& object,
                                                               const std::string& name,
                                                               std::size_t limit) const {
  const Hdf5Handle owner = open(object);
  const Hdf5Handle attribute = open_attribute(*this, owner, name);
  if (!attribute.is_open()) return {};
  return numbers_of(*this, source_of(attribute, name), limit);
}

std::optional<std::string> Hdf5File::attribute_text(const std::string& object,
                                                    const std::string& name) const {
  const Hdf5Handle owner = open(object);
  const Hdf5Handle attribute = open_attribute(*this, owner, name);
  if (!attribute.is_open()) return {};
  return text_of(*this, source_of(attribute, name));
}

}  // namespace supple::hdf5
