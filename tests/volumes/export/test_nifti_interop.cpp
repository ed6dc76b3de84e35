// nibabel reads what we write and we read what nibabel writes. Skipped where python3-nibabel is not
// installed (tools/setup.sh --with-judges).
#include <cmath>
#include <cstdlib>
#include <cstring>

#include <gtest/gtest.h>

#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"
#include "volumes/io/format/formats.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/volume_writer.h"
#include "volumes/io/warp_file.h"

using namespace supple;
using namespace supple::test;

namespace {

bool has_nibabel() {
  return runs_python("-c 'import nibabel' 2>&1");
}

const Vec3i kCountedDims(4, 3, 2);
/// Left-handed and oblique in LPS; the script has its affine in RAS.
Geometry oblique() {
  return {kCountedDims, {-10.5, 20.25, 30}, {Vec3d(1.2, 1.6, 0), {-2.4, 1.8, 0}, {0, 0, -1.5}}};
}
Geometry sheared() {
  return {kCountedDims, {-10.5, 20.25, 30}, {Vec3d(1.2, 1.6, 0), {0, 1.5, 0}, {0, 0, -1.5}}};
}

/// Values i + 10 j + 50 k, which fit every type.
template <class T>
void write_counted(const std::string& path, const Geometry& geometry, ValueType type) {
  DenseImage image;
  image.geometry = geometry;
  image.type = type;
  image.slope = 0.5;
  image.intercept = -3;
  const auto writer = create_dense(path, image);
  std::vector<T> slice;
  for (int k = 0; k < kCountedDims.z; ++k) {
    slice.clear();
    for (int n = 0; n < kCountedDims.x * kCountedDims.y; ++n) {
      slice.push_back(T(n % kCountedDims.x + 10 * (n / kCountedDims.x) + 50 * k));
    }
    writer->write_slice(slice.data());
  }
  writer->commit();
}

void write_every_type(const TemporaryFolder& folder) {
  const auto path = [&](ValueType type) {
    return folder / (std::string(numpy_name(type)) + (int(type) % 2 ? ".nii" : ".nii.gz"));
  };
  write_counted<std::int8_t>(path(ValueType::int8), oblique(), ValueType::int8);
  write_counted<std::uint8_t>(path(ValueType::uint8), oblique(), ValueType::uint8);
  write_counted<std::int16_t>(path(ValueType::int16), oblique(), ValueType::int16);
  write_counted<std::uint16_t>(path(ValueType::uint16), oblique(), ValueType::uint16);
  write_counted<std::int32_t>(path(ValueType::int32), oblique(), ValueType::int32);
  write_counted<std::uint32_t>(path(ValueType::uint32), oblique(), ValueType::uint32);
  write_counted<std::int64_t>(path(ValueType::int64), oblique(), ValueType::int64);
  write_counted<std::uint64_t>(path(ValueType::uint64), oblique(), ValueType::uint64);
  write_counted<float>(path(ValueType::float32), oblique(), ValueType::float32);
  write_counted<double>(path(ValueType::float64), oblique(), ValueType::float64);
  write_counted<std::int16_t>(folder / "sheared.nii", sheared(), ValueType::int16);
}

const char* kReader = R"(
import sys
import numpy as np
import nibabel as nib
folder = sys.argv[1]
ras = np.array([[-1.2, 2.4, 0, 10.5], [-1.6, -1.8, 0, -20.25], [0, 0, -1.5, 30], [0, 0, 0, 1]])
i, j, k = np.mgrid[0:4, 0:3, 0:2]
stored = i + 10 * j + 50 * k
for n, name in enumerate(('int8', 'uint8', 'int16', 'uint16', 'int32', 'uint32', 'int64', 'uint64',
                          'float32', 'float64')):
    image = nib.load('%s/%s.nii%s' % (folder, name, '' if n % 2 else '.gz'))
    assert type(image) is nib.Nifti1Image
    assert image.get_data_dtype() == np.dtype(name), image.get_data_dtype()
    assert image.dataobj.slope == 0.5 and image.dataobj.inter == -3
    assert np.array_equal(image.dataobj.get_unscaled(), stored)
    assert np.array_equal(image.get_fdata(), 0.5 * stored - 3)
    for form in (image.affine, image.get_sform(), image.get_qform()):
        assert np.abs(form - ras).max() < 3e-6, form
    assert int(image.header['sform_code']) == 1 and int(image.header['qform_code']) == 1
    assert image.header.get_xyzt_units()[0] == 'mm'
    assert len(image.header.extensions) == 0
sheared = nib.load(folder + '/sheared.nii')
ras[:3, 1] = 0, -1.5, 0
assert np.abs(sheared.affine - ras).max() < 3e-6, sheared.affine
assert int(sheared.header['sform_code']) == 1 and int(sheared.header['qform_code']) == 0

long = nib.load(folder + '/long.nii.gz')
assert type(long) is nib.Nifti2Image and long.shape == (40000, 1, 1), long
assert long.get_fdata()[39999, 0, 0] == 39999 % 251

for name, intent, sign in (('lps.nii', 'vector', 1), ('lps.nii.gz', 'vector', 1),
                           ('ras.nii.gz', 'displacement vector', -1)):
    warp = nib.load(folder + '/' + name)
    assert warp.shape == (4, 3, 2, 1, 3) and warp.get_data_dtype() == np.float32
    assert warp.header.get_intent()[0] == intent, warp.header.get_intent()
    values = warp.get_fdata()[:, :, :, 0, :]
    assert np.array_equal(values[..., 0], sign * (i + 0.5))
    assert np.array_equal(values[..., 1], sign * (10 * j - 2.0))
    assert np.array_equal(values[..., 2], 100.0 * k)
    extension, = warp.header.extensions
    assert extension.get_code() == 6
    text = extension.get_content()
    text = text if isinstance(text, str) else text.decode()
    assert text == 'supple direction: material\nsupple certificate: {"folded": 0}\n', text
)";

const char* kWriter = R"(
import sys
import numpy as np
import nibabel as nib
folder = sys.argv[1]
affine = np.array([[-1.2, 2.4, 0, 10.5], [-1.6, -1.8, 0, -20.25], [0, 0, -1.5, 30], [0, 0, 0, 1]])
i, j, k = np.mgrid[0:4, 0:3, 0:2]
stored = i + 10 * j + 50 * k

series = np.stack([stored + 200 * t for t in range(3)], axis=-1).astype(np.int16)
image = nib.Nifti1Image(series, affine)
image.header.set_slope_inter(0.25, 7)
nib.save(image, folder + '/series.nii.gz')
header = nib.Nifti1Header(endianness='>')
header.set_data_dtype('>f8')
nib.save(nib.Nifti1Image(stored.astype('>f8'), affine, header), folder + '/big.nii')
header = nib.Nifti2Header(endianness='>')
header.set_data_dtype('>u4')
nib.save(nib.Nifti2Image(stored.astype('>u4'), affine, header), folder + '/big2.nii')
nib.save(nib.Nifti1Pair(stored.astype(np.uint8), affine), folder + '/pair.hdr')
rgb = np.zeros((4, 3, 2), dtype=[('R', 'u1'), ('G', 'u1'), ('B', 'u1')])
rgb['R'], rgb['G'], rgb['B'] = stored, stored + 1, stored + 2
nib.save(nib.Nifti1Image(rgb, affine), folder + '/rgb.nii.gz')
for name, code in (('lps', 1007), ('ras', 1006)):
    vectors = np.stack([i + 0.5, 10 * j - 2.0, 100.0 * k], axis=-1)[:, :, :, None, :]
    warp = nib.Nifti1Image(vectors.astype(np.float32), affine)
    warp.header['intent_code'] = code
    warp.header.extensions.append(nib.nifti1.Nifti1Extension(
        6, b'supple direction: resample\nsupple certificate: {"n": 2}\n'))
    nib.save(warp, folder + '/' + name + '.nii.gz')
both = nib.Nifti1Image(stored.astype(np.int32), affine)
both.set_sform(affine, 1)
both.set_qform(np.diag([2.0, 2, 2, 1]), 1)
nib.save(both, folder + '/both.nii')
)";

void expect_oblique(const Geometry& geometry) {
  const Geometry expected = oblique();
  EXPECT_EQ(geometry.dims(), kCountedDims);
  EXPECT_LT((geometry.origin_lps_mm() - expected.origin_lps_mm()).length(), 1e-5);
  for (int c = 0; c < 3; ++c) {
    EXPECT_LT((geometry.axes_mm()[c] - expected.axes_mm()[c]).length(), 1e-6) << c;
  }
}

/// Every value is component + i + 10 j + 50 k + first.
template <class T>
void expect_counted(VolumeFile& file, int first) {
  expect_oblique(file.header().geometry);
  const int components = file.header().components;
  std::vector<T> slice(std::size_t(components * kCountedDims.x * kCountedDims.y));
  for (int k = 0; k < kCountedDims.z; ++k) {
    file.read_slice(slice.data());
    for (int n = 0; n < int(slice.size()); ++n) {
      const int voxel = n / components;
      ASSERT_EQ(slice[std::size_t(n)], T(n % components + voxel % kCountedDims.x +
                                         10 * (voxel / kCountedDims.x) + 50 * k + first));
    }
  }
}

Vec3f counted_vector(int i, int j, int k) {
  return Vec3f(float(i) + 0.5f, 10 * float(j) - 2, 100 * float(k));
}

}  // namespace

TEST(InteropNifti, NibabelReadsOurVolumesAndWarps) {
  if (!has_nibabel()) GTEST_SKIP() << "python3-nibabel is not installed";
  const TemporaryFolder folder;
  write_every_type(folder);
  write_volume(folder / "long.nii.gz", Geometry().with_dims({40000, 1, 1}), ValueType::uint8,
               [](int, float* out) {
                 for (int n = 0; n < 40000; ++n) out[n] = float(n % 251);
               });
  for (const char* name : {"lps.nii", "lps.nii.gz", "ras.nii.gz"}) {
    WriteOptions options;
    options.ras_vectors = name[0] == 'r';
    const auto vectors = [](int k, Vec3f* out) {
      for (int n = 0; n < 12; ++n) out[n] = counted_vector(n % 4, n / 4, k);
    };
    write_warp(folder / name, {oblique(), WarpDirection::material, "{\"folded\": 0}"}, vectors,
               nullptr, options);
  }
  write_text(folder / "judge.py", kReader);
  EXPECT_TRUE(runs_python((folder / "judge.py") + " " + (folder / "")));
}

TEST(InteropNifti, WeReadWhatNibabelWrites) {
  if (!has_nibabel()) GTEST_SKIP() << "python3-nibabel is not installed";
  const TemporaryFolder folder;
  write_text(folder / "write.py", kWriter);
  ASSERT_TRUE(runs_python((folder / "write.py") + " " + (folder / "")));

  for (int t = 0; t < 3; ++t) {
    ReadOptions options;
    options.frame = t;
    const auto series = open_volume(folder / "series.nii.gz", options);
    EXPECT_EQ(series->header().slope, 0.25);
    EXPECT_EQ(series->header().intercept, 7);
    expect_counted<std::int16_t>(*series, 200 * t);
  }
  expect_counted<double>(*open_volume(folder / "big.nii"), 0);
  expect_counted<std::uint32_t>(*open_volume(folder / "big2.nii"), 0);
  expect_counted<std::uint8_t>(*open_volume(folder / "pair.img"), 0);
  expect_counted<std::uint8_t>(*open_scalars_or_vectors(folder / "rgb.nii.gz"), 0);

  for (const char* name : {"lps.nii.gz", "ras.nii.gz"}) {
    const Warp warp = read_warp(folder / name);
    expect_oblique(warp.geometry);
    EXPECT_EQ(warp.direction, WarpDirection::resample);
    EXPECT_EQ(open_scalars_or_vectors(folder / name)->header().certificate, "{\"n\": 2}");
    const float sign = name[0] == 'r' ? -1.0f : 1.0f;
    for (int n = 0; n < 24; ++n) {
      const Vec3f v = counted_vector(n % 4, n / 4 % 3, n / 12);
      ASSERT_EQ(warp.vectors[std::size_t(n)], Vec3f(sign * v.x, sign * v.y, v.z)) << name;
    }
  }
  const auto both = open_volume(folder / "both.nii");
  ASSERT_EQ(both->header().warnings.size(), 1u);
  EXPECT_NE(both->header().warnings[0].find("sform and qform disagree"), std::string::npos);
  expect_counted<std::int32_t>(*both, 0);
}
