#include "tests/volumes/io/hdf5_fixtures.h"

#include <cstdint>
#include <stdexcept>

namespace supple::test {

namespace {

hid_t checked(hid_t id) {
  if (id < 0) throw std::runtime_error("HDF5 fixture");
  return id;
}

}  // namespace

template <>
hid_t hdf5_type<std::int8_t>() {
  return H5T_NATIVE_INT8;
}
template <>
hid_t hdf5_type<std::uint8_t>() {
  return H5T_NATIVE_UINT8;
}
template <>
hid_t hdf5_type<std::int16_t>() {
  return H5T_NATIVE_INT16;
}
template <>
hid_t hdf5_type<std::uint16_t>() {
  return H5T_NATIVE_UINT16;
}
template <>
hid_t hdf5_type<std::int32_t>() {
  return H5T_NATIVE_INT32;
}
template <>
hid_t hdf5_type<std::uint32_t>() {
  return H5T_NATIVE_UINT32;
}
template <>
hid_t hdf5_type<std::int64_t>() {
  return H5T_NATIVE_INT64;
}
template <>
hid_t hdf5_type<std::uint64_t>() {
  return H5T_NATIVE_UINT64;
}
template <>
hid_t hdf5_type<float>() {
  return H5T_NATIVE_FLOAT;
}
template <>
hid_t hdf5_type<double>() {
  return H5T_NATIVE_DOUBLE;
}

Hdf5Fixture::Hdf5Fixture(const std::string& path)
    : m_file(checked(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT))),
      m_make_groups(checked(H5Pcreate(H5P_LINK_CREATE))) {
  H5Pset_create_intermediate_group(m_make_groups, 1);
}

Hdf5Fixture::~Hdf5Fixture() {
  H5Pclose(m_make_groups);
  H5Fclose(m_file);
}

void Hdf5Fixture::group(const std::string& path) {
  H5Gclose(checked(H5Gcreate2(m_file, path.c_str(), m_make_groups, H5P_DEFAULT, H5P_DEFAULT)));
}

void Hdf5Fixture::put(const std::string& path, const std::vector<hsize_t>& dims, hid_t memory_type,
                      const void* values, const Hdf5Storage& storage) {
  const hid_t creation = checked(H5Pcreate(H5P_DATASET_CREATE));
  if (!storage.chunk.empty()) H5Pset_chunk(creation, int(dims.size()), storage.chunk.data());
  if (storage.shuffle) H5Pset_shuffle(creation);
  if (storage.deflate) H5Pset_deflate(creation, 6);
  if (storage.szip) H5Pset_szip(creation, H5_SZIP_NN_OPTION_MASK, 8);
  if (storage.fletcher) H5Pset_fletcher32(creation);
  if (storage.fill != 0) H5Pset_fill_value(creation, H5T_NATIVE_INT, &storage.fill);
  const hid_t space = checked(H5Screate_simple(int(dims.size()), dims.data(), nullptr));
  const hid_t type = storage.file_type >= 0 ? storage.file_type : memory_type;
  if (H5Tget_class(type) == H5T_ENUM) memory_type = type;
  const hid_t set =
      checked(H5Dcreate2(m_file, path.c_str(), type, space, m_make_groups, creation, H5P_DEFAULT));
  if (values != nullptr) {
    checked(H5Dwrite(set, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values));
  }
  H5Dclose(set);
  H5Sclose(space);
  H5Pclose(creation);
}

void Hdf5Fixture::text(const std::string& path, const std::string& value, bool variable) {
  const hid_t type = checked(H5Tcopy(H5T_C_S1));
  H5Tset_size(type, variable ? H5T_VARIABLE : value.size());
  const hsize_t one = 1;
  const hid_t space = checked(H5Screate_simple(1, &one, nullptr));
  const hid_t set = checked(
      H5Dcreate2(m_file, path.c_str(), type, space, m_make_groups, H5P_DEFAULT, H5P_DEFAULT));
  const char* characters = value.c_str();
  const void* from = variable ? static_cast<const void*>(&characters) : characters;
  checked(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, from));
  H5Dclose(set);
  H5Sclose(space);
  H5Tclose(type);
}

void Hdf5Fixture::attribute(const std::string& object, const std::string& name,
                            const std::vector<double>& values) {
  const hsize_t count = values.size();
  const hid_t space = checked(H5Screate_simple(1, &count, nullptr));
  const hid_t id = checked(H5Acreate_by_name(m_file, object.c_str(), name.c_str(), H5T_IEEE_F64BE,
                                             space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  checked(H5Awrite(id, H5T_NATIVE_DOUBLE, values.data()));
  H5Aclose(id);
  H5Sclose(space);
}

void Hdf5Fixture::text_attribute(const std::string& object, const std::string& name,
                                 const std::string& value) {
  const hid_t type = checked(H5Tcopy(H5T_C_S1));
  H5Tset_size(type, value.size());
  const hid_t space = checked(H5Screate(H5S_SCALAR));
  const hid_t id = checked(H5Acreate_by_name(m_file, object.c_str(), name.c_str(), type, space,
                                             H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  checked(H5Awrite(id, type, value.data()));
  H5Aclose(id);
  H5Sclose(space);
  H5Tclose(type);
}

void put_itk_transform(Hdf5Fixture& file, int n, const std::string& type,
                       const std::vector<double>& fixed, const std::vector<double>& parameters) {
  const std::string group = "/TransformGroup/" + std::to_string(n);
  file.text(group + "/TransformType", type);
  if (type.find("Composite") != std::string::npos) return;
  file.numbers(group + "/TransformFixedParameters", fixed);
  file.numbers(group + "/TransformParameters", parameters);
}

}  // namespace supple::test
