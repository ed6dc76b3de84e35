// HDF5 files written by the HDF5 library itself.
#pragma once

#include <string>
#include <vector>

#include <hdf5.h>

namespace supple::test {

/// Storage of a dataset; contiguous in native byte order where nothing is said.
struct Hdf5Storage {
  hid_t file_type = H5I_INVALID_HID;
  std::vector<hsize_t> chunk = {};
  bool shuffle = false, deflate = false, fletcher = false, szip = false;
  int fill = 0;
};

template <class T>
hid_t hdf5_type();

/// A file being written; closed with the object.
class Hdf5Fixture {
 public:
  explicit Hdf5Fixture(const std::string& path);
  ~Hdf5Fixture();
  Hdf5Fixture(const Hdf5Fixture&) = delete;
  Hdf5Fixture& operator=(const Hdf5Fixture&) = delete;

  hid_t get() const { return m_file; }
  void group(const std::string& path);
  /// Groups on the way are made. Without values the dataset is left unwritten.
  template <class T>
  void dataset(const std::string& path, const std::vector<hsize_t>& dims,
               const std::vector<T>& values, const Hdf5Storage& storage = {}) {
    put(path, dims, hdf5_type<T>(), values.empty() ? nullptr : values.data(), storage);
  }
  void numbers(const std::string& path, const std::vector<double>& values) {
    dataset(path, {values.size()}, values);
  }
  /// One string: of variable length as ITK writes it, else of fixed length.
  void text(const std::string& path, const std::string& value, bool variable = true);
  void attribute(const std::string& object, const std::string& name,
                 const std::vector<double>& values);
  void text_attribute(const std::string& object, const std::string& name, const std::string& value);

 private:
  void put(const std::string& path, const std::vector<hsize_t>& dims, hid_t memory_type,
           const void* values, const Hdf5Storage& storage);
  hid_t m_file;
  hid_t m_make_groups;
};

/// /TransformGroup/N of ITK. Without parameters neither they nor the fixed ones are written.
void put_itk_transform(Hdf5Fixture& file, int n, const std::string& type,
                       const std::vector<double>& fixed = {},
                       const std::vector<double>& parameters = {});

/// 0, 1, 2, ... as values.
template <class T>
std::vector<T> counting(std::size_t count) {
  std::vector<T> values(count);
  for (std::size_t n = 0; n < count; ++n) values[n] = T(n);
  return values;
}

}  // namespace supple::test
