// tifffile (Python) reads what we write, and we read what it writes. Skipped where it is not
// installed (tools/setup.sh --with-judges).
#include <cstdlib>

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/volume_writer.h"

using namespace supple;
using namespace supple::test;

namespace {

bool runs_python(const TemporaryFolder& folder, const std::string& lines) {
  const std::string script = folder / "script.py";
  write_text(script, "import sys\nimport numpy as np\nimport tifffile\n" + lines);
  return std::system(("cd " + (folder / "") + " && /usr/bin/python3 script.py > /dev/null 2> " +
                      (folder / "errors.txt"))
                         .c_str()) == 0;
}

bool has_tifffile() {
  return std::system("/usr/bin/python3 -c 'import tifffile' > /dev/null 2>&1") == 0;
}

std::string stored(VolumeFile& file) {
  const Vec3i& dims = file.header().geometry.dims();
  const std::size_t slice = std::size_t(dims.x) * dims.y * bytes_of(file.header().type);
  std::string bytes(slice * dims.z, '\0');
  for (int k = 0; k < dims.z; ++k) file.read_slice(&bytes[slice * k]);
  return bytes;
}

TEST(InteropTifffile, ReadsOurValuesAxesAndVoxelSizes) {
  if (!has_tifffile()) GTEST_SKIP() << "tifffile is not installed";
  const TemporaryFolder folder;
  // Two slices are the case that tifffile takes for one run of values when it is none.
  for (const int slices : {1, 2, 5}) {
    const Geometry geometry({7, 6, slices}, {0, 0, 0},
                            {Vec3d(0.957, 0, 0), {0, 0.3, 0}, {0, 0, 1.5}});
    for (const bool compress : {false, true}) {
      for (int type = 0; type < 10; ++type) {
        WriteOptions options;
        options.compress = compress;
        const std::string name = std::string(numpy_name(ValueType(type))) + "_" +
                                 std::to_string(slices) + (compress ? "_8.tif" : "_1.tif");
        write_volume(
            folder / name, geometry, ValueType(type),
            [](int k, float* out) {
              for (int n = 0; n < 42; ++n) out[n] = float((k * 42 + n) % 127);
            },
            nullptr, options);
      }
    }
  }
  EXPECT_TRUE(runs_python(folder,
                          "import glob\n"
                          "names = sorted(glob.glob('*.tif'))\n"
                          "assert len(names) == 60\n"
                          "for name in names:\n"
                          "    kind, slices, codec = name[:-4].split('_')\n"
                          "    f = tifffile.TiffFile(name)\n"
                          "    v = f.asarray()\n"
                          "    n = int(slices)\n"
                          "    assert v.dtype == np.dtype(kind), (name, v.dtype)\n"
                          "    assert v.size == n * 42 and v.shape[-2:] == (6, 7), name\n"
                          "    assert f.series[0].axes == ('ZYX' if n > 1 else 'YX'), name\n"
                          "    assert (v.ravel() == np.arange(n * 42) % 127).all(), name\n"
                          "    m = f.imagej_metadata\n"
                          "    assert m['spacing'] == 1.5 and m['unit'] == 'mm', m\n"
                          "    assert len(f.pages) == n\n"
                          "    tags = f.pages[0].tags\n"
                          "    assert tags['XResolution'].value == (1000, 957), name\n"
                          "    assert tags['YResolution'].value == (10, 3), name\n"
                          "    assert f.pages[0].compression == int(codec), name\n"))
      << read_text(folder / "errors.txt");
}

TEST(InteropTifffile, WritesStacksThatWeRead) {
  if (!has_tifffile()) GTEST_SKIP() << "tifffile is not installed";
  const TemporaryFolder folder;
  ASSERT_TRUE(runs_python(
      folder,
      "v = (np.arange(210).reshape(5, 6, 7) * 311 % 65536).astype('u2')\n"
      "v.tofile('v.raw')\n"
      "ij = dict(imagej=True, resolution=(2, 4), metadata=dict(axes='ZYX', spacing=1.5, "
      "unit='mm'))\n"
      "tifffile.imwrite('ij.tif', v, **ij)\n"
      "tifffile.imwrite('ij_big_endian.tif', v, byteorder='>', **ij)\n"
      "tifffile.imwrite('ij_zlib.tif', v, compression='zlib', **ij)\n"
      "grey = dict(photometric='minisblack', resolution=(20, 40), resolutionunit='CENTIMETER')\n"
      "tifffile.imwrite('big.tif', v, bigtiff=True, **grey)\n"
      "tifffile.imwrite('big_endian.tif', v, bigtiff=True, byteorder='>', **grey)\n"
      "tifffile.imwrite('tiles.tif', v, tile=(16, 16), compression='zlib', predictor=True, "
      "**grey)\n"
      "ome = dict(axes='ZYX', PhysicalSizeX=500, PhysicalSizeY=.25, PhysicalSizeYUnit='mm',\n"
      "           PhysicalSizeZ=.15, PhysicalSizeZUnit='cm')\n"
      "tifffile.imwrite('a.ome.tif', v, photometric='minisblack', metadata=ome)\n"))
      << read_text(folder / "errors.txt");
  for (const char* name : {"ij.tif", "ij_big_endian.tif", "ij_zlib.tif", "big.tif",
                           "big_endian.tif", "tiles.tif", "a.ome.tif"}) {
    const auto file = open_volume(folder / name);
    const bool is_plain = name[0] == 'b' || name[0] == 't';
    EXPECT_EQ(file->header().type, ValueType::uint16);
    const Vec3d spacing = file->header().geometry.spacing_mm();
    const Vec3d expected(0.5, 0.25, is_plain ? 1 : 1.5);
    for (int a = 0; a < 3; ++a) EXPECT_DOUBLE_EQ(spacing[a], expected[a]) << name;
    EXPECT_EQ(file->header().warnings.size(), is_plain ? 1u : 0u) << name;
    EXPECT_EQ(stored(*file), read_text(folder / "v.raw")) << name;
  }
}

TEST(InteropTifffile, WritesHyperstacksWhoseChannelsAndFramesWeRead) {
  if (!has_tifffile()) GTEST_SKIP() << "tifffile is not installed";
  const TemporaryFolder folder;
  ASSERT_TRUE(runs_python(
      folder,
      "h = np.arange(2 * 5 * 3 * 6 * 7).reshape(2, 5, 3, 6, 7).astype('f4')\n"
      "for t in range(2):\n"
      "    for c in range(3):\n"
      "        h[t, :, c].tofile('%d%d.raw' % (t, c))\n"
      "tifffile.imwrite('ij.tif', h, imagej=True, metadata=dict(axes='TZCYX'))\n"
      "tifffile.imwrite('a.ome.tif', h, photometric='minisblack', metadata=dict(axes='TZCYX'))\n"
      "z = np.ascontiguousarray(np.moveaxis(h, 1, 2))\n"
      "tifffile.imwrite('z.ome.tif', z, photometric='minisblack', metadata=dict(axes='TCZYX'))\n"))
      << read_text(folder / "errors.txt");
  for (const char* name : {"ij.tif", "a.ome.tif", "z.ome.tif"}) {
    for (int frame = 0; frame < 2; ++frame) {
      for (int channel = 0; channel < 3; ++channel) {
        ReadOptions options;
        options.frame = frame;
        options.channel = channel;
        const std::string raw = std::to_string(frame) + std::to_string(channel) + ".raw";
        EXPECT_EQ(stored(*open_volume(folder / name, options)), read_text(folder / raw))
            << name << raw;
      }
    }
  }
}

TEST(InteropTifffile, NotesShapesWhoseFramesAndRunsWeRead) {
  if (!has_tifffile()) GTEST_SKIP() << "tifffile is not installed";
  const TemporaryFolder folder;
  ASSERT_TRUE(
      runs_python(folder,
                  "v = np.arange(2 * 5 * 6 * 7).reshape(2, 5, 6, 7).astype('u2')\n"
                  "v[1].tofile('1.raw')\n"
                  "grey = dict(photometric='minisblack')\n"
                  "tifffile.imwrite('four.tif', v, **grey)\n"
                  "tifffile.imwrite('run.tif', v, truncate=True, **grey)\n"
                  "tifffile.imwrite('swapped.tif', v, byteorder='>', truncate=True, **grey)\n"
                  "tifffile.imwrite('three.tif', v[1], truncate=True, **grey)\n"))
      << read_text(folder / "errors.txt");
  ReadOptions second;
  second.frame = 1;
  for (const char* name : {"four.tif", "run.tif", "swapped.tif"}) {
    EXPECT_EQ(stored(*open_volume(folder / name, second)), read_text(folder / "1.raw")) << name;
  }
  EXPECT_EQ(stored(*open_volume(folder / "three.tif")), read_text(folder / "1.raw"));
}

}  // namespace
