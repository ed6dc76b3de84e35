// The grid of a NIfTI file in LPS mm and back. Both forms are affines from the index to RAS in the
// header's unit: the sform as three rows, the qform as quaternion, spacings and offset.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "volumes/base/error.h"
#include "volumes/io/bytes/text_header.h"
#include "volumes/io/format/formats.h"
#include "volumes/io/nifti/nifti_header.h"

namespace supple {

namespace {

constexpr double kWarnVoxels = 0.05;   // between sform and qform of a file that is read
constexpr double kAgreeVoxels = 0.01;  // between both of a file that is written
constexpr int kScanner = 1;            // NIFTI_XFORM_SCANNER_ANAT

double mm_per_unit(const nifti_2_header& header) {
  switch (XYZT_TO_SPACE(header.xyzt_units)) {
    case NIFTI_UNITS_METER:
      return 1000.0;
    case NIFTI_UNITS_MICRON:
      return 0.001;
    default:
      return 1.0;
  }
}

Geometry from_ras(const std::string& path, const nifti_2_header& header, const Vec3i& dims,
                  const nifti_dmat44& affine) {
  const Vec3d lps_from_ras = Vec3d(-1, -1, 1) * mm_per_unit(header);
  const auto column = [&](int c) {
    return Vec3d(affine.m[0][c], affine.m[1][c], affine.m[2][c]) * lps_from_ras +
           Vec3d(0);  // no -0
  };
  return make_geometry(path, dims, column(3), {column(0), column(1), column(2)});
}

nifti_dmat44 to_ras(const Geometry& geometry) {
  nifti_dmat44 affine{};
  affine.m[3][3] = 1;
  for (int c = 0; c < 4; ++c) {
    const Vec3d lps = c < 3 ? geometry.axes_mm()[c] : geometry.origin_lps_mm();
    const Vec3d ras = lps * Vec3d(-1, -1, 1) + Vec3d(0);
    for (int a = 0; a < 3; ++a) affine.m[a][c] = ras[a];
  }
  return affine;
}

Geometry sform_geometry(const std::string& path, const nifti_2_header& header, const Vec3i& dims) {
  nifti_dmat44 affine{};
  std::memcpy(affine.m[0], header.srow_x, sizeof affine.m[0]);
  std::memcpy(affine.m[1], header.srow_y, sizeof affine.m[1]);
  std::memcpy(affine.m[2], header.srow_z, sizeof affine.m[2]);
  return from_ras(path, header, dims, affine);
}

/// Spacing along axis `a` from 1 on; axes that the file does not have count as one unit.
double step_along(const std::string& path, const nifti_2_header& header, int a) {
  if (a > header.dim[0]) return 1.0;
  if (header.pixdim[a] > 0) return header.pixdim[a];
  fail_nifti(path, "pixdim[" + std::to_string(a) + "]", header.pixdim[a], "more than 0");
}

Geometry qform_geometry(const std::string& path, const nifti_2_header& header, const Vec3i& dims) {
  return from_ras(
      path, header, dims,
      nifti_quatern_to_dmat44(header.quatern_b, header.quatern_c, header.quatern_d,
                              header.qoffset_x, header.qoffset_y, header.qoffset_z,
                              step_along(path, header, 1), step_along(path, header, 2),
                              step_along(path, header, 3), header.pixdim[0] < 0 ? -1.0 : 1.0));
}

Geometry spacing_geometry(const std::string& path, const nifti_2_header& header,
                          const Vec3i& dims) {
  nifti_dmat44 affine{};
  for (int a = 0; a < 3; ++a) affine.m[a][a] = step_along(path, header, a + 1);
  return from_ras(path, header, dims, affine);
}

/// Distance at which the two put the same corner of the box, at most, in voxels of `a`.
double corner_distance(const Geometry& a, const Geometry& b) {
  const Vec3d last = Vec3d(a.dims()) - Vec3d(1);
  double largest = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3d index(corner & 1 ? last.x : 0, corner & 2 ? last.y : 0, corner & 4 ? last.z : 0);
    largest = std::max(largest, (a.index_from_world(b.world_from_index(index)) - index).length());
  }
  return largest;
}

/// Distance between sform and qform in voxels; infinity where the qform is no grid.
double form_distance(const Geometry& sform, const nifti_2_header& header) {
  try {
    return corner_distance(sform, qform_geometry("", header, sform.dims()));
  } catch (const InputError&) {
    return HUGE_VAL;
  }
}

/// The quaternion and what goes with it, rounded as NIfTI-1 rounds it.
void set_qform(const nifti_dmat44& affine, nifti_2_header& header) {
  double spacing[3], qfac = 1;
  nifti_dmat44_to_quatern(affine, &header.quatern_b, &header.quatern_c, &header.quatern_d,
                          &header.qoffset_x, &header.qoffset_y, &header.qoffset_z, &spacing[0],
                          &spacing[1], &spacing[2], &qfac);
  header.pixdim[0] = qfac;
  for (int a = 0; a < 3; ++a) header.pixdim[a + 1] = spacing[a];
  for (double* value : {&header.quatern_b, &header.quatern_c, &header.quatern_d}) {
    *value = double(float(*value));
  }
}

}  // namespace

Geometry nifti_geometry(const std::string& path, nifti_2_header header, const Vec3i& dims,
                        const ReadOptions& options, std::vector<std::string>& warnings) {
  for (int a = 1; a <= 3; ++a) header.pixdim[a] = own_spacing(header.pixdim[a], options);
  if (header.sform_code <= 0) {
    return header.qform_code > 0 ? qform_geometry(path, header, dims)
                                 : spacing_geometry(path, header, dims);
  }
  const Geometry geometry = sform_geometry(path, header, dims);
  if (header.qform_code <= 0) return geometry;
  const double distance = form_distance(geometry, header);
  if (!std::isfinite(distance)) {
    warnings.push_back("the qform is no grid; sform is used");
  } else if (distance > kWarnVoxels) {
    warnings.push_back("sform and qform disagree by " +
                       number_text(std::round(distance * 100) / 100) + " voxels; sform is used");
  }
  return geometry;
}

void set_nifti_geometry(const Geometry& geometry, nifti_2_header& header) {
  const Vec3i& dims = geometry.dims();
  for (int a = 0; a < 3; ++a) header.dim[a + 1] = dims[a];
  header.xyzt_units = NIFTI_UNITS_MM;

  const nifti_dmat44 affine = to_ras(geometry);
  std::memcpy(header.srow_x, affine.m[0], sizeof header.srow_x);
  std::memcpy(header.srow_y, affine.m[1], sizeof header.srow_y);
  std::memcpy(header.srow_z, affine.m[2], sizeof header.srow_z);
  header.sform_code = kScanner;
  set_qform(affine, header);
  header.qform_code = form_distance(geometry, header) <= kAgreeVoxels ? kScanner : 0;
}

}  // namespace supple
