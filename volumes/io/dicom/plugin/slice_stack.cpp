#include "volumes/io/dicom/plugin/slice_stack.h"

#include <algorithm>
#include <cmath>

#include "volumes/base/error.h"
#include "volumes/base/units.h"
#include "volumes/io/dicom/plugin/phase_order.h"
#include "volumes/io/format/formats.h"

namespace supple {

namespace {

constexpr double kSamePlace = 0.01;        // of a pixel
constexpr double kWarnedDeviation = 0.01;  // of a step
constexpr double kAllowedDeviation = 0.1;  // of a step
constexpr double kAllowedMissing = 0.25;   // of all slices
constexpr double kPerpendicular = 0.05;    // of a pixel, from the first slice to the last

/// A plane and its height along the normal, mm.
struct PlacedPlane {
  double height;
  const ImagePlane* plane;
};

std::string mm(double length) {
  return number_text(length) + " mm";
}

class StackBuilder {
 public:
  StackBuilder(const DicomSeries& series, const ReadOptions& options)
      : m_series(series), m_options(options) {
    const ImagePlane& first = series.images.front().planes.front();
    m_normal = first.row.cross(first.column).normalized();
    m_pixel_mm = std::min(first.row_mm, first.column_mm);
  }

  SliceStack build() {
    choose_frame();
    m_stack.origin = m_planes.front().plane->position;
    if (m_planes.size() == 1) {
      single_slice();
    } else {
      number_slices();
      find_step();
      check_deviation();
      fill_slices();
    }
    return std::move(m_stack);
  }

 private:
  [[noreturn]] void fail(const std::string& field, const std::string& found,
                         const std::string& expected) const {
    throw InputError({m_series.path, field, found, expected});
  }

  /// Planes at the same height are frames; keeps the chosen one of each height.
  void choose_frame() {
    std::vector<PlacedPlane> all;
    for (const DicomImage& image : m_series.images) {
      for (const ImagePlane& plane : image.planes) {
        all.push_back({plane.position.dot(m_normal), &plane});
      }
    }
    std::sort(all.begin(), all.end(),
              [](const PlacedPlane& a, const PlacedPlane& b) { return a.height < b.height; });
    std::vector<std::size_t> starts;
    for (std::size_t n = 0; n < all.size(); ++n) {
      if (n > 0 && all[n].height - all[starts.back()].height <= kSamePlace * m_pixel_mm) continue;
      starts.push_back(n);
    }
    const std::size_t count = frames_of(all, starts);
    const int frame =
        chosen_frame(m_options, std::int64_t(count), m_series.path, "images at each position");
    std::vector<PlanesAtPosition> positions;
    for (const std::size_t start : starts) {
      positions.emplace_back();
      for (std::size_t n = start; n < start + count; ++n) positions.back().push_back(all[n].plane);
    }
    m_stack.frame_names = order_phases(m_series.path, positions);
    for (std::size_t n = 0; n < starts.size(); ++n) {
      m_planes.push_back({all[starts[n]].height, positions[n][std::size_t(frame)]});
    }
  }

  std::size_t frames_of(const std::vector<PlacedPlane>& all,
                        const std::vector<std::size_t>& starts) const {
    const std::size_t first = (starts.size() > 1 ? starts[1] : all.size());
    for (std::size_t n = 0; n < starts.size(); ++n) {
      const std::size_t end = n + 1 < starts.size() ? starts[n + 1] : all.size();
      if (end - starts[n] == first) continue;
      fail("images at one position",
           std::to_string(first) + " at " + mm(all.front().height) + " along the normal, " +
               std::to_string(end - starts[n]) + " at " + mm(all[starts[n]].height),
           "the same number everywhere");
    }
    return first;
  }

  void single_slice() {
    const ImagePlane& plane = *m_planes.front().plane;
    m_stack.slices = {plane};
    m_stack.step = m_normal * (plane.thickness_mm > 0 ? plane.thickness_mm : 1);
    if (plane.thickness_mm > 0) return;
    m_stack.warnings.push_back("the one slice has no thickness; it counts as 1 mm");
  }

  /// Numbers along k by whole multiples of the median distance.
  void number_slices() {
    std::vector<double> gaps;
    for (std::size_t n = 1; n < m_planes.size(); ++n) {
      gaps.push_back(m_planes[n].height - m_planes[n - 1].height);
    }
    std::vector<double> sorted = gaps;
    std::nth_element(sorted.begin(), sorted.begin() + std::ptrdiff_t(sorted.size() / 2),
                     sorted.end());
    const double median = sorted[sorted.size() / 2];
    double number = 0;
    m_numbers = {0};
    for (std::size_t n = 0; n < gaps.size(); ++n) {
      number += std::round(gaps[n] / median);
      const double missing = number - double(n + 1);
      if (std::round(gaps[n] / median) < 1 || missing > kAllowedMissing * (number + 1) + 0.5) {
        fail_uneven(sorted, n);
      }
      m_numbers.push_back(std::int64_t(number));
    }
  }

  [[noreturn]] void fail_uneven(const std::vector<double>& gaps, std::size_t after) const {
    const auto [least, most] = std::minmax_element(gaps.begin(), gaps.end());
    fail("distances between slices",
         mm(*least) + " to " + mm(*most) + " (the first uneven one behind " +
             mm(m_planes[after].height) + " along the normal)",
         "even ones, or few slices missing");
  }

  /// Finds the step from first to last slice, along the normal unless slices are seen to be offset.
  void find_step() {
    const Vec3d path = m_planes.back().plane->position - m_stack.origin;
    const double along = path.dot(m_normal);
    const Vec3d aside = path - m_normal * along;
    m_stack.step = path / double(m_numbers.back());
    if (aside.length() <= kPerpendicular * m_pixel_mm) {
      m_stack.step = m_normal * (along / double(m_numbers.back()));
      return;
    }
    const double degrees = std::atan2(aside.length(), along) * 180 / kPi;
    m_stack.warnings.push_back("gantry tilt of " + number_text(degrees) +
                               " degrees: the axes are sheared");
  }

  void check_deviation() {
    double worst = 0;
    std::size_t at = 0;
    for (std::size_t n = 0; n < m_planes.size(); ++n) {
      const Vec3d even = m_stack.origin + m_stack.step * double(m_numbers[n]);
      const double deviation = (m_planes[n].plane->position - even).length();
      if (deviation <= worst) continue;
      worst = deviation;
      at = n;
    }
    const double step = m_stack.step.length();
    if (worst <= kWarnedDeviation * step) return;
    const std::string text =
        mm(worst) + " off its even place (at " + mm(m_planes[at].height) + " along the normal)";
    if (worst > kAllowedDeviation * step) {
      fail("ImagePositionPatient", "a slice " + text,
           "at most a tenth of the slice distance of " + mm(step));
    }
    m_stack.warnings.push_back("slices are up to " + text + "; the distance is " + mm(step));
  }

  void fill_slices() {
    std::int64_t missing = 0;
    std::string places;
    for (std::size_t n = 0; n < m_planes.size(); ++n) {
      m_stack.slices.push_back(*m_planes[n].plane);
      if (n + 1 == m_planes.size()) break;
      const std::int64_t gap = m_numbers[n + 1] - m_numbers[n];
      for (std::int64_t g = 1; g < gap; ++g) {
        m_stack.slices.push_back(*m_planes[2 * g <= gap ? n : n + 1].plane);
      }
      if (gap > 1 && missing == 0) {
        places = "between " + mm(m_planes[n].height) + " and " + mm(m_planes[n + 1].height);
      }
      missing += gap - 1;
    }
    if (missing == 0) return;
    m_stack.warnings.push_back(std::to_string(missing) +
                               (missing == 1 ? " slice is" : " slices are") + " missing (" +
                               (missing == 1 ? "" : "the first ") + places +
                               " along the normal); the nearest slice stands in for each");
  }

  const DicomSeries& m_series;
  const ReadOptions& m_options;
  Vec3d m_normal;
  double m_pixel_mm = 1;
  std::vector<PlacedPlane> m_planes;
  std::vector<std::int64_t> m_numbers;  // k of each plane
  SliceStack m_stack;
};

}  // namespace

SliceStack stack_slices(const DicomSeries& series, const ReadOptions& options) {
  return StackBuilder(series, options).build();
}

}  // namespace supple
