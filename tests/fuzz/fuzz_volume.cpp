// A volume or warp file of one format, named FUZZ_NAME and read by FUZZ_OPEN: its header, and all
// values where it claims no more than 16 MiB of them.
#include <vector>

#include "tests/fuzz/fuzz_file.h"
#include "volumes/io/format/formats.h"
#include "volumes/io/format/volume_file.h"

namespace {

constexpr double kMaxBytes = 1 << 24;

/// Transforms that name no grid are evaluated on one of eight points.
[[maybe_unused]] std::unique_ptr<supple::VolumeFile> open_with_grid(const std::string& path) {
  static const supple::Geometry grid = supple::Geometry().with_dims({2, 2, 2});
  supple::ReadOptions options;
  options.grid = &grid;
  return supple::open_scalars_or_vectors(path, options);
}

void read_all(const std::string& path) {
  const auto file = FUZZ_OPEN;
  const supple::VolumeHeader& header = file->header();
  if (double(supple::stored_bytes(header)) > kMaxBytes) return;
  const supple::Vec3i& dims = header.geometry.dims();
  std::vector<char> slice(std::size_t(dims.x) * dims.y * header.components *
                          supple::bytes_of(header.type));
  for (int k = 0; k < dims.z; ++k) file->read_slice(slice.data());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  supple::fuzz::with_file(FUZZ_NAME, data, size, read_all);
  return 0;
}
