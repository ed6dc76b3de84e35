// What a volume file holds: info FILE
#include <cstdio>

#include <supple/supple.h>

int main(int argc, char** argv) try {
  if (argc != 2) return std::fprintf(stderr, "usage: info FILE\n"), 2;
  const auto file = supple::open_volume(argv[1]);
  const supple::VolumeHeader& header = file->header();
  const supple::Vec3i dims = header.geometry.dims();
  const supple::Vec3d spacing = header.geometry.spacing_mm();
  std::printf("%s, %s, %d x %d x %d voxels of %g x %g x %g mm\n", header.format.c_str(),
              supple::numpy_name(header.type), dims.x, dims.y, dims.z, spacing.x, spacing.y,
              spacing.z);
  const supple::VolumeDigest digest = supple::digest_volume(*file);
  std::printf("%g to %g, mean %g\n", digest.statistics.min, digest.statistics.max,
              digest.statistics.mean);
  return 0;
} catch (const supple::Error& error) {
  return std::fprintf(stderr, "info: %s\n", error.what()), 1;
}
