#include "volumes/field/centreline/straight_grid.h"

#include <limits>

#include "volumes/base/error.h"
#include "volumes/base/text.h"

namespace supple {

namespace {

constexpr double kWithinFold = 0.95;  // of the radius at which the first cell folds
constexpr double kStraight = 1e-9;    // turning along a whole curve, radians: rounding

}  // namespace

Fields fields(Straightening& settings) {
  return {
      Field("radius", settings.radius_mm, "How far the box reaches beside the curve, to each side")
          .unit("mm")
          .positive(),
      Field("height", settings.height_mm, "How far it reaches up and down")
          .unit("mm")
          .positive()
          .otherwise("the radius"),
      Field("spacing", settings.spacing_mm, "Voxels of the box, cubes")
          .unit("mm")
          .positive()
          .otherwise("the volume's smallest"),
      Field("up", settings.up, "Direction of up at the curve's middle, LPS")
          .otherwise("superior, or anterior where the curve runs there"),
      Field("no_folds", settings.has_no_folds,
            "Narrow the radius to where no cell folds, short of the curve's radius of curvature"),
  };
}

StraightGrid::StraightGrid(const std::vector<Vec3d>& points, const Straightening& settings,
                           double spacing_mm)
    : m_settings(settings), m_curve(points, settings.up), m_radius_mm(settings.radius_mm) {
  find_radii();
  const double step = settings.spacing_mm.value_or(spacing_mm);
  if (settings.has_no_folds && m_radius_mm > kWithinFold * m_unfolded_radius_mm) {
    m_radius_mm = kWithinFold * m_unfolded_radius_mm;
    if (!(m_radius_mm >= step)) {
      throw InputError(
          {"", "no_folds",
           "a curve that lets no box be wider than " + number_text(m_radius_mm) +
               " mm to each side",
           "more than a voxel (" + number_text(step) + " mm): fewer points, or less height"});
    }
  }
  const double half = m_curve.length_mm() / 2;
  const auto voxels = [&](double half_mm) { return std::floor(half_mm / step * (1 + 1e-9)); };
  const Vec3d reach(voxels(half), voxels(m_radius_mm),
                    voxels(settings.height_mm.value_or(m_radius_mm)));
  const double most = 1e5;
  if (std::max({reach.x, reach.y, reach.z}) > most) {
    throw InputError({"", "spacing", number_text(step) + " mm",
                      "one that gives at most 200000 voxels along an axis"});
  }
  const CurveFrame middle = m_curve.frame(half);
  const std::array<Vec3d, 3> axes = {middle.along * step, middle.beside * step, middle.up * step};
  m_grid = Geometry({2 * int(reach.x) + 1, 2 * int(reach.y) + 1, 2 * int(reach.z) + 1},
                    middle.at - axes[0] * reach.x - axes[1] * reach.y - axes[2] * reach.z, axes);
  for (int i = 0; i < m_grid.dims().x; ++i) {
    m_frames.push_back(m_curve.frame(half + (i - reach.x) * step));
  }
}

/// det F in a corner of the box is 1 - |k . beside| radius - |k . up| height.
void StraightGrid::find_radii() {
  m_unfolded_radius_mm = m_curve_radius_mm = std::numeric_limits<double>::infinity();
  for (const double length : m_curve.sampled_lengths()) {
    const CurveFrame frame = m_curve.frame(length);
    const Vec3d bend = m_curve.curvature(length);
    if (bend.length() * m_curve.length_mm() < kStraight) continue;
    const double beside = std::abs(bend.dot(frame.beside)), up = std::abs(bend.dot(frame.up));
    const double left = m_settings.height_mm ? 1 - up * *m_settings.height_mm : 1;
    const double across = m_settings.height_mm ? beside : beside + up;
    m_curve_radius_mm = std::min(m_curve_radius_mm, 1 / bend.length());
    m_unfolded_radius_mm = std::min(m_unfolded_radius_mm, left > 0 ? left / across : 0);
  }
}

VectorSliceSource StraightGrid::slices() const {
  return [this](int k, Vec3f* out) {
    const Vec3i& dims = m_grid.dims();
    const Vec3i middle(0, dims.y / 2, dims.z / 2);
    const double step = m_grid.axes_mm()[2].length(), up = (k - middle.z) * step;
    for (int j = 0; j < dims.y; ++j) {
      const double beside = (j - middle.y) * step;
      for (int i = 0; i < dims.x; ++i) {
        const CurveFrame& frame = m_frames[std::size_t(i)];
        const Vec3d place = frame.at + frame.beside * beside + frame.up * up;
        *out++ = Vec3f(place - m_grid.world_from_index(Vec3d(i, j, k)));
      }
    }
  };
}

Value to_value(const StraightGrid& straight, const GridFolds& folds) {
  Value report = {{"length_mm", straight.curve().length_mm()},
                  {"radius_mm", straight.radius_mm()},
                  {"folded_cells", folds.folded_cells()},
                  {"smallest_det_f", folds.smallest_det()}};
  if (std::isfinite(straight.curve_radius_mm())) {
    report["curve_radius_mm"] = straight.curve_radius_mm();
    report["unfolded_radius_mm"] = straight.unfolded_radius_mm();
  }
  return report;
}

std::string folds_text(const StraightGrid& straight, const GridFolds& folds) {
  if (folds.folded_cells() == 0) return {};
  return with_count(folds.folded_cells(), "cell") + " folded, smallest det F " +
         number_text(folds.smallest_det()) + ": the curve's radius is " +
         number_text(straight.curve_radius_mm()) + " mm; a radius below " +
         number_text(straight.unfolded_radius_mm()) + " mm, or no folds, avoids that";
}

}  // namespace supple
