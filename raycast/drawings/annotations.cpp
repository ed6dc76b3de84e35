#include "raycast/drawings/annotations.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "volumes/base/error.h"

namespace supple {

namespace {

constexpr double kSecondLetter = 0.2;  // share of a unit vector
constexpr Rgb kPale{1, 1, 1}, kDark{0, 0, 0};
constexpr Rgb kPaleLetter{1, 0.9, 0.4}, kDarkLetter{0.5, 0.15, 0};
constexpr Rgb kCrossInk{0.3, 0.9, 0.4}, kArrowInk{1, 0.45, 0.1};
constexpr double kWordHeight = 0.75;  // of that of letters
constexpr int kLegendSteps = 128;
constexpr double kBetweenLegends = 0.07;  // of the height

struct PatientSide {
  char positive, negative;
};
constexpr PatientSide kSides[3] = {{'L', 'R'}, {'P', 'A'}, {'S', 'I'}};

Vec3d axis_vector(int axis, double sign) {
  Vec3d v(0);
  v[axis] = sign;
  return v;
}

/// The face of the cube whose outward normal is along an axis; words on it stand upright when the
/// head, or on top and bottom the face, is up.
void add_cube_face(Overlay& overlay, const PixelPoint& centre, double half,
                   const CameraFrame& frame, const Vec3d& normal) {
  const double facing = -normal.dot(frame.forward);
  if (facing <= 1e-3) return;
  const Vec3d up = normal.z != 0 ? Vec3d(0, -1, 0) : Vec3d(0, 0, 1);
  const Vec3d right = up.cross(normal);
  const auto seen = [&](const Vec3d& v) {
    return PixelPoint{v.dot(frame.right), -v.dot(frame.up)};
  };
  const PixelPoint along = seen(right), down = seen(-up), middle = seen(normal);
  const auto place = [&](double x, double y) {
    return PixelPoint{centre[0] + half * (middle[0] + x * along[0] + y * down[0]),
                      centre[1] + half * (middle[1] + x * along[1] + y * down[1])};
  };
  const double grey = 0.45 + 0.45 * facing;
  const std::vector<PixelPoint> corners = {place(-1, -1), place(1, -1), place(1, 1), place(-1, 1)};
  overlay.push_back(OverlayFace{corners, {grey, grey, grey}});
  std::vector<PixelPoint> rim = corners;
  rim.push_back(corners.front());
  overlay.push_back(OverlayLine{rim, std::max(1.0, half / 16), {0.1, 0.1, 0.1}, {}});
  OverlayText letter;
  letter.text = orientation_letters(normal);
  letter.at = place(0, 0);
  letter.hold = {0.5, 0.5};
  letter.height = 1.1 * half;
  letter.ink = {0.05, 0.05, 0.05};
  letter.along = along;
  letter.down = down;
  overlay.push_back(letter);
}

}  // namespace

std::string orientation_letters(const Vec3d& direction_lps) {
  const double length = direction_lps.length();
  std::array<int, 3> order = {0, 1, 2};
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return std::abs(direction_lps[a]) > std::abs(direction_lps[b]);
  });
  std::string letters;
  for (const int axis : order) {
    const double share = direction_lps[axis] / length;
    if (!letters.empty() && std::abs(share) <= kSecondLetter) continue;
    letters += share < 0 ? kSides[axis].negative : kSides[axis].positive;
  }
  return letters;
}

double round_length(double longest) {
  const double power = std::pow(10, std::floor(std::log10(longest) + 1e-9));
  for (const double factor : {5.0, 2.0}) {
    if (factor * power <= longest * (1 + 1e-9)) return factor * power;
  }
  return power;
}

double mm_per_pixel(const Camera& camera, int height) {
  if (camera.projection == Projection::orthographic) return camera.height_mm / height;
  const double distance = (camera.target_lps_mm - camera.position_lps_mm).length();
  return 2 * half_height_at_unit_distance(camera) * distance / height;
}

Annotations::Annotations(Overlay& overlay, const PictureArea& area, double letter_height,
                         Ground ground)
    : m_overlay(overlay),
      m_area(area),
      m_height(letter_height),
      m_word_height(kWordHeight * letter_height),
      m_word_ink(ground == Ground::dark ? kPale : kDark),
      m_letter_ink(ground == Ground::dark ? kPaleLetter : kDarkLetter),
      m_halo(ground == Ground::dark ? kDark : kPale) {}

double Annotations::letter_height_for(const PictureArea& area) {
  return std::max(9.0, std::min(area.width, area.height) / 32);
}

void Annotations::line(const std::vector<PixelPoint>& points, double width) {
  m_overlay.push_back(OverlayLine{points, std::max(1.0, width), m_word_ink, m_halo});
}

void Annotations::text(const std::string& words, const PixelPoint& at, const PixelPoint& hold,
                       double height) {
  OverlayText shape;
  shape.text = words;
  shape.at = at;
  shape.hold = hold;
  shape.height = height;
  shape.ink = m_word_ink;
  shape.halo = m_halo;
  m_overlay.push_back(shape);
}

void Annotations::letter(const Vec3d& direction, const PixelPoint& at, const PixelPoint& hold) {
  text(orientation_letters(direction), at, hold, m_height);
  std::get<OverlayText>(m_overlay.back()).ink = m_letter_ink;
}

void Annotations::letters(const Vec3d& right, const Vec3d& up) {
  const double margin = 0.6 * m_height;
  const double x = m_area.left + m_area.width / 2, y = m_area.top + m_area.height / 2;
  letter(-right, {m_area.left + margin, y}, {0, 0.5});
  letter(right, {m_area.left + m_area.width - margin, y}, {1, 0.5});
  letter(up, {x, m_area.top + margin}, {0.5, 0});
  letter(-up, {x, m_area.top + m_area.height - margin}, {0.5, 1});
}

void Annotations::scale_bar(double pixel_mm, const std::string& remark) {
  const double tick = 0.4 * m_height, length_mm = round_length(m_area.width / 4 * pixel_mm);
  const double left = m_area.left + m_height, right = left + length_mm / pixel_mm;
  const double y = m_area.top + m_area.height - m_height;
  line({{left, y - tick}, {left, y}, {right, y}, {right, y - tick}}, m_height / 7);
  text(number_text(length_mm) + " mm" + remark, {left, y - 0.8 * m_height}, {0, 1}, m_word_height);
}

void Annotations::cube(const CameraFrame& frame) {
  const double half = 1.6 * m_height;
  const double reach = 1.8 * half;  // a corner seen from the front, and some room
  const PixelPoint centre = {m_area.left + m_area.width - reach,
                             m_area.top + m_area.height - reach};
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      add_cube_face(m_overlay, centre, half, frame, axis_vector(axis, sign));
    }
  }
}

void Annotations::words(const std::vector<std::string>& lines) {
  double y = m_area.top + m_word_height;
  for (const std::string& words : lines) {
    text(words, {m_area.left + m_word_height, y}, {0, 0}, m_word_height);
    y += kLineReach * m_height;
  }
}

void Annotations::legend(const ScalarRange& range, const std::function<Rgb(double value)>& colour,
                         const std::string& title, int n, int count) {
  const double unit = m_word_height;
  const double left = m_area.left + m_area.width - 10 * unit, right = left + 1.5 * unit;
  // All legends lie between a fifth and seven tenths of the height, with room for titles between.
  const double share = (0.5 + kBetweenLegends) / count;
  const double top = m_area.top + (0.2 + n * share) * m_area.height;
  const double bottom = top + (share - kBetweenLegends) * m_area.height;
  const auto row = [&](double value) {
    return bottom - (value - range.lo) / (range.hi - range.lo) * (bottom - top);
  };
  const auto value_at = [&](double step) {
    return range.lo + (range.hi - range.lo) * step / kLegendSteps;
  };
  for (int step = 0; step < kLegendSteps; ++step) {
    // Beyond the next row of pixels, or what is behind shows between two smooth edges.
    const double low = std::min(bottom, row(value_at(step)) + 1.5), high = row(value_at(step + 1));
    OverlayFace piece;
    piece.corners = {{left, low}, {left, high}, {right, high}, {right, low}};
    piece.fill = colour(value_at(step + 0.5));
    m_overlay.emplace_back(std::move(piece));
  }
  line({{left, top}, {right, top}, {right, bottom}, {left, bottom}, {left, top}}, 1);
  for (const double tick : legend_ticks(range)) {
    line({{right, row(tick)}, {right + 0.5 * unit, row(tick)}}, 1);
    text(number_text(tick), {right + unit, row(tick)}, {0, 0.5}, unit);
  }
  text(title, {left, top - 0.8 * unit}, {0, 1}, unit);
}

void Annotations::crosshair(const PixelPoint& at) {
  const double gap = m_height, width = std::max(1.0, gap / 12);
  const double right = m_area.left + m_area.width, bottom = m_area.top + m_area.height;
  const auto draw = [&](const PixelPoint& from, const PixelPoint& to) {
    m_overlay.push_back(OverlayLine{{from, to}, width, kCrossInk, {}});
  };
  if (at[0] - gap > m_area.left) draw({m_area.left, at[1]}, {at[0] - gap, at[1]});
  if (at[0] + gap < right) draw({at[0] + gap, at[1]}, {right, at[1]});
  if (at[1] - gap > m_area.top) draw({at[0], m_area.top}, {at[0], at[1] - gap});
  if (at[1] + gap < bottom) draw({at[0], at[1] + gap}, {at[0], bottom});
}

void Annotations::arrow(const PixelPoint& from, const PixelPoint& to) {
  const double dx = to[0] - from[0], dy = to[1] - from[1], length = std::hypot(dx, dy);
  if (length < 1) return;
  const double width = std::max(1.0, m_height / 8);
  const double head = std::min(length, 4 * width), x = dx / length, y = dy / length;
  const auto barb = [&](double side) {
    return PixelPoint{to[0] - head * x + side * 0.5 * head * y,
                      to[1] - head * y - side * 0.5 * head * x};
  };
  m_overlay.push_back(OverlayLine{{from, to}, width, kArrowInk, kDark});
  m_overlay.push_back(OverlayFace{{to, barb(1), barb(-1)}, kArrowInk});
}

}  // namespace supple
