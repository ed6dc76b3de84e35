#include "volumes/io/hdf5/plugin/hdf5_slices.h"

#include <algorithm>
#include <cstring>

#include "volumes/base/error.h"

namespace supple::hdf5 {

namespace {

constexpr double kMaxSliceBytes = 2147483648.0, kMaxChunkBytes = 2147483648.0;
constexpr std::size_t kRunBytes = std::size_t(256) << 20;
// Sparse chunks and fill values are legal: a small file may claim much, but not everything.
constexpr double kFreeClaim = 4294967296.0, kClaimPerByte = 4096;

double product(const std::vector<hsize_t>& sizes) {
  double all = 1;
  for (const hsize_t size : sizes) all *= double(size);
  return all;
}

std::string bytes_text(double bytes) {
  return number_text(bytes) + " bytes";
}

}  // namespace

SliceReader::SliceReader(std::shared_ptr<const Hdf5File> file, Dataset dataset, ValueType type,
                         SliceSelection selection)
    : m_file(std::move(file)),
      m_dataset(std::move(dataset)),
      m_type(native_type(type)),
      m_selection(std::move(selection)) {
  const double width = bytes_of(type);
  const double claimed = product(m_dataset.dims) * width;
  const std::string& path = m_dataset.path;
  if (claimed > std::max(kFreeClaim, kClaimPerByte * double(m_dataset.storage))) {
    m_file->fail(path,
                 bytes_text(claimed) + " of values in " + bytes_text(double(m_dataset.storage)),
                 "at most 4096 times what is stored");
  }
  const double chunk_bytes = product(m_dataset.chunk) * width;
  if (chunk_bytes > kMaxChunkBytes) {
    m_file->fail(path, "chunks of " + bytes_text(chunk_bytes), "chunks of at most 2 GiB");
  }
  const double slice_bytes = product(m_selection.count) * width / m_selection.slices;
  if (slice_bytes > kMaxSliceBytes) {
    m_file->fail(path, "slices of " + bytes_text(slice_bytes), "slices of at most 2 GiB");
  }

  m_slice_bytes = std::size_t(slice_bytes);
  if (m_dataset.chunk.empty()) return;
  const double depth =
      double(m_dataset.chunk[std::size_t(m_selection.axis)]) / double(m_selection.step);
  const double fitting = std::min(double(kRunBytes / m_slice_bytes), double(m_selection.slices));
  m_slices_per_run = int(std::max(1.0, std::min(std::ceil(depth), fitting)));
}

void SliceReader::read(void* out) {
  const int within = m_slices_read % m_slices_per_run;
  const int left = m_selection.slices - m_slices_read;
  if (left <= 0) throw Error(m_file->shown() + ": more slices were asked for than there are");
  if (m_slices_per_run == 1) {
    read_slices(m_slices_read, 1, out);
  } else {
    if (within == 0) {
      m_run.resize(m_slice_bytes * std::size_t(m_slices_per_run));
      read_slices(m_slices_read, std::min(left, m_slices_per_run), m_run.data());
    }
    std::memcpy(out, m_run.data() + m_slice_bytes * std::size_t(within), m_slice_bytes);
  }
  ++m_slices_read;
}

void SliceReader::read_slices(int first, int count, void* out) const {
  std::vector<hsize_t> start = m_selection.start, size = m_selection.count;
  const std::size_t axis = std::size_t(m_selection.axis);
  start[axis] += hsize_t(first) * m_selection.step;
  size[axis] = hsize_t(count) * m_selection.step;
  const hid_t id = m_dataset.id.get();
  const Hdf5Handle in_file(H5Dget_space(id), H5Sclose);
  const Hdf5Handle in_memory(H5Screate_simple(int(size.size()), size.data(), nullptr), H5Sclose);
  const bool is_read = H5Sselect_hyperslab(in_file.get(), H5S_SELECT_SET, start.data(), nullptr,
                                           size.data(), nullptr) >= 0 &&
                       H5Dread(id, m_type, in_memory.get(), in_file.get(), H5P_DEFAULT, out) >= 0;
  if (!is_read) m_file->fail_library(m_dataset.path);
}

}  // namespace supple::hdf5
