// HDF5 files that ITK, 3D Slicer, ANTs and h5py read. Scalars become an ITK image
// (/ITKImage/0, as itk::HDF5ImageIO writes it), vectors an ITK transform
// (/TransformGroup/0, DisplacementFieldTransform_double_3_3, as itk::HDF5TransformIO writes it)
// with the attributes supple_direction and supple_certificate. Equal inputs give equal bytes: no
// times. Memory: the caller's slice and, compressed, one chunk of at most 64 MiB.
#include "volumes/io/hdf5/plugin/hdf5_writer.h"

#include <algorithm>
#include <cstring>

#include "volumes/base/atomic_file.h"
#include "volumes/base/error.h"
#include "volumes/io/hdf5/plugin/hdf5_file.h"

namespace supple {

namespace {

using hdf5::Hdf5Handle;

constexpr hsize_t kMaxChunkBytes = hsize_t(64) << 20;
constexpr unsigned kDeflateLevel = 6;

// Names in the order of ValueType, as itk::ImageIOBase has them.
constexpr const char* kItkTypes[] = {"CHAR", "UCHAR", "SHORT", "USHORT", "INT",
                                     "UINT", "LONG",  "ULONG", "FLOAT",  "DOUBLE"};

class Hdf5Writer : public DenseWriter {
 public:
  Hdf5Writer(const std::string& path, const DenseImage& image, const WriteOptions& options)
      : m_output(path), m_image(image) {
    hdf5::prepare_library();
    const Hdf5Handle access = checked({H5Pcreate(H5P_FILE_ACCESS), H5Pclose});
    check(H5Pset_fclose_degree(access.get(), H5F_CLOSE_STRONG));
    check(H5Pset_file_locking(access.get(), false, true));
    const Hdf5Handle creation = checked({H5Pcreate(H5P_FILE_CREATE), H5Pclose});
    check(H5Pset_obj_track_times(creation.get(), false));
    m_file =
        checked({H5Fcreate(m_output.path().c_str(), H5F_ACC_TRUNC, creation.get(), access.get()),
                 H5Fclose});
    if (image.components == 1) {
      begin_image(options.compress);
    } else {
      begin_transform(options.compress);
    }
  }

  void write_slice(const void* values) override {
    const Hdf5Handle in_file = checked({H5Dget_space(m_values.get()), H5Sclose});
    const Hdf5Handle in_memory =
        checked({H5Screate_simple(int(m_count.size()), m_count.data(), nullptr), H5Sclose});
    check(H5Sselect_hyperslab(in_file.get(), H5S_SELECT_SET, m_start.data(), nullptr,
                              m_count.data(), nullptr));
    check(H5Dwrite(m_values.get(), hdf5::native_type(m_image.type), in_memory.get(), in_file.get(),
                   H5P_DEFAULT, values));
    m_start[0] += m_count[0];
  }

  void commit() override {
    check(H5Fflush(m_file.get(), H5F_SCOPE_GLOBAL));
    check(m_values.close() ? 0 : -1);
    check(m_file.close() ? 0 : -1);
    m_output.commit();
  }

 private:
  void check(herr_t result) const {
    if (result >= 0) return;
    const hdf5::Failure failure = hdf5::last_failure();
    throw SystemError(
        m_output.final_path() + ": cannot write: " +
        (failure.errno_value != 0 ? std::strerror(failure.errno_value) : failure.reason));
  }
  Hdf5Handle checked(Hdf5Handle handle) const {
    check(handle.is_open() ? 0 : -1);
    return handle;
  }

  void make_group(const std::string& path) const {
    const Hdf5Handle creation = checked({H5Pcreate(H5P_GROUP_CREATE), H5Pclose});
    check(H5Pset_obj_track_times(creation.get(), false));
    checked({H5Gcreate2(m_file.get(), path.c_str(), H5P_DEFAULT, creation.get(), H5P_DEFAULT),
             H5Gclose});
  }

  Hdf5Handle make_dataset(const std::string& path, hid_t type, const std::vector<hsize_t>& dims,
                          const std::vector<hsize_t>& chunk = {}) const {
    const Hdf5Handle creation = checked({H5Pcreate(H5P_DATASET_CREATE), H5Pclose});
    check(H5Pset_obj_track_times(creation.get(), false));
    // The library wants text of variable length filled.
    if (H5Tget_class(type) != H5T_STRING) {
      check(H5Pset_fill_time(creation.get(), H5D_FILL_TIME_NEVER));
    }
    if (!chunk.empty()) {
      check(H5Pset_chunk(creation.get(), int(chunk.size()), chunk.data()));
      check(H5Pset_shuffle(creation.get()));
      check(H5Pset_deflate(creation.get(), kDeflateLevel));
    }
    const Hdf5Handle space =
        checked({H5Screate_simple(int(dims.size()), dims.data(), nullptr), H5Sclose});
    return checked({H5Dcreate2(m_file.get(), path.c_str(), type, space.get(), H5P_DEFAULT,
                               creation.get(), H5P_DEFAULT),
                    H5Dclose});
  }

  void put_numbers(const std::string& path, const std::vector<double>& values,
                   const std::vector<hsize_t>& dims, hid_t type = H5T_IEEE_F64LE) const {
    const Hdf5Handle dataset = make_dataset(path, type, dims);
    check(H5Dwrite(dataset.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()));
  }

  /// A list of one string of variable length, as ITK's readers want it.
  void put_text(const std::string& path, const char* text) const {
    const Hdf5Handle type = checked({H5Tcopy(H5T_C_S1), H5Tclose});
    check(H5Tset_size(type.get(), H5T_VARIABLE));
    const Hdf5Handle dataset = make_dataset(path, type.get(), {1});
    check(H5Dwrite(dataset.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, &text));
  }

  void put_attribute(const std::string& group, const char* name, const std::string& text) const {
    const Hdf5Handle type = checked({H5Tcopy(H5T_C_S1), H5Tclose});
    check(H5Tset_size(type.get(), text.size() + 1));
    const Hdf5Handle space = checked({H5Screate(H5S_SCALAR), H5Sclose});
    const Hdf5Handle attribute =
        checked({H5Acreate_by_name(m_file.get(), group.c_str(), name, type.get(), space.get(),
                                   H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                 H5Aclose});
    check(H5Awrite(attribute.get(), type.get(), text.c_str()));
  }

  void begin_image(bool compress) {
    const Geometry& geometry = m_image.geometry;
    const auto size = Vec3d(geometry.dims()), spacing = geometry.spacing_mm();
    const Vec3d& origin = geometry.origin_lps_mm();
    const std::string group = "/ITKImage/0";
    make_group("/ITKImage");
    make_group(group);
    make_group(group + "/MetaData");
    put_numbers(group + "/Dimension", {size.x, size.y, size.z}, {3}, H5T_STD_U64LE);
    put_numbers(group + "/Origin", {origin.x, origin.y, origin.z}, {3});
    put_numbers(group + "/Spacing", {spacing.x, spacing.y, spacing.z}, {3});
    std::vector<double> rows;
    for (const Vec3d& axis : geometry.direction())
      rows.insert(rows.end(), {axis.x, axis.y, axis.z});
    put_numbers(group + "/Directions", rows, {3, 3});
    put_text(group + "/VoxelType", kItkTypes[int(m_image.type)]);

    const hsize_t nx = hsize_t(size.x), ny = hsize_t(size.y), nz = hsize_t(size.z);
    const hsize_t row_bytes = nx * hsize_t(bytes_of(m_image.type));
    const hsize_t rows_in_chunk =
        std::min(ny, std::max<hsize_t>(1, kMaxChunkBytes / std::max<hsize_t>(1, row_bytes)));
    m_start = {0, 0, 0};
    m_count = {1, ny, nx};
    std::vector<hsize_t> chunk;
    if (compress) chunk = {1, rows_in_chunk, nx};
    m_values =
        make_dataset(group + "/VoxelData", hdf5::native_type(m_image.type), {nz, ny, nx}, chunk);
  }

  void begin_transform(bool compress) {
    const Geometry& geometry = m_image.geometry;
    const std::string group = "/TransformGroup/0";
    make_group("/TransformGroup");
    make_group(group);
    put_attribute(group, "supple_direction", m_image.direction);
    if (!m_image.certificate.empty()) {
      put_attribute(group, "supple_certificate", m_image.certificate);
    }
    put_text(group + "/TransformType", "DisplacementFieldTransform_double_3_3");
    std::vector<double> fixed;
    const std::array<Vec3d, 3> axes = geometry.direction();
    for (const Vec3d& v :
         {Vec3d(geometry.dims()), geometry.origin_lps_mm(), geometry.spacing_mm(),
          Vec3d(axes[0].x, axes[1].x, axes[2].x), Vec3d(axes[0].y, axes[1].y, axes[2].y),
          Vec3d(axes[0].z, axes[1].z, axes[2].z)}) {
      fixed.insert(fixed.end(), {v.x, v.y, v.z});
    }
    put_numbers(group + "/TransformFixedParameters", fixed, {fixed.size()});

    const Vec3i& dims = geometry.dims();
    const hsize_t slice = hsize_t(m_image.components) * hsize_t(dims.x) * hsize_t(dims.y);
    m_start = {0};
    m_count = {slice};
    std::vector<hsize_t> chunk;
    if (compress) chunk = {std::min(slice, kMaxChunkBytes / sizeof(double))};
    m_values = make_dataset(group + "/TransformParameters", H5T_IEEE_F64LE,
                            {slice * hsize_t(dims.z)}, chunk);
  }

  AtomicFile m_output;
  DenseImage m_image;
  Hdf5Handle m_file, m_values;
  std::vector<hsize_t> m_start, m_count;  // of the next slice in the dataset
};

}  // namespace

std::unique_ptr<DenseWriter> hdf5::create_file(const std::string& path, const DenseImage& image,
                                               const WriteOptions& options) {
  return std::make_unique<Hdf5Writer>(path, image, options);
}

}  // namespace supple
